//! Voxels, and what can be proven about all rays from one of them to a light: the ground of
//! `voxel-occlusion` and `shadow-polygons`.

mod neighbours;
mod shaft;
mod source;

use std::sync::Arc;

use glam::DVec3;

pub(super) use neighbours::{Neighbours, edge};
pub(super) use shaft::{Facing, Shaft, widened};
pub(super) use source::Source;

use super::Budget;
use crate::exact::Exact;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::{Clip, Engine, Grid, Level, Occlusion, Steps, Tally, TooFine, Walk};

/// A closed box in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub low: DVec3,
    pub high: DVec3,
}

impl Span {
    #[inline]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }
}

/// Bytes of a grid for each of its voxels, about, and for each entry of its lists.
const VOXEL_BYTES: f64 = 8.0;
const ENTRY_BYTES: f64 = size_of::<TriangleId>() as f64;

/// A uniform grid of its own, whatever the backend; answers by the exact test.
pub(super) struct Voxels {
    triangles: Arc<Triangles>,
    grid: Arc<Grid>,
    exact: Engine<Arc<Grid>, Exact>,
}

impl Voxels {
    /// A grid with `density` voxels to a triangle, or coarser where the budget does not allow for it and
    /// another `bytes_a_voxel`, which are all taken from the budget. None where that leaves too few.
    /// Also says what is missing for the finest one: bytes, at least; 0 if that is what it is.
    fn within(
        triangles: &Arc<Triangles>,
        density: f64,
        bytes_a_voxel: f64,
        budget: &Budget,
    ) -> (Option<Self>, u64) {
        let wanted = wanted(triangles, density);
        let left = budget.left() as f64;
        let bytes = |voxels, entries| Self::bytes(voxels, bytes_a_voxel, entries);
        let mut missing = bytes(wanted, triangles.len() as f64) - left;
        let mut voxels = wanted;
        while voxels >= FEWEST {
            let entries = (left - bytes(voxels, 0.0)) / ENTRY_BYTES;
            // Each triangle has an entry at least: a grid that will not fit need not be tried.
            if entries >= triangles.len() as f64 {
                match Grid::with_at_most(triangles, voxels as usize, entries as u32) {
                    Ok(grid) => {
                        let held =
                            grid.memory() + (grid.voxel_count() as f64 * bytes_a_voxel) as usize;
                        if budget.take(held) {
                            // Where memory is not what is missing, there are too many entries.
                            let missing = if voxels < wanted { missing as u64 } else { 0 };
                            return (Some(Self::over(triangles, grid)), missing);
                        }
                        if voxels == wanted {
                            missing = held as f64 - left;
                        }
                    }
                    Err(TooFine { entries, .. }) if voxels == wanted => {
                        missing = bytes(wanted, entries as f64) - left;
                    }
                    Err(_) => {}
                }
            }
            voxels /= COARSER;
        }
        (None, missing.max(1.0) as u64)
    }

    /// Bytes of so many voxels, with what is held for each, and so many entries.
    fn bytes(voxels: f64, bytes_a_voxel: f64, entries: f64) -> f64 {
        voxels * (VOXEL_BYTES + bytes_a_voxel) + entries * ENTRY_BYTES
    }

    /// The same, and which triangles lie beyond whose edges; says in `notes` what the budget does not allow.
    pub fn with_neighbours(
        triangles: &Arc<Triangles>,
        density: f64,
        bytes_a_voxel: f64,
        budget: &Budget,
        notes: &mut Vec<String>,
    ) -> Option<(Self, Neighbours)> {
        let bytes = Neighbours::bytes(triangles);
        let left = budget.left();
        let missing = if budget.take(bytes) {
            let (voxels, missing) = Self::within(triangles, density, bytes_a_voxel, budget);
            if let Some(voxels) = voxels {
                if missing > 0 {
                    let [x, y, z] = voxels.level().resolution;
                    // What they take now would be free for finer ones.
                    let advice = budget.advice(budget.left() + missing);
                    notes.push(format!(
                        "{x} by {y} by {z} voxels only, to keep the memory limit; {advice}"
                    ));
                }
                return Some((voxels, Neighbours::new(triangles)));
            }
            budget.give_back(bytes);
            missing
        } else {
            let voxels = wanted(triangles, density);
            let least = Self::bytes(voxels, bytes_a_voxel, triangles.len() as f64);
            (bytes as u64).saturating_sub(left) + least as u64
        };
        let advice = budget.advice(left + missing);
        notes.push(format!(
            "steps aside: the memory limit leaves {left} bytes, too few for voxels; {advice}"
        ));
        None
    }

    fn over(triangles: &Arc<Triangles>, grid: Grid) -> Self {
        let grid = Arc::new(grid);
        let exact = Engine::new(triangles.clone(), grid.clone(), None);
        Self { triangles: triangles.clone(), grid, exact }
    }

    pub fn count(&self) -> usize {
        self.grid.voxel_count()
    }

    pub fn level(&self) -> &Level {
        self.grid.level()
    }

    pub fn memory(&self) -> usize {
        self.grid.memory()
    }

    /// A voxel with all that a ray said to be in it may touch.
    pub fn span(&self, voxel: [u32; 3]) -> Span {
        let level = self.level();
        let low = level.corner(voxel);
        Span { low: low - level.pad, high: low + level.side + level.pad }
    }

    /// The opaque triangles that come near a voxel, in ascending order.
    pub fn opaque_in(&self, index: usize) -> &[TriangleId] {
        let cell = self.grid.listed(index);
        let all = &self.grid.order()[cell.start as usize..cell.end as usize];
        &all[..all.partition_point(|&id| self.triangles.is_opaque(id))]
    }

    pub fn corners(&self, id: TriangleId) -> [DVec3; 3] {
        widened(self.triangles.get(id))
    }

    /// The voxels along a ray; `None` for one from too far away to say.
    #[inline]
    pub fn steps(&self, ray: &Ray) -> Option<Steps<'_>> {
        match self.grid.clip(ray) {
            Clip::Inside(enter, leave) => Some(Steps::new(self.level(), ray, enter, leave)),
            Clip::Outside | Clip::Everything => None,
        }
    }

    /// Whether an opaque triangle that is listed in a voxel blocks the ray, wherever.
    #[inline]
    pub fn blocked_in(&self, index: usize, ray: &Ray, tally: &mut Tally) -> bool {
        let cell = self.grid.listed(index);
        cell.start < cell.end && self.exact.occluder_in(cell, ray, tally).is_some()
    }

    /// A triangle that blocks the ray.
    pub fn occluder(&self, ray: &Ray, tally: &mut Tally) -> Option<TriangleId> {
        self.exact.occluder(ray, tally).map(|found| found.triangle)
    }
}

/// With fewer voxels than this, nothing is worth preparing.
const FEWEST: f64 = 64.0;

/// Voxels of a grid with so many to a triangle.
fn wanted(triangles: &Triangles, density: f64) -> f64 {
    (density * triangles.len() as f64).clamp(FEWEST, MOST)
}

/// Most voxels of a grid: what is decided a voxel would take longer than rays could win back.
const MOST: f64 = (1 << 21) as f64;

/// How many times fewer voxels the next coarser grid has.
const COARSER: f64 = 8.0;

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Triangles as large as the scene: each lies in many voxels.
    fn large(count: u32) -> Arc<Triangles> {
        let place = |number: u32| ((number as f32 * 0.618).fract() - 0.5) * 2.0;
        let corner = |number: u32| Vec3::new(place(number), place(7 * number), place(31 * number));
        let triangle = |number: u32| [3 * number, 3 * number + 1, 3 * number + 2].map(corner);
        Arc::new((0..count).map(triangle).collect())
    }

    #[test]
    fn who_follows_the_advice_comes_to_voxels_as_fine_as_wanted() {
        let triangles = large(2000);
        let mut bytes = 1000;
        let mut tries = 0;
        loop {
            let budget = Budget::new(bytes);
            let mut notes = Vec::new();
            let made = Voxels::with_neighbours(&triangles, 8.0, 4.0, &budget, &mut notes);
            if let Some((voxels, _)) = &made {
                assert!(voxels.memory() as u64 <= bytes);
            }
            let [note] = &notes[..] else { break assert!(made.is_some() && notes.is_empty()) };
            let advised = note.split("--memory ").nth(1).and_then(|rest| rest.split('M').next());
            let advised: u64 = advised.and_then(|number| number.parse().ok()).expect("advice");
            assert!(advised << 20 > bytes, "{note} at {bytes} bytes");
            bytes = advised << 20;
            tries += 1;
            assert!(tries <= 3, "{note}");
        }
        assert!(tries > 0);
    }
}
