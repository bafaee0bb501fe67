//! Dividing all triangles into treelets, and the nodes above those.
//!
//! Few large triangles among small ones make a treelet's box large, and whatever meets it would visit the treelet. So clusters of those are
//! made at once, and put among the nodes above, where the small ones have boxes of their own.
//!
//! Top down by the surface area heuristic (MacDonald & Booth 1990; Wald 2007): many triangles by the cells of a grid, several levels of the
//! tree at once (`cells`), then in bins along the longest axis (`divide`), and within treelets, when these are asked for,
//! exactly (`few`); then halves are put into nodes
//! of eight (`collapse`). The counts that the heuristic weighs are clusters: a cluster costs the same however full it is. So most come out
//! full, but not where a few triangles are apart from the rest: cuts at multiples of eight took 4 bytes a triangle less, and 1.6 times
//! the tests where things are small and apart.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.
//! Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies. Symposium on Interactive Ray Tracing 2007.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::cells::{self, Inside, MANY, Part};
use super::collapse::{Half, Whole, collapse};
use super::divide::{Around, Divided, Item, LEAST, divide, places_of};
use super::treelet::{Arranging, Made, TREELET, Treelet, WITHIN_BITS};
use super::{Child, Cluster, Clusters};
use crate::geometry::lanes::Available;
use crate::geometry::{TriangleId, Triangles, is_finite};
use crate::large_pages::vec_with_room;

/// Ranges with fewer triangles are split by one thread.
const WORTH_A_THREAD: usize = 8192;

/// Their numbers and one within them leave a bit of 32 to say whether it is that of a node or a cluster.
const MOST_TREELETS: usize = 1 << (31 - WITHIN_BITS);

/// Of these triangles, within so many bytes; without those that are not finite: they block nothing, and no box is around a NaN.
pub(super) fn build(triangles: &Arc<Triangles>, ids: Range<TriangleId>, bytes: usize) -> Clusters {
    let clusters = build_with(triangles, ids.clone(), bytes, true);
    if clusters.may_take() <= bytes { clusters } else { build_with(triangles, ids, bytes, false) }
}

fn build_with(
    triangles: &Arc<Triangles>,
    ids: Range<TriangleId>,
    bytes: usize,
    puts_loose_above: bool,
) -> Clusters {
    let finite: Vec<TriangleId>;
    let dividing = Dividing { triangles, puts_loose_above, arithmetic: Available::newest() };
    let (sorted, tree) = if triangles.are_finite() {
        dividing.all(ids.len(), |number| ids.start + number as TriangleId)
    } else {
        finite = ids.filter(|&id| is_finite(&triangles.get(id))).collect();
        dividing.all(finite.len(), |number| finite[number])
    };
    let (mut treelets, mut clusters) = (Vec::new(), Vec::new());
    let Some(tree) = tree else {
        return Clusters::of(triangles.clone(), sorted, treelets, None, bytes);
    };
    let first = tree.treelets() << WITHIN_BITS;
    let nodes = collapse(&tree, first, |whole, items| match whole {
        Whole::Treelet => {
            treelets.push(Treelet { items: items.clone(), made: OnceLock::new() });
            Child::Node((treelets.len() as u32 - 1) << WITHIN_BITS)
        }
        Whole::Cluster => {
            clusters.push(items.clone());
            Child::Cluster(first + clusters.len() as u32 - 1)
        }
    });
    let cluster = |items: &Range<u32>| {
        let ids = &sorted[items.start as usize..items.end as usize];
        Cluster::new(ids.len(), |lane| ids[lane], triangles, dividing.arithmetic)
    };
    let mut nodes = nodes.chunks(1 << WITHIN_BITS);
    let mut clusters = clusters.chunks(1 << WITHIN_BITS);
    loop {
        let (nodes, clusters) = (nodes.next(), clusters.next());
        if nodes.is_none() && clusters.is_none() {
            break;
        }
        let clusters = clusters.unwrap_or_default().par_iter().map(cluster).collect::<Vec<_>>();
        let made = Made { nodes: nodes.unwrap_or_default().into(), clusters: clusters.into() };
        treelets.push(Treelet { items: 0..0, made: OnceLock::from(made) });
    }
    assert!(
        treelets.len() <= MOST_TREELETS,
        "a scene of less than {} triangles",
        LEAST * MOST_TREELETS
    );
    Clusters::of(triangles.clone(), sorted, treelets, Some(first), bytes)
}

/// Sorts triangles so that those of a treelet are in a row.
#[derive(Clone, Copy)]
struct Dividing<'a> {
    triangles: &'a Triangles,
    /// Whether clusters of what is loose are made at once.
    puts_loose_above: bool,
    arithmetic: Available,
}

impl Dividing<'_> {
    /// So many, each of which `id` gives by its number; no tree if there are none.
    fn all(
        self,
        count: usize,
        id: impl Fn(usize) -> TriangleId,
    ) -> (Vec<TriangleId>, Option<Half>) {
        let mut sorted = vec_with_room(count);
        if count < MANY {
            sorted.extend((0..count).map(id));
            let tree = (count > 0).then(|| self.few(&mut sorted, 0));
            return (sorted, tree);
        }
        sorted.resize(count, 0);
        let places = Around::places_within(self.triangles.bounds().unwrap_or_default());
        let part = cells::sort(&mut sorted, &places, |number| self.item(id(number)), &id);
        let tree = self.part(part, &mut sorted, 0);
        (sorted, Some(tree))
    }

    fn item(self, id: TriangleId) -> Item {
        Item::new(self.triangles.corners()[id as usize], id)
    }

    /// Triangles that are sorted in parts. `first` is the place of the first one among all.
    fn part(self, part: Part, ids: &mut [TriangleId], first: u32) -> Half {
        match part.inside {
            Inside::Parts(inside) => {
                let count = ids.len();
                let [left, right] = *inside;
                let at = left.items.len();
                let (left_ids, right_ids) = ids.split_at_mut(at);
                Half::of(both(
                    count,
                    || self.part(left, left_ids, first),
                    || self.part(right, right_ids, first + at as u32),
                ))
            }
            Inside::Nothing { around, is_loose }
                if ids.len() <= TREELET && !(is_loose && self.puts_loose_above) =>
            {
                Half::whole(Whole::Treelet, around.bounds(), first..first + ids.len() as u32)
            }
            Inside::Nothing { .. } => self.few(ids, first),
        }
    }

    /// Triangles that are not sorted.
    fn few(self, ids: &mut [TriangleId], first: u32) -> Half {
        let mut items: Vec<Item> = ids.iter().map(|&id| self.item(id)).collect();
        let places = places_of(&items);
        self.divide(&mut items, &places, ids, first)
    }

    /// The box is around their places, or somewhat larger.
    fn divide(
        self,
        items: &mut [Item],
        places: &Around,
        ids: &mut [TriangleId],
        first: u32,
    ) -> Half {
        let count = items.len();
        if count <= TREELET {
            let mut around = Around::NOTHING;
            for item in &*items {
                around.join(&item.0);
            }
            let is_loose = || around.is_loose(&places_of(items));
            let whole = if self.puts_loose_above && is_loose() {
                let arranging = Arranging { only_full: false, arithmetic: self.arithmetic };
                arranging.arrange(items, places, first)
            } else {
                Half::whole(Whole::Treelet, around.bounds(), first..first + count as u32)
            };
            for (item, id) in items.iter().zip(ids) {
                *id = item.id();
            }
            return whole;
        }
        if count >= MANY {
            let part =
                cells::sort(ids, places, |number| items[number], |number| items[number].id());
            if let Inside::Parts(_) = part.inside {
                return self.part(part, ids, first);
            }
        }
        let Divided { at, sides } = divide(items, places, LEAST);
        let (left, right) = items.split_at_mut(at);
        let (left_ids, right_ids) = ids.split_at_mut(at);
        Half::of(both(
            count,
            || self.divide(left, &sides[0], left_ids, first),
            || self.divide(right, &sides[1], right_ids, first + at as u32),
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
