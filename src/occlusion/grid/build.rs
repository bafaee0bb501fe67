//! Sorting triangles into voxels, and dividing those that are crowded.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use super::level::{Content, Level};
use super::voxelize::overlapped;
use super::{Grid, MOST_ENTRIES, resolution};
use crate::geometry::{Bounds, TriangleId, Triangles};

/// A voxel with more triangles than this is divided.
pub(super) const CROWDED: usize = 16;

/// Voxels to a triangle of the grid in a crowded voxel.
const DENSITY: f64 = 2.0;

/// Most voxels along one axis of a nested grid.
const MOST_NESTED: u32 = 64;

/// Grids within grids at most.
pub(super) const MOST_LEVELS: usize = 6;

/// A voxel is divided only if that leaves at most this share of its triangles, on average, to a
/// voxel inside that holds any.
const LEAST_GAIN: f64 = 0.7;

/// A grid whose padding is a larger part of a voxel's side would list most triangles several times.
const MOST_PADDING: f64 = 0.25;

/// Where a voxel gains nothing by being divided, its contents do by themselves if their box is this much
/// smaller.
const MUCH_SMALLER: f64 = 0.25;

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
pub(super) struct TooFine(pub [u32; 3]);

/// Builds a grid with at most so many entries in the voxels of the outermost one.
pub(super) fn build(
    triangles: &Triangles,
    outermost: Level,
    nested: bool,
    most: usize,
) -> Result<Grid, TooFine> {
    let resolution = outermost.resolution;
    let sorted = sort(&outermost, triangles, most).ok_or(TooFine(resolution))?;
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
    grid.seal();
    Ok(grid)
}

/// A grid of its own for a crowded voxel of an outermost grid; `None` where that gains too little.
pub(super) fn divide(
    triangles: &Triangles,
    scene: Bounds,
    outermost: &Level,
    voxel: usize,
    list: &[TriangleId],
) -> Option<Grid> {
    let division = Divider { triangles, scene }.divide(outermost, voxel, list, 1)?;
    let level = &division.level;
    let mut grid = Grid {
        // The walk around may err as much as the padding allows.
        min: level.min - outermost.pad,
        max: level.corner(level.resolution) + outermost.pad,
        levels: Vec::new(),
        voxels: Vec::new(),
        starts: Vec::new(),
        order: Vec::new(),
    };
    grid.add_division(division);
    grid.seal();
    Some(grid)
}

impl Grid {
    /// Nothing is added any more.
    fn seal(&mut self) {
        self.starts.push(end_of(&self.order));
        self.starts.shrink_to_fit();
        self.order.shrink_to_fit();
    }

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
        self.divide_box(min, max, list, depth).or_else(|| {
            // A small object in a large voxel ends up in one voxel again.
            let boxes = list.iter().map(|&id| self.triangles.bounds_of(id));
            let contents = boxes.reduce(Bounds::union)?;
            let low = (contents.min.as_dvec3() - outer.pad).max(min);
            let high = (contents.max.as_dvec3() + outer.pad).min(max);
            let volumes = [high - low, max - min].map(DVec3::element_product);
            let smaller = volumes[0] < MUCH_SMALLER * volumes[1];
            smaller.then(|| self.divide_box(low, high, list, depth)).flatten()
        })
    }

    /// Divides a box that all of the triangles inside a voxel lie in. A point of the voxel beside the box
    /// belongs to the nearest voxel inside, which the walk takes it to be in.
    fn divide_box(
        &self,
        min: DVec3,
        max: DVec3,
        list: &[TriangleId],
        depth: usize,
    ) -> Option<Division> {
        let resolution = resolution(max - min, DENSITY * list.len() as f64);
        let resolution = resolution.map(|n| n.clamp(2, MOST_NESTED));
        let level = Level::new(min, max, resolution, &self.scene);
        if level.pad > MOST_PADDING * level.side.min_element() {
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
