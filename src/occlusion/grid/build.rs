//! Sorting triangles into voxels, and dividing those that are crowded.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::level::{Content, Level};
use super::voxelize::overlapped;
use super::{Grid, MOST_ENTRIES, PADDING, resolution};
use crate::geometry::{Bounds, TriangleId, Triangles};

/// A voxel with more triangles than this is divided.
const CROWDED: usize = 16;

/// Voxels to a triangle of the grid in a crowded voxel.
const DENSITY: f64 = 2.0;

/// Most voxels along one axis of a nested grid.
const MOST_NESTED: u32 = 64;

/// Grids within grids at most.
pub(super) const MOST_LEVELS: usize = 6;

/// A voxel is divided only if that leaves at most this share of its triangles, on average, to a
/// voxel inside that holds any.
const LEAST_GAIN: f64 = 0.7;

/// A grid in the making: which triangles lie in which voxel.
struct Sorted {
    /// Where each voxel's list starts; one more than there are voxels.
    starts: Vec<u32>,
    lists: Vec<TriangleId>,
}

impl Sorted {
    fn list(&self, voxel: usize) -> &[TriangleId] {
        &self.lists[self.starts[voxel] as usize..self.starts[voxel + 1] as usize]
    }
}

/// The contents of one voxel: its list, or the grid that divides it.
enum Voxel {
    List(Vec<TriangleId>),
    Divided(Box<Division>),
}

/// A grid that divides a voxel, with its voxels that hold anything.
struct Division {
    level: Level,
    voxels: Vec<(usize, Voxel)>,
}

/// There would be too many entries at this resolution.
pub(super) struct TooFine {
    pub resolution: [u32; 3],
}

/// Builds a grid with at most so many entries in the voxels of the outermost one.
pub(super) fn build(
    triangles: &Triangles,
    outermost: Level,
    nested: bool,
    most: usize,
) -> Result<Grid, TooFine> {
    let resolution = outermost.resolution;
    let sorted = sort(&outermost, triangles, most).ok_or(TooFine { resolution })?;
    let voxels = outermost.voxel_count();
    let scene = triangles.bounds().unwrap_or_default();
    let divider = Divider { triangles, scene };
    let crowded: Vec<usize> =
        (0..voxels).filter(|&voxel| nested && sorted.list(voxel).len() > CROWDED).collect();
    let divided: Vec<(usize, Division)> = crowded
        .into_par_iter()
        .filter_map(|voxel| {
            let division = divider.divide(&outermost, voxel, sorted.list(voxel), 1)?;
            Some((voxel, division))
        })
        .collect();

    let max = outermost.corner(outermost.resolution);
    let mut grid = Grid {
        min: outermost.min,
        max,
        levels: vec![outermost],
        voxels: vec![Content::EMPTY; voxels],
        starts: Vec::new(),
        order: Vec::with_capacity(sorted.lists.len()),
    };
    let mut divided = divided.into_iter().peekable();
    for voxel in 0..voxels {
        let division = divided.next_if(|(divided, _)| *divided == voxel);
        grid.voxels[voxel] = match division {
            Some((_, division)) => grid.add_division(division),
            None => grid.add_list(sorted.list(voxel)),
        };
    }
    grid.starts.push(end_of(&grid.order));
    grid.starts.shrink_to_fit();
    grid.order.shrink_to_fit();
    Ok(grid)
}

impl Grid {
    fn add_list(&mut self, list: &[TriangleId]) -> Content {
        if list.is_empty() {
            return Content::EMPTY;
        }
        self.starts.push(end_of(&self.order));
        self.order.extend_from_slice(list);
        Content::of_list(self.starts.len() - 1)
    }

    fn add_division(&mut self, Division { mut level, voxels }: Division) -> Content {
        let first = self.voxels.len();
        level.first = first;
        self.voxels.resize(first + level.voxel_count(), Content::EMPTY);
        let content = Content::of_nested(self.levels.len());
        self.levels.push(level);
        for (voxel, inside) in voxels {
            self.voxels[first + voxel] = match inside {
                Voxel::List(list) => self.add_list(&list),
                Voxel::Divided(division) => self.add_division(*division),
            };
        }
        content
    }
}

fn end_of(order: &[TriangleId]) -> u32 {
    u32::try_from(order.len()).expect("fewer than 2^32 entries in voxels")
}

struct Divider<'a> {
    triangles: &'a Triangles,
    scene: Bounds,
}

impl Divider<'_> {
    /// Divides a voxel of `outer`, and what is crowded inside; `None` where that gains too little.
    fn divide(
        &self,
        outer: &Level,
        voxel: usize,
        list: &[TriangleId],
        depth: usize,
    ) -> Option<Division> {
        let [width, height, _] = outer.resolution.map(|n| n as usize);
        let place = [voxel % width, voxel / width % height, voxel / (width * height)];
        let min = outer.corner(place.map(|n| n as u32));
        let max = min + outer.side;
        let resolution = resolution(outer.side, DENSITY * list.len() as f64);
        let resolution = resolution.map(|n| n.clamp(2, MOST_NESTED));
        let level = Level::new(min, max, resolution, &self.scene);
        // Below this size rounding of the coordinates, not the triangles, would decide about voxels.
        if level.pad > 16.0 * PADDING * level.side.min_element() {
            return None;
        }
        let mut inside: Vec<(usize, TriangleId)> = Vec::new();
        for &id in list {
            // Dividing what lies on each other separates nothing.
            if inside.len() > MOST_ENTRIES * list.len() {
                return None;
            }
            overlapped(&level, &self.triangles.get(id), |voxel| inside.push((voxel, id)));
        }
        // The sort is stable: ids stay in ascending order.
        inside.sort_by_key(|&(voxel, _)| voxel);
        let runs: Vec<&[(usize, TriangleId)]> = inside.chunk_by(|a, b| a.0 == b.0).collect();
        if inside.len() as f64 > LEAST_GAIN * (list.len() * runs.len()) as f64 {
            return None;
        }
        let voxels = runs
            .into_iter()
            .map(|run| {
                let list: Vec<TriangleId> = run.iter().map(|&(_, id)| id).collect();
                let again = list.len() > CROWDED && depth + 1 < MOST_LEVELS;
                let division =
                    again.then(|| self.divide(&level, run[0].0, &list, depth + 1)).flatten();
                (run[0].0, division.map_or(Voxel::List(list), |d| Voxel::Divided(Box::new(d))))
            })
            .collect();
        Some(Division { level, voxels })
    }
}

/// Sorts all triangles into the voxels of the outermost grid; ids ascend in each list. `None` if there are more
/// entries than `most`.
fn sort(level: &Level, triangles: &Triangles, most: usize) -> Option<Sorted> {
    let counts: Vec<AtomicU32> = (0..level.voxel_count()).map(|_| AtomicU32::new(0)).collect();
    let entries = AtomicUsize::new(0);
    let ids = 0..triangles.len() as u32;
    ids.clone().into_par_iter().for_each(|id| {
        if entries.load(Relaxed) > most {
            return;
        }
        let mut voxels = 0;
        overlapped(level, &triangles.get(id), |voxel| {
            counts[voxel].fetch_add(1, Relaxed);
            voxels += 1;
        });
        entries.fetch_add(voxels, Relaxed);
    });
    if entries.into_inner() > most {
        return None;
    }
    let mut starts = Vec::with_capacity(counts.len() + 1);
    let mut total = 0u32;
    for count in &counts {
        starts.push(total);
        let next = total.checked_add(count.load(Relaxed));
        total = next.expect("fewer than 2^32 entries in voxels");
    }
    starts.push(total);
    // From here on the counts are places: where the next triangle of each voxel goes.
    for (count, &start) in counts.iter().zip(&starts) {
        count.store(start, Relaxed);
    }
    let lists: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
    ids.into_par_iter().for_each(|id| {
        overlapped(level, &triangles.get(id), |voxel| {
            let place = counts[voxel].fetch_add(1, Relaxed);
            lists[place as usize].store(id, Relaxed);
        });
    });
    let mut lists: Vec<TriangleId> = lists.into_iter().map(AtomicU32::into_inner).collect();
    sort_lists(&starts, &mut lists);
    Some(Sorted { starts, lists })
}

/// Sorts each voxel's list, so that the grid does not depend on which thread came first.
fn sort_lists(starts: &[u32], lists: &mut [TriangleId]) {
    const VOXELS_A_JOB: usize = 4096;
    let mut rest = lists;
    let mut jobs = Vec::new();
    for first in (0..starts.len() - 1).step_by(VOXELS_A_JOB) {
        let starts = &starts[first..(first + VOXELS_A_JOB + 1).min(starts.len())];
        let (lists, later) = rest.split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
        rest = later;
        jobs.push((starts, lists));
    }
    jobs.into_par_iter().for_each(|(starts, lists)| {
        for run in starts.windows(2) {
            lists[(run[0] - starts[0]) as usize..(run[1] - starts[0]) as usize].sort_unstable();
        }
    });
}
