//! Nodes of the tree over clusters: eight boxes side by side.

use super::WIDTH;
use crate::geometry::Bounds;

/// Eight boxes and what they hold. A box that is not used is empty, and met by nothing.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Least and greatest coordinates, by axis.
    pub low: [[f32; WIDTH]; 3],
    pub high: [[f32; WIDTH]; 3],
    /// The longest side of each box.
    pub extent: [f32; WIDTH],
    children: [u32; WIDTH],
}

/// What a box holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// A node, by its number.
    Node(u32),
    /// A cluster, by its number.
    Cluster(u32),
}

/// Marks a cluster among children.
const CLUSTER: u32 = 1 << 31;

impl Node {
    pub const EMPTY: Self = Self {
        low: [[f32::INFINITY; WIDTH]; 3],
        high: [[f32::NEG_INFINITY; WIDTH]; 3],
        extent: [0.0; WIDTH],
        children: [0; WIDTH],
    };

    pub fn set(&mut self, slot: usize, bounds: &Bounds, child: Child) {
        for axis in 0..3 {
            self.low[axis][slot] = bounds.min[axis];
            self.high[axis][slot] = bounds.max[axis];
        }
        self.extent[slot] = bounds.extent().max_element();
        self.children[slot] = match child {
            Child::Node(node) => node,
            Child::Cluster(cluster) => cluster | CLUSTER,
        };
    }

    #[inline(always)]
    pub fn child(&self, slot: usize) -> Child {
        let child = self.children[slot];
        if child & CLUSTER == 0 { Child::Node(child) } else { Child::Cluster(child & !CLUSTER) }
    }

    /// The boxes that hold clusters: a bit each.
    #[inline(always)]
    pub fn clusters(&self) -> u32 {
        let mut bits = 0;
        for (slot, child) in self.children.iter().enumerate() {
            bits |= (child / CLUSTER) << slot;
        }
        bits
    }

    /// The number of what a box holds, a node or a cluster.
    #[inline(always)]
    pub fn number(&self, slot: usize) -> u32 {
        self.children[slot] & !CLUSTER
    }

    /// The same among others: so many nodes come before those that it is with, and so many clusters.
    ///
    /// Boxes that are not used get numbers, too, which nobody reads.
    #[must_use]
    pub fn moved(&self, nodes: u32, clusters: u32) -> Self {
        let mut moved = self.clone();
        for child in &mut moved.children {
            *child += if *child & CLUSTER == 0 { nodes } else { clusters };
        }
        moved
    }

    /// Of its clusters, the sum of the longest sides of the boxes.
    pub fn sum_of_cluster_extents(&self) -> f64 {
        let clusters = (0..WIDTH).filter(|&slot| self.children[slot] & CLUSTER != 0);
        clusters.map(|slot| f64::from(self.extent[slot])).sum()
    }
}
