//! The compressed 8-wide BVH of `obvhs` (Ylitie, Karras & Laine 2017), as a culler.
//!
//! As with `bvh2`, obvhs culls in a space of ours with a ray of ours, and the triangle test is ours:
//! its node test is blind within 1e-4 of the ray's origin and clamps small directions, which loses
//! blockers on rays as shadow queries have them; the culling ray keeps clear of both. Its stack for 32 levels
//! forgets what does not fit, and loses what lies there; deeper trees, as triangles make that lie in each other like shells, get one of ours.
//!
//! Ylitie, Karras, Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs.
//! High Performance Graphics 2017.

use std::ops::Range;
use std::time::Duration;

use glam::UVec2;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::faststack::{FastStack, StackStack};

use super::culling_space::{Culled, CullingSpace};
use super::levels::levels;
use super::{Cell, Visit, Walk};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// Triangles that one node may hold: 8 leaves of up to 3.
const NODE_TRIANGLES: usize = 24;

/// What a stack without memory of its own holds; its last place is overwritten once it is full.
const STACK: usize = 32;

/// A compressed 8-wide bounding volume hierarchy.
pub struct Cwbvh {
    tree: CwBvh,
    space: CullingSpace,
    /// Nodes from the root to the deepest, both included: a walk puts at most one thing on its stack for each.
    levels: usize,
}

/// A walk, for the macro of obvhs: its own type with another stack.
struct State<S> {
    stack: S,
    current_group: UVec2,
    primitive_group: UVec2,
    oct_inv4: u32,
    primitive_id: u32,
    hitmask: u32,
}

impl Cwbvh {
    /// Builds with obvhs' medium preset.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        let space = CullingSpace::new(triangles);
        let boxes = space.boxes(triangles);
        let tree = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let levels = levels(|node| children(&tree, node));
        Self { tree, space, levels }
    }

    #[inline(always)]
    fn walk_with<V: Visit + ?Sized>(
        &self,
        stack: impl FastStack<UVec2>,
        culled: &Culled,
        visitor: &mut V,
    ) {
        let order = &self.tree.primitive_indices[..];
        let mut ray = culled.ray;
        let start = self.tree.new_traversal(ray.direction);
        let mut state = State {
            stack,
            current_group: start.current_group,
            primitive_group: start.primitive_group,
            oct_inv4: start.oct_inv4,
            primitive_id: 0,
            hitmask: 0,
        };
        let mut node;
        'walk: {
            obvhs::traverse!(self.tree, node, state, node.intersect_ray(&ray, state.oct_inv4), {
                // All of the node's triangles whose boxes were met, as one cell.
                let base = state.primitive_group.x;
                let first = state.primitive_id;
                let mut ids = [0; NODE_TRIANGLES];
                ids[0] = order[first as usize];
                let (mut count, mut cell) = (1, Cell { start: first, end: first + 1 });
                let mut rest = state.primitive_group.y;
                while rest != 0 {
                    let place = base + rest.trailing_zeros();
                    rest &= rest - 1;
                    ids[count] = order[place as usize];
                    count += 1;
                    cell = Cell { start: cell.start.min(place), end: cell.end.max(place + 1) };
                }
                state.primitive_group.y = 0;
                if visitor.visit(cell, &ids[..count]).is_break() {
                    break 'walk;
                }
                ray.tmax = ray.tmax.min(culled.limit(visitor.end()));
            });
        }
    }
}

/// The numbers of a node's children.
fn children(tree: &CwBvh, node: u32) -> Range<u32> {
    let node = tree.nodes.get(node as usize);
    node.map_or(0..0, |node| node.child_base_idx..node.child_base_idx + node.imask.count_ones())
}

impl Walk for Cwbvh {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        let order = &self.tree.primitive_indices;
        let Some(culled) = self.space.enter(ray, order, visitor) else { return };
        if self.levels < STACK {
            self.walk_with(StackStack::<UVec2, STACK>::default(), &culled, visitor);
        } else {
            self.walk_with(Vec::with_capacity(self.levels), &culled, visitor);
        }
    }

    fn order(&self) -> &[TriangleId] {
        &self.tree.primitive_indices
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.tree.nodes) + size_of_val(&*self.tree.primitive_indices)
    }
}
