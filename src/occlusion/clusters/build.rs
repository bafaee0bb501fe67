//! Grouping triangles into clusters, and clusters into nodes.
//!
//! Top down by the surface area heuristic (MacDonald & Booth 1990; Wald 2007): many triangles by the cells of a grid, several levels of the
//! tree at once (`cells`), then in bins along the longest axis (`divide`), few of them exactly (`few`); then halves are put into nodes
//! of eight (`collapse`). The counts that the heuristic weighs are clusters: a cluster costs the same however full it is. So most come out
//! full, but not where a few triangles are apart from the rest: cuts at multiples of eight took 4 bytes a triangle less, and 1.6 times
//! the tests where things are small and apart.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.
//! Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;

use rayon::prelude::*;

use super::cells::{self, MANY, Part};
use super::collapse::{Half, collapse};
use super::divide::{Around, Divided, Item, divide, places_of};
use super::few::{self, FEW};
use super::{Cluster, Clusters, Node, WIDTH};
use crate::geometry::lanes::Available;
use crate::geometry::{TriangleId, Triangles, is_finite};
use crate::large_pages::vec_with_room;
use crate::occlusion::Eight;

/// Ranges with fewer triangles are split by one thread.
const WORTH_A_THREAD: usize = 8192;

/// Of these triangles, without those that are not finite: they block nothing, and no box is around a NaN.
pub(super) fn build(triangles: &Triangles, ids: Range<TriangleId>) -> Clusters {
    if triangles.are_finite() {
        return build_by_numbers(triangles, ids.len(), |number| ids.start + number as TriangleId);
    }
    let finite: Vec<TriangleId> = ids.filter(|&id| is_finite(&triangles.get(id))).collect();
    build_by_numbers(triangles, finite.len(), |number| finite[number])
}

/// Of so many triangles, each of which `id` gives by its number.
fn build_by_numbers(
    triangles: &Triangles,
    count: usize,
    id: impl Fn(usize) -> TriangleId,
) -> Clusters {
    let arithmetic = Available::newest();
    let item = |number| {
        let id = id(number);
        Item::new(triangles.corners()[id as usize], id)
    };
    let arranging = Arranging { arithmetic };
    let mut items = vec_with_room(count);
    items.resize(count, Item(Around::NOTHING));
    let tree = if count < MANY {
        items.iter_mut().enumerate().for_each(|(number, slot)| *slot = item(number));
        if items.is_empty() {
            return Clusters::default();
        }
        let places = places_of(&items);
        arranging.arrange(&mut items, &places, 0)
    } else {
        let places = Around::places_within(triangles.bounds().unwrap_or_default());
        let part = cells::sort(&mut items, &places, item);
        arranging.arrange_part(part, &mut items, 0)
    };
    let (nodes, runs) = collapse(&tree);
    let cluster = |run: Range<u32>| {
        let run = &items[run.start as usize..run.end as usize];
        let ids = std::array::from_fn(|lane| run[lane.min(run.len() - 1)].id());
        Cluster { corners: Eight::new(triangles, &ids, arithmetic), ids }
    };
    let mut clusters: Vec<Cluster> = vec_with_room(runs.len());
    runs.into_par_iter().with_min_len(512).map(cluster).collect_into_vec(&mut clusters);
    let sum: f64 = nodes.iter().map(Node::sum_of_cluster_extents).sum();
    let typical_extent = (sum / clusters.len() as f64) as f32;
    Clusters { clusters, nodes, typical_extent }
}

/// Sorts items so that those of a cluster are in a row. `first` is the place of the first one among all.
#[derive(Clone, Copy)]
struct Arranging {
    arithmetic: Available,
}

impl Arranging {
    /// The box is around their places, or somewhat larger.
    fn arrange(self, items: &mut [Item], places: &Around, first: u32) -> Half {
        let count = items.len();
        if count <= WIDTH {
            let mut around = Around::NOTHING;
            for Item(item) in &*items {
                around.join(item);
            }
            return Half::cluster(around.bounds(), first..first + count as u32);
        }
        if count >= MANY {
            let unsorted = items.to_vec();
            let part = cells::sort(items, places, |number| unsorted[number]);
            drop(unsorted);
            if part.inside.is_some() {
                return self.arrange_part(part, items, first);
            }
        }
        let Divided { at, sides } = if count <= FEW {
            few::divide(items, places, self.arithmetic)
        } else {
            divide(items, places)
        };
        let (left, right) = items.split_at_mut(at);
        Half::of(both(
            count,
            || self.arrange(left, &sides[0], first),
            || self.arrange(right, &sides[1], first + at as u32),
        ))
    }

    /// The same of items that are sorted in parts.
    fn arrange_part(self, part: Part, items: &mut [Item], first: u32) -> Half {
        let Some(inside) = part.inside else {
            return self.arrange(items, &places_of(items), first);
        };
        let count = items.len();
        let [left, right] = *inside;
        let at = left.items.len();
        let (left_items, right_items) = items.split_at_mut(at);
        Half::of(both(
            count,
            || self.arrange_part(left, left_items, first),
            || self.arrange_part(right, right_items, first + at as u32),
        ))
    }
}

/// Does both, at once if it is about many items.
fn both<T: Send>(
    count: usize,
    left: impl FnOnce() -> T + Send,
    right: impl FnOnce() -> T + Send,
) -> [T; 2] {
    let (left, right) =
        if count < WORTH_A_THREAD { (left(), right()) } else { rayon::join(left, right) };
    [left, right]
}
