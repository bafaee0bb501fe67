//! Treelets: some hundred triangles, whose clusters and nodes are made when they are first asked for.
//!
//! What shadow rays never come near is never put into clusters. With nine samples a pixel and four lights they come near a sixteenth
//! of the clusters of a satellite that is seen from one side, and near two fifths of those of a court; in a dense lattice, into which
//! light does not reach far, near a tenth. Clusters take three quarters of the time that all of building would.
//!
//! Hunt, Mark, Fussell: Fast and Lazy Build of Acceleration Structures from Scene Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;
use std::sync::OnceLock;

use super::collapse::{Half, Whole, collapse};
use super::divide::{Around, Divided, Item, divide, divide_at, places_of};
use super::few::{self, FEW};
use super::{Child, Cluster, Node, WIDTH};
use crate::geometry::lanes::Available;
use crate::geometry::{TriangleId, Triangles};
use crate::occlusion::Eight;

/// Triangles of a treelet at most: larger ones have 5 % fewer nodes that rays visit, and more that no ray comes to.
pub(super) const TREELET: usize = 2 * FEW;

/// Bits of a number that say which of its nodes, or of its clusters. No treelet has more of them than triangles.
pub(super) const WITHIN_BITS: u32 = TREELET.ilog2();

/// Triangles, and once they are asked for, what is made of them. Some stand for nodes above all others, and have no triangles.
#[derive(Debug)]
pub(super) struct Treelet {
    /// Where its triangles are among all.
    pub items: Range<u32>,
    pub made: OnceLock<Made>,
}

/// Nodes, the root first, and the clusters below them.
#[derive(Debug)]
pub(super) struct Made {
    pub nodes: Box<[Node]>,
    pub clusters: Box<[Cluster]>,
}

impl Made {
    /// Of these triangles, for the treelet with this number. Clusters are cut anywhere, or, to save memory, only where they are full.
    pub fn new(
        number: u32,
        triangles: &Triangles,
        ids: &[TriangleId],
        only_full: bool,
        arithmetic: Available,
    ) -> Self {
        let mut items = [Item(Around::NOTHING); TREELET];
        let items = &mut items[..ids.len()];
        for (item, &id) in items.iter_mut().zip(ids) {
            *item = Item::new(triangles.corners()[id as usize], id);
        }
        let places = places_of(items);
        let tree = Arranging { only_full, arithmetic }.arrange(items, &places, 0);
        let first = number << WITHIN_BITS;
        let mut clusters = Vec::with_capacity(2 * ids.len().div_ceil(WIDTH));
        let nodes = collapse(&tree, first, |_, run| {
            let run = &items[run.start as usize..run.end as usize];
            let id = |lane: usize| run[lane].id();
            clusters.push(Cluster::new(run.len(), id, triangles, arithmetic));
            Child::Cluster(first + clusters.len() as u32 - 1)
        });
        Self { nodes: nodes.into(), clusters: clusters.into() }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.clusters)
    }
}

impl Cluster {
    /// Of so many triangles, a cluster's at most.
    pub(super) fn new(
        count: usize,
        id: impl Fn(usize) -> TriangleId,
        triangles: &Triangles,
        arithmetic: Available,
    ) -> Self {
        let ids = std::array::from_fn(|lane| id(lane.min(count - 1)));
        Self { corners: Eight::new(triangles, &ids, arithmetic), ids }
    }
}

/// Sorts items so that those of a cluster are in a row.
#[derive(Clone, Copy)]
pub(super) struct Arranging {
    pub only_full: bool,
    pub arithmetic: Available,
}

impl Arranging {
    /// The box is around their places, or somewhat larger; `first` is the place of the first one.
    pub fn arrange(self, items: &mut [Item], places: &Around, first: u32) -> Half {
        if items.len() <= WIDTH {
            let mut around = Around::NOTHING;
            for Item(item) in &*items {
                around.join(item);
            }
            return Half::whole(Whole::Cluster, around.bounds(), first..first + items.len() as u32);
        }
        let Divided { at, sides } = if items.len() <= FEW {
            few::divide(items, places, self.only_full, self.arithmetic)
        } else if self.only_full {
            divide_at(items, places, (items.len() / 2).next_multiple_of(WIDTH))
        } else {
            divide(items, places, 1)
        };
        let (left, right) = items.split_at_mut(at);
        let left = self.arrange(left, &sides[0], first);
        Half::of([left, self.arrange(right, &sides[1], first + at as u32)])
    }
}
