//! The grids: voxels that hold triangles.
//!
//! One resolution cannot serve a scene with uneven detail, so a crowded voxel holds a grid of its own, and so on (adaptive voxel
//! subdivision, Jevans & Wyvill 1989).
//!
//! * [`NestedGrid`], the default, is that from the scene's box down: small grids, whose voxels a ray finds all at once. They are loose: each
//!   triangle is stored once, in the voxel that its middle is in, and what a voxel holds has a box of its own.
//! * [`Grid`] is uniform (`--uniform`): each triangle is listed in every voxel that it touches, and a ray walks through these in order. It is
//!   fast to build, and its voxels are the neighbourhoods that the paper's caches remember.
//! * [`DividedGrid`] is a uniform grid with nested grids in its crowded voxels: where a resolution is asked for, and where voxels are to be
//!   divided when a ray first comes (`--lazy`).
//!
//! Exact, because nothing is lost: a uniform grid lists a triangle in every voxel that it comes within
//! [`PADDING`] of a voxel's side of (`voxelize`), and the walk errs by much less (`steps`): wherever
//! rounding makes it pass a corner on the wrong side, the voxel it takes instead lists the triangle too. Nested grids
//! have a padding of their own (`nested`).
//!
//! Fujimoto, Tanaka, Iwata: ARTS: Accelerated Ray-Tracing System. IEEE CG&A 6(4), 1986.
//! Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing. Eurographics 1987.
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.

mod build;
mod divided;
mod level;
mod nested;
mod steps;
mod voxelize;

use glam::DVec3;

pub use divided::DividedGrid;
pub(crate) use level::Level;
pub use nested::NestedGrid;
pub(crate) use steps::Steps;

use super::brute::visit_all;
use super::clip::{Clip, clip, padding};
use super::{Cell, Visit, Walk};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// How far outside a voxel its triangles may be, as a part of its side.
const PADDING: f64 = 1.0 / 1024.0;

/// Voxels to a triangle of a plain uniform grid, where nothing else is asked for.
const UNIFORM_DENSITY: f64 = 4.0;

/// Voxels to a triangle of a grid whose crowded voxels are divided.
const NESTED_DENSITY: f64 = 0.5;

/// Voxels that a triangle may lie in, on average, where no resolution is asked for: where many large triangles lie
/// on each other there would be more, and the grid is made coarser until there are not.
const MOST_ENTRIES: usize = 64;

/// Entries of a grid whose resolution is asked for: they take 4 GiB. There are always as many as triangles.
const MOST_ENTRIES_ASKED: u32 = 1 << 30;

/// Most voxels along one axis.
const MOST_VOXELS: f64 = 1024.0;

/// Most voxels that may be asked for: 1 GiB before any triangle is in them, and as much again while it is built.
const MOST_VOXELS_ASKED: u64 = 1 << 27;

/// How finely the grid divides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridOptions {
    /// Voxels along x, y and z of the outermost grid, 1 to 1024 each and at most 2²⁷ in all; if none are given, what suits
    /// the triangles. Each takes 4 bytes, and 8 while the grid is built, and 4 more for every triangle that lies in it:
    /// at most 2³⁰ of these in all, which are 4 GiB, or as many as triangles.
    pub resolution: Option<[u32; 3]>,
    /// Whether crowded voxels are divided.
    pub nested: bool,
    /// Whether they are so only when a ray first comes to them.
    pub lazy: bool,
    /// Bytes beyond which none is divided any more when a ray comes to it; where none is divided anyway, those that a grid
    /// of the resolution that is asked for must not exceed.
    pub most_bytes: Option<u64>,
}

impl Default for GridOptions {
    fn default() -> Self {
        Self { resolution: None, nested: true, lazy: false, most_bytes: None }
    }
}

impl GridOptions {
    /// Whether there can be a grid of the resolution that is asked for, if one is.
    ///
    /// # Errors
    /// If it has no voxels along an axis, or too many.
    pub fn check(&self) -> Result<(), GridError> {
        let Some(resolution) = self.resolution else { return Ok(()) };
        let is_in_range = resolution.iter().all(|n| (1..=MOST_VOXELS as u32).contains(n));
        // Of numbers in their range the product is, too.
        if is_in_range && resolution.map(u64::from).iter().product::<u64>() <= MOST_VOXELS_ASKED {
            return Ok(());
        }
        Err(GridError::Resolution { resolution })
    }

    /// Entries that a grid of the resolution that is asked for may have.
    fn most_entries(&self, triangles: usize, voxels: usize) -> u32 {
        // One voxel, which lists each triangle once, is never too fine.
        let most = MOST_ENTRIES_ASKED.max(u32::try_from(triangles).unwrap_or(u32::MAX));
        match self.most_bytes.filter(|_| !self.nested) {
            None => most,
            Some(bytes) => {
                let places = (bytes / size_of::<u32>() as u64).saturating_sub(voxels as u64);
                most.min(u32::try_from(places).unwrap_or(u32::MAX))
            }
        }
    }

    /// A plain uniform grid of about so many voxels, as near to cubes as the box of the triangles allows; never more than may be
    /// asked for.
    #[must_use]
    pub fn uniform(triangles: &Triangles, voxels: usize) -> Self {
        // Half of them: what is left of a voxel at the end of each axis is one more.
        let voxels = voxels.min(MOST_VOXELS_ASKED as usize / 2);
        let resolution = Some(near_cubes(triangles, voxels));
        Self { resolution, nested: false, ..Self::default() }
    }
}

/// A grid of this resolution would have too many entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a grid of {}x{}x{} voxels would list triangles some {entries} times, which is more than {most}; give --grid fewer voxels",
    .resolution[0], .resolution[1], .resolution[2]
)]
pub struct TooFine {
    /// Voxels along x, y and z.
    pub resolution: [u32; 3],
    /// Entries that there would be, from those of the triangles that were tried.
    pub entries: u64,
    /// Entries that there may be.
    pub most: u32,
}

impl TooFine {
    /// Bytes that the grid would take, at least.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let voxels: u64 = self.resolution.map(u64::from).iter().product();
        // One list has a start and an end.
        size_of::<u32>() as u64 * (voxels + 2 + self.entries)
    }
}

/// Why there is no grid of the resolution that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// No voxels, or too many of them.
    #[error(
        "a grid of {}x{}x{} voxels: give 1 to {MOST_VOXELS} along each axis, and at most {MOST_VOXELS_ASKED} in all",
        .resolution[0], .resolution[1], .resolution[2]
    )]
    Resolution {
        /// Voxels along x, y and z.
        resolution: [u32; 3],
    },
    /// Triangles lie in too many of them.
    #[error(transparent)]
    TooFine(#[from] TooFine),
}

/// A uniform grid over the triangles' box.
pub struct Grid {
    level: Level,
    max: DVec3,
    /// By voxel: one more than the number of its list; 0 if it is empty.
    lists: Vec<u32>,
    /// Where in `order` each list starts; one more than there are lists.
    starts: Vec<u32>,
    order: Vec<TriangleId>,
}

impl Grid {
    /// Sorts the triangles into voxels, in parallel. Without triangles, it is a grid of nothing. Where there would be too
    /// many voxels or entries, it is coarser than asked for.
    #[must_use]
    pub fn new(triangles: &Triangles, options: GridOptions) -> Self {
        let mut options = GridOptions { most_bytes: None, ..options };
        loop {
            match Self::of_resolution(triangles, options) {
                Ok(grid) => return grid,
                Err(
                    GridError::Resolution { resolution }
                    | GridError::TooFine(TooFine { resolution, .. }),
                ) => options.resolution = Some(resolution.map(|n| n.div_ceil(2).max(1))),
            }
        }
    }

    /// The same, but a resolution that is asked for is kept: 4 bytes a voxel, and 8 while it is built.
    ///
    /// # Errors
    /// If there would be too many voxels or entries, or more bytes than there may be.
    pub fn of_resolution(triangles: &Triangles, options: GridOptions) -> Result<Self, GridError> {
        options.check()?;
        let density = if options.nested { NESTED_DENSITY } else { UNIFORM_DENSITY };
        match options.resolution {
            Some(_) => {
                let level = Self::place(triangles, options.resolution, density);
                let most = options.most_entries(triangles.len(), level.voxel_count());
                Ok(build::build(triangles, level, most)?)
            }
            None => {
                let most = most_entries(triangles.len());
                let mut resolution = None;
                loop {
                    let level = Self::place(triangles, resolution, density);
                    match build::build(triangles, level, most) {
                        Err(tried) => {
                            resolution = Some(tried.resolution.map(|n| n.div_ceil(2)));
                        }
                        Ok(grid) => return Ok(grid),
                    }
                }
            }
        }
    }

    /// A uniform grid of about so many voxels with at most so many entries, which it does not take memory for before it has
    /// counted them.
    ///
    /// # Errors
    /// If there would be more.
    pub fn with_at_most(
        triangles: &Triangles,
        voxels: usize,
        entries: u32,
    ) -> Result<Self, TooFine> {
        let resolution = near_cubes(triangles, voxels);
        let level = Self::place(triangles, Some(resolution), UNIFORM_DENSITY);
        build::build(triangles, level, entries.min(MOST_ENTRIES_ASKED))
    }

    /// Where a grid is, of the given resolution or with `density` voxels to a triangle.
    fn place(triangles: &Triangles, resolution: Option<[u32; 3]>, density: f64) -> Level {
        let bounds = triangles.bounds().unwrap_or_default();
        // A flat scene gets a box with some depth, so that a voxel has a volume.
        let thickness = padding(&bounds, 0.0);
        let (min, max) = (bounds.min.as_dvec3() - thickness, bounds.max.as_dvec3() + thickness);
        let resolution = match resolution {
            Some(resolution) => resolution.map(|n| n.clamp(1, MOST_VOXELS as u32)),
            None => self::resolution(max - min, density * triangles.len() as f64),
        };
        Level::new(min, max, resolution, &bounds)
    }

    /// Voxels along x, y and z.
    #[must_use]
    pub fn resolution(&self) -> [u32; 3] {
        self.level.resolution
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxel_count(&self) -> usize {
        self.lists.len()
    }

    /// Where the voxels are.
    pub(crate) fn level(&self) -> &Level {
        &self.level
    }

    /// What a voxel lists; opaque triangles first, in ascending order.
    #[inline(always)]
    pub(crate) fn listed(&self, index: usize) -> Cell {
        match self.list_of(index) {
            Some(list) => Cell { start: self.starts[list], end: self.starts[list + 1] },
            None => Cell::default(),
        }
    }

    /// Number of lists.
    fn list_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of the list of a voxel, if it holds anything.
    #[inline(always)]
    fn list_of(&self, index: usize) -> Option<usize> {
        (self.lists[index] as usize).checked_sub(1)
    }

    /// The part of a ray that is in the grid.
    #[inline]
    pub(crate) fn clip(&self, ray: &Ray) -> Clip {
        clip(ray, self.level.min, self.max)
    }
}

impl Walk for Grid {
    // It is there to be the only grid, and to become as small as a memory limit asks.
    const APART: bool = false;

    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        let (enter, leave) = match self.clip(ray) {
            Clip::Outside => return,
            Clip::Everything => return visit_all(&self.order, 8, visitor),
            Clip::Inside(enter, leave) => (enter, leave),
        };
        for step in Steps::new(&self.level, ray, enter, leave) {
            let cell = self.listed(step.index);
            if cell.start < cell.end {
                let run = &self.order[cell.start as usize..cell.end as usize];
                if visitor.visit(cell, run).is_break() {
                    return;
                }
            }
            if step.leave > f64::from(visitor.end()) {
                return;
            }
        }
    }

    fn order(&self) -> &[TriangleId] {
        &self.order
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.lists) + size_of_val(&*self.starts) + size_of_val(&*self.order)
    }
}

/// Entries of a grid over so many triangles whose resolution is not asked for. Places in its order are [`u32`], which is
/// enough for each triangle to lie in one voxel, so a grid that is coarse enough is never refused.
fn most_entries(triangles: usize) -> u32 {
    u32::try_from(MOST_ENTRIES.saturating_mul(triangles)).unwrap_or(u32::MAX)
}

/// Voxels along each axis of the triangles' box, about as many in all as asked for.
fn near_cubes(triangles: &Triangles, voxels: usize) -> [u32; 3] {
    let bounds = triangles.bounds().unwrap_or_default();
    resolution(bounds.max.as_dvec3() - bounds.min.as_dvec3(), voxels as f64)
}

/// Voxels along each axis of a box, about as many in all as asked for.
fn resolution(extent: DVec3, voxels: f64) -> [u32; 3] {
    // Thin boxes count as this thick, so that voxels stay near cubes.
    let extent = extent.max(DVec3::splat(extent.max_element() / MOST_VOXELS));
    let per_length = (voxels / extent.element_product()).cbrt();
    // A point has no extent, and what is NaN then only `max` takes to a number.
    (extent * per_length).to_array().map(|n| n.ceil().clamp(1.0, MOST_VOXELS).max(1.0) as u32)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn one_voxel_is_never_too_fine_however_many_triangles_there_are() {
        let options = GridOptions { nested: false, ..GridOptions::default() };
        assert_eq!(options.most_entries(1000, 1), MOST_ENTRIES_ASKED);
        for triangles in [MOST_ENTRIES_ASKED as usize + 1, u32::MAX as usize] {
            assert_eq!(options.most_entries(triangles, 1), triangles as u32);
        }
    }

    #[test]
    fn a_uniform_grid_is_refused_before_it_takes_more_bytes_than_it_may() {
        let sheet = [Vec3::ZERO, Vec3::new(8.0, 0.0, 0.0), Vec3::new(0.0, 8.0, 0.0)];
        let triangles = Triangles::from_iter(vec![sheet; 1000]);
        let options = GridOptions::uniform(&triangles, 4096);
        let bytes = Grid::of_resolution(&triangles, options).unwrap().memory() as u64;
        let within = |most| {
            Grid::of_resolution(&triangles, GridOptions { most_bytes: Some(most), ..options })
        };
        assert_eq!(within(bytes).unwrap().memory() as u64, bytes);
        let Err(GridError::TooFine(refused)) = within(bytes / 2) else { panic!("not refused") };
        assert!(u64::from(refused.most) * 4 <= bytes / 2, "{refused:?}");
        assert!((bytes / 2..=bytes).contains(&refused.bytes()), "{refused:?} {bytes}");
        // Who asks for any grid gets one.
        let coarse = Grid::new(&triangles, GridOptions { most_bytes: Some(0), ..options });
        assert_eq!(coarse.memory() as u64, bytes);
    }

    #[test]
    fn a_grid_of_nothing_or_of_one_point_has_a_voxel() {
        for triangles in [vec![], vec![[Vec3::ONE; 3]; 5], vec![[Vec3::NAN; 3]; 2]] {
            let triangles = Triangles::from_iter(triangles);
            for voxels in [0, 1, 1000, usize::MAX] {
                let options = GridOptions::uniform(&triangles, voxels);
                let resolution = options.resolution.unwrap();
                assert!(resolution.iter().all(|&n| n >= 1), "{resolution:?}");
                assert!(Grid::of_resolution(&triangles, options).is_ok(), "{resolution:?}");
            }
        }
    }

    #[test]
    fn entries_are_never_more_than_there_are_places_for() {
        assert_eq!(most_entries(1000), 64_000);
        assert_eq!(most_entries((1 << 26) - 1), u32::MAX - 63);
        for triangles in [1 << 26, u32::MAX as usize, usize::MAX] {
            assert_eq!(most_entries(triangles), u32::MAX, "{triangles}");
        }
    }
}
