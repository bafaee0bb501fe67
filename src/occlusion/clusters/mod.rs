//! Clusters: triangles in groups of eight neighbours, stored as one vector test wants them.
//!
//! A test of eight triangles at once costs little more than a test of one, as long as their corners lie
//! side by side (`eight`). Light structures
//! list clusters, not triangles: a sixth of the entries.
//!
//! Clusters are the leaves of a tree of boxes, eight to a node (`build`, `node`), and are made when a ray first comes near them
//! (`treelet`). 40 bytes a triangle where all are full, about 56 as they are, with the tree and the triangles' numbers.

mod build;
mod cells;
mod collapse;
mod divide;
mod few;
mod node;
#[cfg(test)]
mod tests;
mod treelet;

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

pub(crate) use node::{Child, Node};
use rayon::prelude::*;
use treelet::{Made, Treelet, WITHIN_BITS};

use super::eight::{Eight, WIDTH};
use super::engine::{TestEach, TestEight};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::{Available, Kernel, Lanes};
use crate::geometry::{Ray, TriangleId, Triangles};

/// Of a number, those bits.
const WITHIN: u32 = (1 << WITHIN_BITS) - 1;

/// Bytes a triangle that full clusters and their nodes take at most, in treelets of 64 triangles and more: a row of eight takes 320,
/// and every seventh a node of 256; half as much again is for the rests of rows.
const ONLY_FULL: usize = 56;

thread_local! {
    /// Nanoseconds that this thread has spent on making treelets.
    static HERE: Cell<u64> = const { Cell::new(0) };
}

/// Treelets that are made at once, to see how large clusters are.
const SAMPLED: usize = 64;

/// Eight triangles. Where there are fewer, the last one is repeated.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Cluster {
    corners: Eight,
    ids: [TriangleId; WIDTH],
}

impl Cluster {
    /// The coordinates of a corner of all eight, by axis.
    #[must_use]
    #[inline(always)]
    pub fn corner(&self, corner: usize) -> &[[f32; WIDTH]; 3] {
        self.corners.corner(corner)
    }

    /// The triangles.
    #[must_use]
    #[inline(always)]
    pub fn ids(&self) -> &[TriangleId; WIDTH] {
        &self.ids
    }

    /// Whether a triangle is the one before it, once more.
    #[inline(always)]
    pub(crate) fn repeats(&self, lane: usize) -> bool {
        lane > 0 && self.ids[lane] == self.ids[lane - 1]
    }

    /// Calls `hit` for triangles that the ray meets, those that are repeated more than once, until it breaks.
    #[inline(always)]
    pub(crate) fn test_each<T: TriangleTest, L: Lanes>(
        &self,
        ray: &Ray,
        lanes: &RayLanes<L>,
        triangles: &Triangles,
        hit: impl FnMut(TriangleId) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (ids, wanted) = (&self.ids, |_| true);
        let each =
            TestEach::<T, L, _, _> { triangles, ray, lanes, ids, wanted, hit, test: PhantomData };
        // In place: whoever asks is compiled for the lanes.
        TestEight { eight: &self.corners, each }.run()
    }
}

/// All opaque triangles of a scene, or all transparent ones, in clusters, and the tree over them. Triangles that are not
/// [finite](crate::geometry::is_finite) block nothing, and are left out.
///
/// Clusters are made when they are first asked for, some hundred triangles at once.
#[derive(Debug)]
pub struct Clusters {
    triangles: Arc<Triangles>,
    /// All of them, those of a treelet in a row.
    ids: Vec<TriangleId>,
    treelets: Vec<Treelet>,
    root: Option<u32>,
    typical_extent: f32,
    arithmetic: Available,
    /// Bytes of all treelets that are made.
    made: AtomicUsize,
    /// Bytes that those that are made may take beyond [`ONLY_FULL`] a triangle.
    spare: AtomicUsize,
    /// Nanoseconds that making them took.
    nanoseconds: AtomicU64,
}

impl Clusters {
    /// The opaque triangles, divided into treelets in parallel.
    #[must_use]
    pub fn new(triangles: &Arc<Triangles>) -> Self {
        Self::of_opaque(triangles, usize::MAX)
    }

    /// The same within so many bytes, 62 a triangle or more: where there are so many clusters that all together would take more,
    /// those that are asked for last are full ones only.
    #[must_use]
    pub(crate) fn of_opaque(triangles: &Arc<Triangles>, bytes: usize) -> Self {
        build::build(triangles, 0..triangles.opaque_count(), bytes)
    }

    /// The same of the transparent ones.
    #[must_use]
    pub(crate) fn of_transparent(triangles: &Arc<Triangles>, bytes: usize) -> Self {
        build::build(triangles, triangles.opaque_count()..triangles.len() as u32, bytes)
    }

    /// With these treelets, of which none of those with triangles is made.
    fn of(
        triangles: Arc<Triangles>,
        ids: Vec<TriangleId>,
        treelets: Vec<Treelet>,
        root: Option<u32>,
        bytes: usize,
    ) -> Self {
        let made = treelets.iter().filter_map(|treelet| treelet.made.get()).map(Made::memory).sum();
        let mut clusters = Self {
            triangles,
            ids,
            treelets,
            root,
            typical_extent: 0.0,
            arithmetic: Available::newest(),
            made: AtomicUsize::new(made),
            spare: AtomicUsize::new(usize::MAX),
            nanoseconds: AtomicU64::new(0),
        };
        clusters.spare = AtomicUsize::new(bytes.saturating_sub(clusters.may_take()));
        clusters.typical_extent = clusters.mean_extent_of_some();
        // That was a part of building.
        clusters.nanoseconds = AtomicU64::new(0);
        clusters
    }

    /// Bytes that all take at most, if what is not made yet has full clusters only.
    fn may_take(&self) -> usize {
        let unmade = self.treelets.iter().filter(|treelet| treelet.made.get().is_none());
        self.memory() + ONLY_FULL * unmade.map(|treelet| treelet.items.len()).sum::<usize>()
    }

    /// Takes from what is spare, or gives to it.
    fn spend(&self, triangles: usize, bytes: usize) -> bool {
        let without =
            |spare: usize| (spare.saturating_add(ONLY_FULL * triangles)).checked_sub(bytes);
        self.spare.fetch_update(Relaxed, Relaxed, without).is_ok()
    }

    /// The mean of the longest sides of clusters' boxes, as far as that is seen from some treelets.
    fn mean_extent_of_some(&self) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        let (above, below): (Vec<usize>, Vec<usize>) =
            (0..self.treelets.len()).partition(|&number| self.treelets[number].items.is_empty());
        let step = (below.len() / SAMPLED).max(1);
        let below = below.into_iter().step_by(step).map(|number| (number, step as f64));
        for (number, times) in above.into_iter().map(|number| (number, 1.0)).chain(below) {
            let made = self.made(number);
            sum += times * made.nodes.iter().map(Node::sum_of_cluster_extents).sum::<f64>();
            count += times * made.clusters.len() as f64;
        }
        if count > 0.0 { (sum / count) as f32 } else { 0.0 }
    }

    /// The clusters, each with its number; all are made, if they are not yet.
    pub(crate) fn all(&self) -> impl Iterator<Item = (u32, &Cluster)> {
        (0..self.treelets.len()).flat_map(|number| {
            let first = (number as u32) << WITHIN_BITS;
            (first..).zip(&self.made(number).clusters)
        })
    }

    /// Makes all of them, in parallel.
    pub(crate) fn make_all(&self) {
        (0..self.treelets.len()).into_par_iter().for_each(|number| {
            self.made(number);
        });
    }

    /// The cluster with a number that a node has.
    #[inline(always)]
    pub(crate) fn cluster(&self, number: u32) -> &Cluster {
        &self.made((number >> WITHIN_BITS) as usize).clusters[(number & WITHIN) as usize]
    }

    /// The number of the root of the tree; none without triangles.
    #[inline(always)]
    pub(crate) fn root(&self) -> Option<u32> {
        self.root
    }

    /// The node of the tree with a number that another has.
    #[inline(always)]
    pub(crate) fn node(&self, number: u32) -> &Node {
        &self.made((number >> WITHIN_BITS) as usize).nodes[(number & WITHIN) as usize]
    }

    #[inline(always)]
    fn made(&self, treelet: usize) -> &Made {
        match self.treelets[treelet].made.get() {
            Some(made) => made,
            None => self.make(treelet),
        }
    }

    #[cold]
    #[inline(never)]
    fn make(&self, number: usize) -> &Made {
        let treelet = &self.treelets[number];
        treelet.made.get_or_init(|| {
            let start = Instant::now();
            let ids = &self.ids[treelet.items.start as usize..treelet.items.end as usize];
            let make = |only_full| {
                Made::new(number as u32, &self.triangles, ids, only_full, self.arithmetic)
            };
            let mut made = make(false);
            if !self.spend(ids.len(), made.memory()) {
                made = make(true);
                self.spend(ids.len(), made.memory());
            }
            self.made.fetch_add(made.memory(), Relaxed);
            let nanoseconds = start.elapsed().as_nanos() as u64;
            self.nanoseconds.fetch_add(nanoseconds, Relaxed);
            HERE.set(HERE.get() + nanoseconds);
            made
        })
    }

    /// The mean of the longest sides of clusters' boxes.
    #[inline(always)]
    pub(crate) fn typical_extent(&self) -> f32 {
        self.typical_extent
    }

    /// Seconds that it took to make what was asked for, over all threads.
    pub(crate) fn lazy_seconds(&self) -> f64 {
        self.nanoseconds.load(Relaxed) as f64 * 1e-9
    }

    /// Nanoseconds that this thread has spent on making clusters that were asked for.
    pub(crate) fn nanoseconds_here() -> u64 {
        HERE.get()
    }

    /// Bytes held by now.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of_val(&*self.ids) + size_of_val(&*self.treelets) + self.made.load(Relaxed)
    }
}
