//! Grouping triangles into clusters, and clusters into nodes.
//!
//! Top down by the surface area heuristic with bins along the longest axis (MacDonald & Booth 1990; Wald
//! 2007), always at a multiple of eight triangles, so that all clusters but the last are full; then halves are
//! collapsed into nodes of eight. The counts that the heuristic weighs are clusters: a cluster costs
//! the same however full it is.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.
//! Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;

use glam::Vec3;

use super::{Child, Cluster, Clusters, Node, WIDTH};
use crate::geometry::{Bounds, TriangleId, Triangles};

/// Bins in which a range of triangles is sorted to find where to split it.
const BINS: usize = 16;

/// Ranges with fewer triangles are split by one thread.
const WORTH_A_THREAD: usize = 8192;

pub(super) fn build(triangles: &Triangles, ids: Range<TriangleId>) -> Clusters {
    let mut items: Vec<Item> = ids.map(|id| Item { bounds: triangles.bounds_of(id), id }).collect();
    if items.is_empty() {
        return Clusters::default();
    }
    let tree = arrange(&mut items, 0);
    let clusters: Vec<Cluster> = items.chunks(WIDTH).map(|run| cluster(triangles, run)).collect();
    let mut nodes = Vec::new();
    collapse(&tree, &mut nodes);
    nodes.shrink_to_fit();
    let sum: f64 = nodes.iter().map(Node::sum_of_cluster_extents).sum();
    let typical_extent = (sum / clusters.len() as f64) as f32;
    Clusters { clusters, nodes, typical_extent }
}

fn cluster(triangles: &Triangles, run: &[Item]) -> Cluster {
    let ids: [TriangleId; WIDTH] = std::array::from_fn(|lane| run[lane.min(run.len() - 1)].id);
    let lanes = ids.map(|id| triangles.get(id));
    let corners = [0, 1, 2]
        .map(|corner| [0, 1, 2].map(|axis| std::array::from_fn(|lane| lanes[lane][corner][axis])));
    Cluster { corners, ids }
}

/// A triangle while its cluster is sought.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    id: TriangleId,
}

impl Item {
    /// Twice the centre of the box.
    #[inline(always)]
    fn place(&self) -> Vec3 {
        self.bounds.min + self.bounds.max
    }
}

/// A tree while it is built: two halves, or a cluster.
struct Half {
    bounds: Bounds,
    inside: Option<Box<[Half; 2]>>,
    /// The first cluster in it.
    first: u32,
}

/// Sorts the items so that each eight in a row are a cluster.
fn arrange(items: &mut [Item], first: u32) -> Half {
    if items.len() <= WIDTH {
        let mut bounds = items[0].bounds;
        for item in &items[1..] {
            bounds = bounds.union(item.bounds);
        }
        return Half { bounds, inside: None, first };
    }
    let at = split(items);
    let (left, right) = items.split_at_mut(at);
    let middle = first + (at / WIDTH) as u32;
    let (left, right) = if left.len() + right.len() < WORTH_A_THREAD {
        (arrange(left, first), arrange(right, middle))
    } else {
        rayon::join(|| arrange(left, first), || arrange(right, middle))
    };
    let bounds = left.bounds.union(right.bounds);
    Half { bounds, inside: Some(Box::new([left, right])), first }
}

/// Makes nodes of eight: of what a node holds, the largest is replaced by its halves as long as there is room.
fn collapse(half: &Half, nodes: &mut Vec<Node>) -> u32 {
    let place = nodes.len() as u32;
    nodes.push(Node::EMPTY);
    let mut held: Vec<&Half> = match &half.inside {
        Some(inside) => inside.iter().collect(),
        None => vec![half],
    };
    while held.len() < WIDTH {
        let parts = held.iter().enumerate().filter(|(_, half)| half.inside.is_some());
        let largest = parts.max_by(|a, b| half_area(a.1.bounds).total_cmp(&half_area(b.1.bounds)));
        let Some((index, Half { inside: Some(inside), .. })) = largest else { break };
        held[index] = &inside[0];
        held.insert(index + 1, &inside[1]);
    }
    for (slot, half) in held.into_iter().enumerate() {
        let child = match half.inside {
            Some(_) => Child::Node(collapse(half, nodes)),
            None => Child::Cluster(half.first),
        };
        nodes[place as usize].set(slot, &half.bounds, child);
    }
    place
}

/// Moves one side's items to the front, and says how many they are: a multiple of [`WIDTH`].
fn split(items: &mut [Item]) -> usize {
    let first = items[0].place();
    let (low, high) = items
        .iter()
        .fold((first, first), |(low, high), item| (low.min(item.place()), high.max(item.place())));
    let extent = high - low;
    let axis = usize::from(extent.y > extent.x);
    let axis = if extent.z > extent[axis] { 2 } else { axis };
    let at = best_split(items, axis, low[axis], extent[axis]);
    items.select_nth_unstable_by(at, |a, b| a.place()[axis].total_cmp(&b.place()[axis]));
    at
}

/// The multiple of [`WIDTH`] next to the cheapest boundary of bins.
fn best_split(items: &[Item], axis: usize, low: f32, extent: f32) -> usize {
    let round = |count: usize| {
        let most = (items.len() - 1) / WIDTH;
        ((count + WIDTH / 2) / WIDTH).clamp(1, most) * WIDTH
    };
    let scale = BINS as f32 / extent;
    if !scale.is_finite() || items.len() <= 2 * WIDTH {
        return round(items.len() / 2);
    }
    let mut bins: [(usize, Option<Bounds>); BINS] = [(0, None); BINS];
    let join = |bounds: Option<Bounds>, other: Bounds| {
        Some(bounds.map_or(other, |bounds| bounds.union(other)))
    };
    for item in items {
        let bin = (((item.place()[axis] - low) * scale) as usize).min(BINS - 1);
        bins[bin] = (bins[bin].0 + 1, join(bins[bin].1, item.bounds));
    }
    // What lies right of each boundary.
    let mut right = [(0usize, 0f32); BINS];
    let (mut count, mut bounds) = (0, None);
    for bin in (1..BINS).rev() {
        count += bins[bin].0;
        if let Some(more) = bins[bin].1 {
            bounds = join(bounds, more);
        }
        right[bin] = (count, bounds.map_or(0.0, half_area));
    }
    let (mut count, mut bounds) = (0, None);
    let mut best = (f32::INFINITY, items.len() / 2);
    for bin in 1..BINS {
        count += bins[bin - 1].0;
        if let Some(more) = bins[bin - 1].1 {
            bounds = join(bounds, more);
        }
        let cost = |(count, area): (usize, f32)| count.div_ceil(WIDTH) as f32 * area;
        let cost = cost((count, bounds.map_or(0.0, half_area))) + cost(right[bin]);
        if count > 0 && right[bin].0 > 0 && cost < best.0 {
            best = (cost, count);
        }
    }
    round(best.1)
}

fn half_area(bounds: Bounds) -> f32 {
    let Vec3 { x, y, z } = bounds.extent();
    x * y + y * z + z * x
}
