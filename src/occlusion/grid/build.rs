//! Sorting triangles into voxels.

use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::level::Level;
use super::voxelize::overlapped;
use super::{Grid, TooFine};
use crate::geometry::{TriangleId, Triangles};

/// Builds a grid with at most so many entries, which places in the order can count; ids ascend in each list.
pub(super) fn build(triangles: &Triangles, level: Level, most: u32) -> Result<Grid, TooFine> {
    let counts: Vec<AtomicU32> = (0..level.voxel_count()).map(|_| AtomicU32::new(0)).collect();
    count(triangles, &level, &counts, most)?;
    let mut lists = Vec::with_capacity(counts.len());
    let mut starts = Vec::new();
    let mut total = 0u32;
    for count in &counts {
        // From here on the counts are places: where the next triangle of each voxel goes.
        let listed = count.swap(total, Relaxed);
        if listed > 0 {
            starts.push(total);
            total += listed;
        }
        lists.push(if listed > 0 { starts.len() as u32 } else { 0 });
    }
    starts.push(total);
    starts.shrink_to_fit();
    let order: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
    (0..triangles.len() as TriangleId).into_par_iter().for_each(|id| {
        overlapped(&level, &triangles.get(id), |voxel| {
            let place = counts[voxel].fetch_add(1, Relaxed);
            order[place as usize].store(id, Relaxed);
        });
    });
    let mut order: Vec<TriangleId> = order.into_iter().map(AtomicU32::into_inner).collect();
    sort_lists(&starts, &mut order);
    let max = level.corner(level.resolution);
    Ok(Grid { level, max, lists, starts, order })
}

/// Counts the triangles in each voxel, until there are more than so many in all.
fn count(
    triangles: &Triangles,
    level: &Level,
    counts: &[AtomicU32],
    most: u32,
) -> Result<(), TooFine> {
    let (entries, tried) = (AtomicU64::new(0), AtomicUsize::new(0));
    let are_too_many = |entries: u64| entries > u64::from(most);
    (0..triangles.len() as TriangleId).into_par_iter().for_each(|id| {
        if are_too_many(entries.load(Relaxed)) {
            return;
        }
        let mut voxels = 0;
        overlapped(level, &triangles.get(id), |voxel| {
            counts[voxel].fetch_add(1, Relaxed);
            voxels += 1;
        });
        entries.fetch_add(voxels, Relaxed);
        tried.fetch_add(1, Relaxed);
    });
    let (entries, tried) = (entries.into_inner(), tried.into_inner());
    if !are_too_many(entries) {
        return Ok(());
    }
    let share = triangles.len() as f64 / tried as f64;
    let entries = (entries as f64 * share) as u64;
    Err(TooFine { resolution: level.resolution, entries, most })
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

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::occlusion::GridOptions;

    #[test]
    fn a_grid_with_too_many_entries_is_refused_with_their_number() {
        // Each of them lies in all 64 voxels of a layer, or in half of them.
        let sheet = [Vec3::ZERO, Vec3::new(8.0, 0.0, 0.0), Vec3::new(0.0, 8.0, 0.0)];
        let triangles = Triangles::from_iter(vec![sheet; 1000]);
        let options =
            GridOptions { resolution: Some([8, 8, 1]), nested: false, ..GridOptions::default() };
        let grid = Grid::of_resolution(&triangles, options).unwrap();
        let entries = grid.order.len() as u32;
        assert!((32_000..=64_000).contains(&entries), "{entries}");
        assert!(build(&triangles, grid.level.clone(), entries).is_ok());
        let refused = build(&triangles, grid.level.clone(), entries / 10).err().unwrap();
        let (entries, most) = (u64::from(entries), entries / 10);
        assert_eq!(refused, TooFine { resolution: [8, 8, 1], entries, most });
        let line = format!(
            "a grid of 8x8x1 voxels would list triangles some {entries} times, which is more than {most}; give --grid fewer voxels"
        );
        assert_eq!(refused.to_string(), line);
    }
}
