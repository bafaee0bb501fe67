//! Grouping triangles into clusters, and clusters into nodes.
//!
//! Top down by the surface area heuristic with bins along the longest axis (MacDonald & Booth 1990; Wald
//! 2007), always at a multiple of eight triangles, so that all clusters but the last are full; then halves are
//! collapsed into nodes of eight. The counts that the heuristic weighs are clusters: a cluster costs
//! the same however full it is. How a range is divided: `divide`.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.
//! Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;

use glam::Vec3;

use super::divide::{Around, Divided, Item, divide, places_of};
use super::{Child, Cluster, Clusters, Node, WIDTH};
use crate::geometry::{Bounds, TriangleId, Triangles};

/// Ranges with fewer triangles are split by one thread.
const WORTH_A_THREAD: usize = 8192;

pub(super) fn build(triangles: &Triangles, ids: Range<TriangleId>) -> Clusters {
    let mut items: Vec<Item> = ids.map(|id| Item::new(triangles.bounds_of(id), id)).collect();
    if items.is_empty() {
        return Clusters::default();
    }
    let places = places_of(&items);
    let tree = arrange(&mut items, &places, 0);
    let clusters: Vec<Cluster> = items.chunks(WIDTH).map(|run| cluster(triangles, run)).collect();
    let mut nodes = Vec::new();
    collapse(&tree, &mut nodes);
    nodes.shrink_to_fit();
    let sum: f64 = nodes.iter().map(Node::sum_of_cluster_extents).sum();
    let typical_extent = (sum / clusters.len() as f64) as f32;
    Clusters { clusters, nodes, typical_extent }
}

fn cluster(triangles: &Triangles, run: &[Item]) -> Cluster {
    let ids: [TriangleId; WIDTH] = std::array::from_fn(|lane| run[lane.min(run.len() - 1)].id());
    let lanes = ids.map(|id| triangles.get(id));
    let corners = [0, 1, 2]
        .map(|corner| [0, 1, 2].map(|axis| std::array::from_fn(|lane| lanes[lane][corner][axis])));
    Cluster { corners, ids }
}

/// A tree while it is built: two halves, or a cluster.
struct Half {
    bounds: Bounds,
    inside: Option<Box<[Half; 2]>>,
    /// The first cluster in it.
    first: u32,
}

/// Sorts the items so that each eight in a row are a cluster. The box is around their places, or somewhat larger.
fn arrange(items: &mut [Item], places: &Around, first: u32) -> Half {
    if items.len() <= WIDTH {
        let mut around = Around::NOTHING;
        for Item(item) in &*items {
            around.join(item);
        }
        return Half { bounds: around.bounds(), inside: None, first };
    }
    let Divided { at, sides } = divide(items, places);
    let (left, right) = items.split_at_mut(at);
    let middle = first + (at / WIDTH) as u32;
    let (left, right) = if left.len() + right.len() < WORTH_A_THREAD {
        (arrange(left, &sides[0], first), arrange(right, &sides[1], middle))
    } else {
        rayon::join(|| arrange(left, &sides[0], first), || arrange(right, &sides[1], middle))
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

fn half_area(bounds: Bounds) -> f32 {
    let Vec3 { x, y, z } = bounds.extent();
    x * y + y * z + z * x
}
