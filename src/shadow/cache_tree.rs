//! `cache-tree`: the shadow voxel cache tree of Pearce and Jevans (§7, §10 to §12). Each light has a
//! tree of shadow voxel caches, a child for reflected and one for refracted rays at every node; the
//! path of the ray that spawned a query, a bit a level, says which node it consults.
//!
//! Wins where rays are reflected or refracted: successive queries of one node come from neighbouring
//! points, where those of one light jump between what the eye sees and what mirrors show. Costs
//! a step a level to find the node, nothing for queries of the eye's rays.
//!
//! Exact for any tree, since its nodes are memories. A node is made when a query first needs it, so
//! lights and paths that never occur cost nothing. Beyond the depth limit the last node serves.
//!
//! A node takes 16 bytes as in the paper's Table 1: the voxel is a run of the backend's list, twice 4
//! bytes; the children are numbers of 2 bytes within the light's tree, which limits it to 65,535 nodes,
//! those of 15 bounces; in a full tree the nearest node above serves.
//!
//! Pearce, Jevans: Exploiting Shadow Coherence in Ray Tracing. Graphics Interface 1991.

use super::{Path, Shelf};

/// Bounces down to which a tree has nodes: the paper's example of a reasonably deep one.
pub const DEPTH: u8 = 10;

/// Number of the root; no child has it.
const ROOT: u16 = 0;

/// Most nodes of a tree.
const MOST_NODES: usize = u16::MAX as usize;

/// A memory, and where those of reflected (0) and refracted (1) rays are.
#[derive(Clone, Debug, Default)]
struct Node<M> {
    memory: M,
    children: [u16; 2],
}

/// A tree of memories a light.
#[derive(Clone, Debug)]
pub struct PerPath<M> {
    trees: Vec<Vec<Node<M>>>,
    depth: u8,
}

impl<M> PerPath<M> {
    /// Bytes of a node.
    pub const NODE_BYTES: usize = size_of::<Node<M>>();

    /// Trees with nodes down to that many bounces.
    #[must_use]
    pub fn new(depth: u8) -> Self {
        Self { trees: Vec::new(), depth }
    }
}

impl<M: Clone + Default + Send + Sync> Shelf<M> for PerPath<M> {
    #[inline(always)]
    fn at(&mut self, light: usize, path: Path) -> &mut M {
        if light >= self.trees.len() {
            self.trees.resize_with(light + 1, Vec::new);
        }
        let tree = &mut self.trees[light];
        if tree.is_empty() {
            tree.push(Node::default());
        }
        let mut node = ROOT;
        let mut bits = path.bits();
        for _ in 0..path.level().min(self.depth) {
            let branch = (bits & 1) as usize;
            bits >>= 1;
            let mut child = tree[usize::from(node)].children[branch];
            if child == ROOT {
                if tree.len() >= MOST_NODES {
                    break;
                }
                child = tree.len() as u16;
                tree[usize::from(node)].children[branch] = child;
                tree.push(Node::default());
            }
            node = child;
        }
        &mut tree[usize::from(node)].memory
    }

    fn clear(&mut self) {
        self.trees.iter_mut().for_each(Vec::clear);
    }

    fn count(&self) -> usize {
        self.trees.iter().map(Vec::len).sum()
    }
}
