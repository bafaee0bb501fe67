//! Polygons become triangles.

mod tree;

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use tree::Corners;

/// Cuts a polygon into triangles: a fan from its first corner where that covers the polygon and
/// nothing else, as for every convex one; else by cutting off ears. The outline may touch itself, or run back along
/// itself to a hole.
pub(super) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let fan = (2..corners.len()).map(|last| [0, last - 1, last]);
    if corners.len() < 4 {
        return fan.collect();
    }
    let flat = flatten(corners);
    if fan.clone().all(|triangle| turn(triangle.map(|i| flat[i])) >= 0.0) {
        return fan.collect();
    }
    let triangles = Outline::of(&flat).cut();
    // What has no area is for others to count.
    if triangles.is_empty() { fan.collect() } else { triangles }
}

/// The polygon seen along the axis nearest to its normal, counter-clockwise.
fn flatten(corners: &[DVec3]) -> Vec<DVec2> {
    let origin = corners[0];
    let normal: DVec3 =
        (2..corners.len()).map(|i| (corners[i - 1] - origin).cross(corners[i] - origin)).sum();
    let size = normal.abs();
    let project = |p: DVec3| {
        if size.x >= size.y && size.x >= size.z {
            DVec2::new(p.y, p.z * normal.x.signum())
        } else if size.y >= size.z {
            DVec2::new(p.z, p.x * normal.y.signum())
        } else {
            DVec2::new(p.x, p.y * normal.z.signum())
        }
    };
    corners.iter().map(|&corner| project(corner)).collect()
}

/// Positive where the way from `a` over `b` to `c` turns left, negative where it turns right; the sign is exact.
fn turn(triangle: [DVec2; 3]) -> f64 {
    let [a, b, c] = triangle.map(|corner| robust::Coord { x: corner.x, y: corner.y });
    robust::orient2d(a, b, c)
}

/// The edges of a triangle.
fn edges([a, b, c]: [DVec2; 3]) -> [[DVec2; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// How often one may be at a loss for an ear before the rest is cut at random: an outline that crosses itself may
/// have none.
const MOST_LOSSES: usize = 16;

/// What is left of a polygon while it is cut.
///
/// The signed areas of all that is cut off add up to the winding of the outline. So where no triangle turns right,
/// an outline that does not cross itself is covered once, and nothing else is.
struct Outline<'a> {
    flat: &'a [DVec2],
    before: Vec<usize>,
    after: Vec<usize>,
    is_left: Vec<bool>,
    count: usize,
    /// The corners at which the outline does not turn left: where anything is in an ear, one of these is.
    reflex: Corners<'a>,
    /// The corners that can be cut off.
    ears: BTreeSet<usize>,
}

impl<'a> Outline<'a> {
    fn of(flat: &'a [DVec2]) -> Self {
        let count = flat.len();
        let mut outline = Self {
            flat,
            before: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            after: (0..count).map(|corner| (corner + 1) % count).collect(),
            is_left: vec![true; count],
            count,
            reflex: Corners::of(flat),
            ears: BTreeSet::new(),
        };
        outline.settle((0..count).collect());
        outline
    }

    fn cut(mut self) -> Vec<[usize; 3]> {
        let mut triangles = Vec::with_capacity(self.count);
        let mut losses = 0;
        while self.count > 2 {
            let ear = self.ears.first().copied().or_else(|| {
                let is_lost = losses == MOST_LOSSES;
                let found = if is_lost { None } else { self.look_again() };
                losses += usize::from(found.is_none() && !is_lost);
                found
            });
            let ear = ear.unwrap_or_else(|| self.corners().next().expect("there are some"));
            if self.turn_at(ear) != 0.0 {
                triangles.push(self.around(ear));
            }
            let touched = self.take_out(ear);
            self.settle(touched.into());
        }
        triangles
    }

    /// A corner that can be cut off where no ear is known: one that was not, one that others touch from outside, or one
    /// at which the outline goes straight on.
    fn look_again(&self) -> Option<usize> {
        let find =
            |can_be_cut: &dyn Fn(usize) -> bool| self.corners().find(|&corner| can_be_cut(corner));
        find(&|corner| self.is_ear(corner, false))
            .or_else(|| find(&|corner| self.is_ear(corner, true)))
            .or_else(|| find(&|corner| self.turn_at(corner) == 0.0))
    }

    fn corners(&self) -> impl Iterator<Item = usize> {
        (0..self.flat.len()).filter(|&corner| self.is_left[corner])
    }

    fn around(&self, corner: usize) -> [usize; 3] {
        [self.before[corner], corner, self.after[corner]]
    }

    fn turn_at(&self, corner: usize) -> f64 {
        turn(self.around(corner).map(|i| self.flat[i]))
    }

    /// Whether the outline turns back at this corner, or stands still.
    fn is_spike(&self, corner: usize) -> bool {
        let [a, b, c] = self.around(corner).map(|i| self.flat[i]);
        (b - a).dot(c - b) <= 0.0 && self.turn_at(corner) == 0.0
    }

    /// Joins the neighbours of a corner; they are returned.
    fn take_out(&mut self, corner: usize) -> [usize; 2] {
        let [before, _, after] = self.around(corner);
        (self.after[before], self.before[after]) = (after, before);
        self.is_left[corner] = false;
        self.count -= 1;
        self.ears.remove(&corner);
        self.reflex.remove(corner);
        [before, after]
    }

    /// Learns what has become of corners with new neighbours. Those that enclose nothing any more go, for no ear
    /// could be told beside them.
    fn settle(&mut self, mut touched: Vec<usize>) {
        let mut next = 0;
        while next < touched.len() {
            let corner = touched[next];
            if self.is_left[corner] && self.count > 2 && self.is_spike(corner) {
                touched.extend(self.take_out(corner));
            }
            next += 1;
        }
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&corner| self.is_left[corner]);
        for &corner in &touched {
            if self.turn_at(corner) <= 0.0 {
                self.reflex.insert(corner);
            } else {
                self.reflex.remove(corner);
            }
        }
        for corner in touched {
            if self.is_ear(corner, false) {
                self.ears.insert(corner);
            } else {
                self.ears.remove(&corner);
            }
        }
    }

    /// Whether the triangle at the corner is within the polygon. Others may touch its corners from outside and,
    /// if `touched`, its edges.
    fn is_ear(&self, corner: usize, touched: bool) -> bool {
        let around = self.around(corner);
        let triangle = around.map(|i| self.flat[i]);
        turn(triangle) > 0.0
            && !self.reflex.any_near(triangle, &|other| {
                !around.contains(&other) && self.is_in_the_way(other, triangle, touched)
            })
    }

    fn is_in_the_way(&self, corner: usize, triangle: [DVec2; 3], touched: bool) -> bool {
        let place = self.flat[corner];
        let [a, b, c] = triangle;
        if place.cmplt(a.min(b).min(c)).any() || place.cmpgt(a.max(b).max(c)).any() {
            return false;
        }
        let sides = edges(triangle).map(|[from, to]| turn([from, to, place]));
        if sides.iter().any(|&side| side < 0.0) {
            return false;
        }
        // From an edge or a corner of the triangle the outline may go on outside.
        let enters = |other: usize| {
            let edges = edges(triangle).into_iter().zip(sides);
            edges
                .into_iter()
                .all(|([from, to], side)| side > 0.0 || turn([from, to, self.flat[other]]) > 0.0)
        };
        let must_enter = touched || triangle.contains(&place);
        !must_enter || enters(self.before[corner]) || enters(self.after[corner])
    }
}

#[cfg(test)]
mod tests;
