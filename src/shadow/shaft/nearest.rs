//! Which nodes to visit first: the nearest to the light, that is, the farthest along the way to it.
//!
//! Once all rays of a part are blocked, what it has still to visit is skipped. So where much is blocked, what blocks
//! should come early; and a box near the light is in the way of more rays than one of the same size among the origins,
//! where the shaft is wide. The order of the tree is the best or the worst by chance: in jittered-dense, lit from all
//! sides, 22 % fewer visits, 24 % fewer tests and 15 % less time than by it; in the tower bridge as many, but a third
//! fewer than by its reverse.
//!
//! Where little is blocked, nothing is skipped, and sorting is for nothing; so is sorting clusters, or what rays alone
//! visit. Orders that need no sorting, children in octants as the light sees them among them, or the largest box first
//! (Ize & Hansen weigh surfaces, and costs) had 3 to 20 % more visits in the tower bridge than the tree's.
//!
//! Ize, Hansen: RTSAH Traversal Order for Occlusion Rays. Computer Graphics Forum 30(2), 2011.

use glam::Vec3;

use super::source::Source;
use crate::occlusion::{Node, WIDTH};

/// The way to the light, if nodes are worth ordering by it.
#[derive(Clone, Copy)]
pub(super) struct Toward(Option<Vec3>);

impl Toward {
    /// No order.
    pub const NOWHERE: Self = Self(None);

    /// The order for queries from around a place.
    pub fn light(source: &Source, place: Vec3) -> Self {
        Self(Some(match *source {
            Source::Point(light) => light - place,
            Source::Direction(direction) => direction,
        }))
    }

    /// Calls `put` for some slots of a node, the nearest to the light last, as what is put on a stack last is visited first.
    #[inline(always)]
    pub fn nearest_last(self, node: &Node, mut slots: u32, mut put: impl FnMut(usize)) {
        match self.0 {
            Some(toward) if slots.count_ones() > 1 => {
                let (sorted, count) = sorted(node, toward, slots);
                for &(_, slot) in &sorted[..count] {
                    // A slot is less anyway; so the compiler knows, and checks no bounds.
                    put(slot as usize % WIDTH);
                }
            }
            _ => {
                while slots != 0 {
                    put(slots.trailing_zeros() as usize);
                    slots &= slots - 1;
                }
            }
        }
    }
}

/// How near to the light the middles of these boxes are, and their slots, the nearest last; and how many.
// Not inline: the walk is mostly without, and needs its registers.
#[inline(never)]
fn sorted(node: &Node, toward: Vec3, mut slots: u32) -> ([(f32, u32); WIDTH], usize) {
    let (mut sorted, mut count) = ([(0.0, 0); WIDTH], 0);
    while slots != 0 {
        let slot = slots.trailing_zeros();
        slots &= slots - 1;
        let twice = |axis: usize| node.low[axis][slot as usize] + node.high[axis][slot as usize];
        let near = toward.dot(Vec3::new(twice(0), twice(1), twice(2)));
        let mut place = count;
        while place > 0 && sorted[place - 1].0 > near {
            sorted[place] = sorted[place - 1];
            place -= 1;
        }
        sorted[place] = (near, slot);
        count += 1;
    }
    (sorted, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Bounds;
    use crate::occlusion::Child;

    /// Boxes along a diagonal, by their places on it.
    fn node(places: &[f32]) -> Node {
        let mut node = Node::EMPTY;
        for (slot, &place) in places.iter().enumerate() {
            let min = Vec3::splat(place);
            node.set(slot, &Bounds { min, max: min + 0.5 }, Child::Node(slot as u32));
        }
        node
    }

    fn put(toward: Toward, node: &Node, slots: u32) -> Vec<usize> {
        let mut all = Vec::new();
        toward.nearest_last(node, slots, |slot| all.push(slot));
        all
    }

    const PLACES: [f32; WIDTH] = [3.0, -1.0, 7.0, 7.0, 0.0, 5.0, -8.0, 2.0];

    #[test]
    fn the_nearest_to_the_light_comes_last_whichever_kind_of_light_it_is() {
        let node = node(&PLACES);
        for (source, all) in [
            (Source::Point(Vec3::splat(9.0)), [6, 1, 4, 7, 0, 5, 2, 3]),
            (Source::Point(Vec3::new(-50.0, 10.0, 10.0)), [2, 3, 5, 0, 7, 4, 1, 6]),
            (Source::Direction(Vec3::new(0.0, 0.6, 0.8)), [6, 1, 4, 7, 0, 5, 2, 3]),
        ] {
            assert_eq!(put(Toward::light(&source, Vec3::ONE), &node, 0xff), all, "{source:?}");
        }
    }

    #[test]
    fn only_what_is_asked_for_comes_and_by_the_slots_if_there_is_no_order() {
        let node = node(&PLACES);
        let up = Toward::light(&Source::Direction(Vec3::Z), Vec3::ZERO);
        assert_eq!(put(up, &node, 0b1010_0001), [7, 0, 5]);
        assert_eq!(put(up, &node, 0b100), [2]);
        assert_eq!(put(up, &node, 0), [0; 0]);
        assert_eq!(put(Toward::NOWHERE, &node, 0b1010_0001), [0, 5, 7]);
    }
}
