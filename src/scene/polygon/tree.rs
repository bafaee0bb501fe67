//! Which of a polygon's corners are in a triangle: a tree of boxes.

use glam::DVec2;

use super::{edges, turn};

/// The smallest box around some places; around none it is turned inside out.
type Box2 = [DVec2; 2];

const EMPTY: Box2 = [DVec2::INFINITY, DVec2::NEG_INFINITY];

/// Some of the corners of a polygon, in a balanced tree by their order along its longer side.
pub(super) struct Corners<'a> {
    flat: &'a [DVec2],
    /// The corners in that order.
    order: Vec<usize>,
    /// Where each is in it.
    places: Vec<usize>,
    /// The root is at 1, and below each node are those at twice its index and beside it; as many leaves as corners, or more.
    boxes: Vec<Box2>,
}

impl<'a> Corners<'a> {
    /// None of them as yet.
    pub fn of(flat: &'a [DVec2]) -> Self {
        let around = |[min, max]: Box2, corner: &DVec2| [min.min(*corner), max.max(*corner)];
        let [min, max] = flat.iter().fold(EMPTY, around);
        let is_wide = max.x - min.x >= max.y - min.y;
        let along = |corner: usize| if is_wide { flat[corner].x } else { flat[corner].y };
        let mut order: Vec<usize> = (0..flat.len()).collect();
        order.sort_unstable_by(|&a, &b| along(a).total_cmp(&along(b)));
        let mut places = vec![0; flat.len()];
        for (place, &corner) in order.iter().enumerate() {
            places[corner] = place;
        }
        let boxes = vec![EMPTY; 2 * flat.len().next_power_of_two()];
        Self { flat, order, places, boxes }
    }

    fn leaves(&self) -> usize {
        self.boxes.len() / 2
    }

    pub fn insert(&mut self, corner: usize) {
        self.set(corner, [self.flat[corner]; 2]);
    }

    pub fn remove(&mut self, corner: usize) {
        self.set(corner, EMPTY);
    }

    fn set(&mut self, corner: usize, leaf: Box2) {
        let mut node = self.leaves() + self.places[corner];
        self.boxes[node] = leaf;
        while node > 1 {
            node /= 2;
            let [[min, max], [other_min, other_max]] =
                [0, 1].map(|side| self.boxes[2 * node + side]);
            self.boxes[node] = [min.min(other_min), max.max(other_max)];
        }
    }

    /// Whether any of them that may be in or on the triangle is wanted.
    pub fn any_near(&self, triangle: [DVec2; 3], is_wanted: &dyn Fn(usize) -> bool) -> bool {
        self.any_below(1, triangle, is_wanted)
    }

    fn any_below(
        &self,
        node: usize,
        triangle: [DVec2; 3],
        is_wanted: &dyn Fn(usize) -> bool,
    ) -> bool {
        #[cfg(test)]
        LOOKS.set(LOOKS.get() + 1);
        if is_beside(self.boxes[node], triangle) {
            return false;
        }
        match node.checked_sub(self.leaves()) {
            Some(place) => is_wanted(self.order[place]),
            None => [0, 1].iter().any(|side| self.any_below(2 * node + side, triangle, is_wanted)),
        }
    }
}

#[cfg(test)]
thread_local! {
    /// How many boxes this thread has looked at.
    pub(super) static LOOKS: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Whether nothing in the box is in or on the triangle, which turns left: it ends before, or all of it is on the right
/// of an edge, as that corner says which is farthest on the left. The sign of a turn is exact.
fn is_beside([min, max]: Box2, triangle: [DVec2; 3]) -> bool {
    let [a, b, c] = triangle;
    if max.cmplt(a.min(b).min(c)).any() || min.cmpgt(a.max(b).max(c)).any() {
        return true;
    }
    edges(triangle).iter().any(|&[from, to]| {
        let left = (to - from).perp();
        turn([from, to, DVec2::select(left.cmpgt(DVec2::ZERO), max, min)]) < 0.0
    })
}
