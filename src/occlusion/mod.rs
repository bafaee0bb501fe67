//! Who stands between two points: the backends, behind one trait.
//!
//! A backend is complete and immutable: it answers any query, and two threads may ask at once. Our
//! own backends are *cullers* ([`Walk`]): they only say which triangles a ray might meet, and leave
//! the decision to a [`TriangleTest`](crate::geometry::intersect::TriangleTest). As long as a culler
//! is conservative, its answers are those of brute force, whatever the test; so `grid`, `bvh2`,
//! `cwbvh` and `brute` agree bit for bit by construction.

mod any;
mod brute;
mod bvh2;
mod clip;
mod clusters;
mod culling_space;
mod cwbvh;
mod debug;
mod eight;
#[cfg(feature = "embree")]
mod embree;
pub mod embree_bounds;
mod engine;
mod grid;
mod kind;
mod left_out;
mod levels;
mod name;
mod nearest;
mod sparing;
mod tally;
mod transparent;
mod walk;

use std::any::Any;

pub use brute::Brute;
pub use bvh2::Bvh2;
pub(crate) use clip::Clip;
pub(crate) use clusters::{Child, Node};
pub use clusters::{Cluster, Clusters};
pub use cwbvh::Cwbvh;
pub use eight::{Eight, WIDTH};
#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreeOptions, Isa, PacketWidth, Quality};
pub use engine::Engine;
pub use grid::{DividedGrid, Grid, GridError, GridOptions, NestedGrid, TooFine};
pub(crate) use grid::{Level, Steps};
pub use kind::{Backend, BackendError, BuildOptions, Test, build};
pub use left_out::LeftOut;
pub use name::UnknownName;
pub(crate) use name::named;
pub use nearest::Nearest;
pub use tally::Tally;
pub use walk::{Visit, VisitMany, Walk};

use crate::geometry::{Ray, TriangleId};

/// A run of a backend's [`order`](Occlusion::order): the triangles of a voxel, of a leaf, or a block
/// of neighbours. It is what the paper's caches call "the voxel".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Cell {
    /// First place in the order.
    pub start: u32,
    /// One past the last place.
    pub end: u32,
}

impl Cell {
    /// What a culler shows a visitor instead of a cell that is no run of its order. No cell holds it, so that a mailbox
    /// never takes it for tested.
    const NOWHERE: Self = Self { start: 0, end: u32::MAX };
}

/// A triangle that blocks a ray, and the cell it was met in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occluder {
    /// The triangle.
    pub triangle: TriangleId,
    /// Its neighbourhood; empty where it has none that could be tested again: where the backend's cells are not there yet
    /// ([`Occlusion::has_cells`]), and in the crowded voxels of a [`DividedGrid`].
    pub cell: Cell,
}

impl Occluder {
    /// Met in what a culler showed as this cell.
    #[inline(always)]
    fn shown(triangle: TriangleId, cell: Cell) -> Self {
        Self { triangle, cell: if cell == Cell::NOWHERE { Cell::default() } else { cell } }
    }
}

/// Answers occlusion queries about one set of triangles.
pub trait Occlusion: Any + Send + Sync {
    /// Any one opaque triangle that the ray meets.
    fn occluder(&self, ray: &Ray, tally: &mut Tally) -> Option<Occluder>;

    /// Whether any opaque triangle blocks the ray.
    fn occluded(&self, ray: &Ray, tally: &mut Tally) -> bool {
        self.occluder(ray, tally).is_some()
    }

    /// Answers many rays, which had better be alike: towards one light, from one part of the picture.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn occluded_many(&self, rays: &[Ray], blocked: &mut [bool], tally: &mut Tally) {
        assert_eq!(rays.len(), blocked.len(), "one answer a ray");
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.occluded(ray, tally);
        }
    }

    /// The first opaque triangle of a cell that the ray meets.
    fn occluder_in(&self, cell: Cell, ray: &Ray, tally: &mut Tally) -> Option<Occluder>;

    /// Any opaque triangle, of a cell or of all, that the ray meets and that is not left out. Those
    /// found not to block may be noted in `left_out`; all but the spawner may be tested nevertheless.
    fn occluder_except(
        &self,
        ray: &Ray,
        within: Option<Cell>,
        left_out: &mut LeftOut,
        tally: &mut Tally,
    ) -> Option<Occluder> {
        let found = match within {
            None => self.occluder(ray, tally),
            Some(cell) => self.occluder_in(cell, ray, tally),
        }?;
        if !left_out.is_spawner(found.triangle) {
            return Some(found);
        }
        // Rare where spawners are left out at all, and slow: whoever can do better should.
        let everything = Cell { start: 0, end: self.order().len() as u32 };
        let Cell { start, end } = within.unwrap_or(everything);
        (start..end).find_map(|place| {
            let triangle = self.order()[place as usize];
            let wanted = triangle < left_out.opaque() && !left_out.is_spawner(triangle);
            let cell = Cell { start: place, end: place + 1 };
            (wanted && self.meets(triangle, ray, tally)).then_some(Occluder { triangle, cell })
        })
    }

    /// Whether the ray meets this one triangle. Over Embree, which cannot be asked that, whether it surely does: the lower bound of
    /// its own answer.
    fn meets(&self, triangle: TriangleId, ray: &Ray, tally: &mut Tally) -> bool;

    /// All transparent triangles that the ray meets, each once, in ascending order.
    fn transparent(&self, ray: &Ray, found: &mut Vec<TriangleId>, tally: &mut Tally);

    /// The triangle the ray meets first, by distances in f64: of those that differ by less than rounding, as at a shared edge, any may be
    /// first, the same over every backend of ours; of several at the same distance it is the one with the least id. Embree itself
    /// says which is first, by distances in f32.
    fn nearest(&self, ray: &Ray, tally: &mut Tally) -> Option<Nearest>;

    /// The triangles in an order that keeps each cell together; a triangle may recur.
    fn order(&self) -> &[TriangleId];

    /// Whether its cells are there; if not, they are made when [`order`](Self::order) or a cell is first asked for.
    fn has_cells(&self) -> bool {
        true
    }

    /// Bytes held, triangles apart.
    fn memory(&self) -> usize;
}
