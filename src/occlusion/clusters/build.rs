//! Grouping triangles into clusters, and clusters into nodes.
//!
//! Top down by the surface area heuristic (MacDonald & Booth 1990; Wald 2007): many triangles by the cells of a grid, several levels of the
//! tree at once (`cells`), then in bins along the longest axis (`divide`); few of them are sorted along it, and every cut is weighed (`few`).
//! Then halves are put into nodes of eight (`collapse`). The counts that the heuristic weighs are clusters: a cluster costs the same
//! however full it is. So most come out full, but not where a few triangles are apart from the rest: cuts at multiples of eight took 4
//! bytes a triangle less, and 1.6 times the tests where things are small and apart.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.
//! Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;

use rayon::prelude::*;

use super::cells::{self, MANY, Part};
use super::collapse::{Nodes, Tree};
use super::divide::{Around, Divided, Item, divide, places_of};
use super::few::{self, FEW, Sweeps};
use super::{Cluster, Clusters, Node, WIDTH};
use crate::geometry::lanes::Available;
use crate::geometry::{TriangleId, Triangles, is_finite};
use crate::large_pages::{vec_with_room, zeros};
use crate::occlusion::eight::{AHEAD, Eight};

/// Portions with fewer triangles are divided, and put into nodes, by one thread: what comes out depends on this, not on how many
/// threads there are.
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
    if count == 0 {
        return Clusters::default();
    }
    let item = |number| {
        let id = id(number);
        Item::new(triangles.corners()[id as usize], id)
    };
    let mut items = zeros(count);
    let known = if count < MANY {
        items.iter_mut().enumerate().for_each(|(number, slot)| *slot = item(number));
        Known::Places(places_of(&items))
    } else {
        let places = Around::places_within(triangles.bounds().unwrap_or_default());
        Known::Part(cells::sort(&mut items, &places, item))
    };
    let mut sorted: Vec<TriangleId> = zeros(count);
    let all = Portion { items: &mut items, sorted: &mut sorted, first: 0, known };
    let tree = Builder { arithmetic: Available::newest_for_short_integers() }.tree(all);
    drop(items);
    let Nodes { mut nodes, runs } = tree.into_nodes();
    nodes.shrink_to_fit();
    let arithmetic = Available::newest();
    let cluster = |run: Range<u32>| {
        let soon = run.start as usize + AHEAD * WIDTH;
        if let Some(soon) = sorted.get(soon..soon + run.len()) {
            Eight::announce(triangles, soon);
        }
        let run = &sorted[run.start as usize..run.end as usize];
        let ids = std::array::from_fn(|lane| run[lane.min(run.len() - 1)]);
        Cluster { corners: Eight::new(triangles, &ids, arithmetic), ids }
    };
    let mut clusters: Vec<Cluster> = vec_with_room(runs.len());
    runs.into_par_iter().with_min_len(512).map(cluster).collect_into_vec(&mut clusters);
    let sum: f64 = nodes.iter().map(Node::sum_of_cluster_extents).sum();
    let typical_extent = (sum / clusters.len() as f64) as f32;
    Clusters { clusters, nodes, typical_extent }
}

/// A portion of all triangles.
struct Portion<'a> {
    items: &'a mut [Item],
    /// Where they are to be in the end, those of a cluster in a row.
    sorted: &'a mut [TriangleId],
    /// The place of the first one among all.
    first: u32,
    known: Known,
}

/// What is known of the places of some items.
enum Known {
    /// They are a part of a grid, which may be divided further.
    Part(Part),
    /// The box around them, or one somewhat larger.
    Places(Around),
}

/// Sorts triangles, moving their items about, and builds the tree over them.
#[derive(Clone, Copy)]
struct Builder {
    arithmetic: Available,
}

impl Builder {
    /// The tree over a portion; of a large one, several threads build it.
    fn tree(self, portion: Portion) -> Tree {
        let count = portion.items.len();
        if count < WORTH_A_THREAD {
            let mut tree = Tree::with_room(count);
            self.add(&mut tree, portion, &mut Sweeps::new());
            return tree.collapsed();
        }
        let [left, right] = self.divide(portion);
        let (left, right) = rayon::join(|| self.tree(left), || self.tree(right));
        Tree::of([left, right])
    }

    /// Adds a portion to a tree.
    fn add(self, tree: &mut Tree, portion: Portion, sweeps: &mut Sweeps) {
        if portion.items.len() <= FEW {
            let Portion { items, sorted, first, .. } = portion;
            return few::add(tree, items, sorted, first, sweeps, self.arithmetic);
        }
        let [left, right] = self.divide(portion);
        self.add(tree, left, sweeps);
        let left = tree.last();
        self.add(tree, right, sweeps);
        tree.join(left);
    }

    /// A portion of more than [`FEW`], in two.
    fn divide(self, portion: Portion) -> [Portion; 2] {
        let Portion { items, sorted, first, known } = portion;
        let (at, [left_known, right_known]) = match known {
            Known::Part(Part { inside: Some(inside), .. }) => parts(*inside),
            Known::Part(_) => self.divide_unsorted(items, &places_of(items)),
            Known::Places(places) => self.divide_unsorted(items, &places),
        };
        let (left, right) = items.split_at_mut(at);
        let (left_sorted, right_sorted) = sorted.split_at_mut(at);
        let second = first + at as u32;
        [
            Portion { items: left, sorted: left_sorted, first, known: left_known },
            Portion { items: right, sorted: right_sorted, first: second, known: right_known },
        ]
    }

    /// Moves items about: how many are now to the left, and what is known of both sides.
    fn divide_unsorted(self, items: &mut [Item], places: &Around) -> (usize, [Known; 2]) {
        if items.len() >= MANY {
            let unsorted = items.to_vec();
            let part = cells::sort(items, places, |number| unsorted[number]);
            if let Some(inside) = part.inside {
                return parts(*inside);
            }
        }
        let Divided { at, sides } = divide(items, places, self.arithmetic);
        (at, sides.map(Known::Places))
    }
}

fn parts([left, right]: [Part; 2]) -> (usize, [Known; 2]) {
    (left.items.len(), [left, right].map(Known::Part))
}
