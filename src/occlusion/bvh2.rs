//! The binary BVH of `obvhs` (PLOC, reinsertion), as a culler.
//!
//! obvhs' own any-hit traversal is used for culling only, in a space of ours and with a ray of ours
//! (see `culling_space`), and the triangle test is ours. So its answers are those of brute force,
//! axis-parallel rays and scenes of any size and place included, where obvhs by itself errs.

use std::ops::Range;
use std::time::Duration;

use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::RayHit;
use obvhs::{BvhBuildParams, fast_stack};

use super::culling_space::CullingSpace;
use super::levels::levels;
use super::{Cell, Visit, Walk};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// A binary bounding volume hierarchy.
pub struct Bvh2 {
    tree: obvhs::bvh2::Bvh2,
    space: CullingSpace,
}

impl Bvh2 {
    /// Builds with obvhs' medium preset.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        let space = CullingSpace::new(triangles);
        let boxes = space.boxes(triangles);
        let mut tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        // obvhs does not know it any more after reinsertion, and a stack that is too small forgets.
        tree.max_depth = tree.max_depth.max(levels(|node| children(&tree, node)) + 1);
        Self { tree, space }
    }
}

/// The numbers of a node's children.
fn children(tree: &obvhs::bvh2::Bvh2, node: u32) -> Range<u32> {
    match tree.nodes.get(node as usize) {
        Some(node) if !node.is_leaf() => node.first_index..node.first_index + 2,
        _ => 0..0,
    }
}

impl Walk for Bvh2 {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        let order = &self.tree.primitive_indices[..];
        let Some(culled) = self.space.enter(ray, order, visitor) else { return };
        fast_stack!(u32, (96, 192), self.tree.max_depth, stack, {
            self.tree.ray_traverse_dynamic(
                &mut stack,
                culled.ray,
                &mut RayHit::none(),
                |node, ray, _| {
                    let cell =
                        Cell { start: node.first_index, end: node.first_index + node.prim_count };
                    let run = &order[cell.start as usize..cell.end as usize];
                    let flow = visitor.visit(cell, run);
                    ray.tmax = ray.tmax.min(culled.limit(visitor.end()));
                    flow.is_continue()
                },
            );
        });
    }

    fn order(&self) -> &[TriangleId] {
        &self.tree.primitive_indices
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.tree.nodes) + size_of_val(&*self.tree.primitive_indices)
    }
}
