//! Clusters: triangles in groups of eight neighbours, stored as one vector test wants them.
//!
//! A test of eight triangles at once costs little more than a test of one, as long as their corners lie
//! side by side (`eight`). Light structures
//! list clusters, not triangles: a sixth of the entries.
//!
//! Clusters are the leaves of a tree of boxes, eight to a node (`build`, `node`). 40 bytes a triangle where all are full,
//! about 51 as they are, with the tree.

mod build;
mod cells;
mod collapse;
mod divide;
mod few;
mod node;
#[cfg(test)]
mod tests;

use std::marker::PhantomData;
use std::ops::ControlFlow;

pub(crate) use node::{Child, Node};

use super::eight::{Eight, WIDTH};
use super::engine::{TestEach, TestEight};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::{Kernel, Lanes};
use crate::geometry::{Ray, TriangleId, Triangles};

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
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    clusters: Vec<Cluster>,
    nodes: Vec<Node>,
    typical_extent: f32,
}

impl Clusters {
    /// Groups the opaque triangles, and builds the tree, in parallel.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        build::build(triangles, 0..triangles.opaque_count())
    }

    /// The same of the transparent ones.
    #[must_use]
    pub fn of_transparent(triangles: &Triangles) -> Self {
        build::build(triangles, triangles.opaque_count()..triangles.len() as u32)
    }

    /// The clusters; neighbours in space are neighbours here, mostly.
    #[must_use]
    #[inline(always)]
    pub fn all(&self) -> &[Cluster] {
        &self.clusters
    }

    /// The nodes of the tree, the root first; none without triangles.
    #[inline(always)]
    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The mean of the longest sides of clusters' boxes.
    #[inline(always)]
    pub(crate) fn typical_extent(&self) -> f32 {
        self.typical_extent
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of_val(&*self.clusters) + size_of_val(&*self.nodes)
    }
}
