//! Where to divide a range of triangles, and doing so: at the boundary of a bin, in one pass without branches.

use bytemuck::Zeroable;
use glam::{Vec3, Vec3A, Vec4, Vec4Swizzles};

use super::WIDTH;
use crate::geometry::lanes::{Available, Lanes, LanesJob};
use crate::geometry::{Bounds, TriangleId};

/// Bins in which a range of triangles is sorted to find where to cut it.
const BINS: usize = 16;

/// A number from 0 up to this, added to it, stands in the last bits, rounded.
pub(super) const INTEGERS: f32 = (1 << (f32::MANTISSA_DIGITS - 1)) as f32;

/// What is subtracted before that, so that it is rounded down: a little less than a half, lest whole numbers go both ways.
pub(super) const TO_FLOOR: f32 = 0.4999;

/// A box in two vectors of four; the fourth coordinates mean nothing.
#[derive(Clone, Copy, Zeroable)]
pub(super) struct Around {
    low: Vec4,
    high: Vec4,
}

impl Around {
    pub const NOTHING: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    /// Around the places of items within these bounds, but for those that are infinite.
    pub fn places_within(Bounds { min, max }: Bounds) -> Self {
        let twice = |corner: Vec3| {
            (2.0 * corner).clamp(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)).extend(0.0)
        };
        Self { low: twice(min), high: twice(max) }
    }

    /// Where it begins along an axis.
    #[inline(always)]
    pub fn low(&self, axis: usize) -> f32 {
        self.low[axis]
    }

    /// Along which axis it is longest, and how long.
    #[inline(always)]
    pub fn longest(&self) -> (usize, f32) {
        let extent = self.extent().xyz();
        let axis = extent.max_position();
        (axis, extent[axis])
    }

    #[inline(always)]
    pub fn join(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    #[inline(always)]
    pub fn join_place(&mut self, place: Vec4) {
        self.low = self.low.min(place);
        self.high = self.high.max(place);
    }

    /// How long it is along each axis.
    #[inline(always)]
    pub fn extent(&self) -> Vec4 {
        self.high - self.low
    }

    /// Half of its surface; 0 of nothing.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let extent = self.extent().max(Vec4::ZERO);
        let sides = extent * extent.yzxw();
        sides.x + sides.y + sides.z
    }

    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.low.xyz(), max: self.high.xyz() }
    }
}

/// A triangle while its cluster is sought: its box, and its number in bits of the fourth coordinate.
#[derive(Clone, Copy, Zeroable)]
pub(super) struct Item(pub Around);

impl Item {
    #[inline(always)]
    pub fn new([a, b, c]: [Vec3A; 3], id: TriangleId) -> Self {
        let low = a.min(b).min(c).extend(f32::from_bits(id));
        Self(Around { low, high: a.max(b).max(c).extend(0.0) })
    }

    pub fn id(&self) -> TriangleId {
        self.0.low.w.to_bits()
    }

    /// Twice the centre of the box.
    #[inline(always)]
    pub fn place(&self) -> Vec4 {
        self.0.low + self.0.high
    }

    /// Along an axis.
    #[inline(always)]
    pub fn place_along(&self, axis: usize) -> f32 {
        self.0.low.as_ref()[axis] + self.0.high.as_ref()[axis]
    }
}

/// The box around the places of items.
pub(super) fn places_of(items: &[Item]) -> Around {
    let mut places = Around::NOTHING;
    for item in items {
        places.join_place(item.place());
    }
    places
}

/// Items in two parts: how many the first has, and boxes around the places of each, or larger.
pub(super) struct Divided {
    pub at: usize,
    pub sides: [Around; 2],
}

/// Moves the left side's items to the front. There are two or more.
pub(super) fn divide(items: &mut [Item], places: &Around, arithmetic: Available) -> Divided {
    arithmetic.run(Divide { items, places })
}

struct Divide<'a> {
    items: &'a mut [Item],
    places: &'a Around,
}

impl LanesJob for Divide<'_> {
    type Answer = Divided;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Divided {
        let Self { items, places } = self;
        let (axis, extent) = places.longest();
        let slots = Slots { axis, low: places.low(axis), scale: BINS as f32 / extent };
        if slots.scale.is_finite()
            && let Some(cut) = Cut::best(items, slots)
        {
            return at_bin(items, slots, cut);
        }
        // All in one place, or so far apart that no box has a surface in f32.
        let at = items.len() / 2;
        items
            .select_nth_unstable_by(at, |a, b| a.place_along(axis).total_cmp(&b.place_along(axis)));
        let (left, right) = items.split_at(at);
        Divided { at, sides: [places_of(left), places_of(right)] }
    }
}

/// Divides at the boundary of a bin.
#[inline(always)]
fn at_bin(items: &mut [Item], slots: Slots, cut: Cut) -> Divided {
    let mut front = 0;
    for index in 0..items.len() {
        // Without a branch: which side comes next is anybody's guess.
        let is_left = slots.of(&items[index]) < cut.bin;
        items.swap(index, front);
        front += usize::from(is_left);
    }
    Divided { at: front, sides: cut.sides }
}

/// Bins along an axis.
#[derive(Clone, Copy)]
struct Slots {
    axis: usize,
    low: f32,
    scale: f32,
}

impl Slots {
    #[inline(always)]
    fn of(&self, item: &Item) -> usize {
        const LAST: f32 = (BINS - 1) as f32;
        let slot = (item.place_along(self.axis) - self.low) * self.scale - TO_FLOOR;
        let slot = if slot > 0.0 { slot } else { 0.0 };
        let slot = if slot < LAST { slot } else { LAST };
        (slot + INTEGERS).to_bits() as usize % BINS
    }
}

/// Some items: how many, and the box around them.
#[derive(Clone, Copy)]
pub(super) struct Heap {
    pub count: usize,
    pub around: Around,
}

impl Heap {
    pub const EMPTY: Self = Self { count: 0, around: Around::NOTHING };

    #[inline(always)]
    pub fn add(&mut self, item: &Item) {
        self.count += 1;
        self.around.join(&item.0);
    }

    #[inline(always)]
    pub fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.around.join(&other.around);
    }

    /// What it costs the rays that meet the box, by the clusters that it takes.
    #[inline(always)]
    pub fn cost(&self) -> f32 {
        self.count.div_ceil(WIDTH) as f32 * self.around.half_area()
    }
}

/// What is in a bin.
#[derive(Clone, Copy)]
struct Bin {
    items: Heap,
    places: Around,
}

impl Bin {
    const EMPTY: Self = Self { items: Heap::EMPTY, places: Around::NOTHING };

    #[inline(always)]
    fn join(&mut self, other: &Self) {
        self.items.join(&other.items);
        self.places.join(&other.places);
    }
}

/// Before which bin to cut, and boxes around the places on either side.
#[derive(Clone, Copy)]
struct Cut {
    bin: usize,
    sides: [Around; 2],
}

impl Cut {
    /// The cheapest.
    #[inline(always)]
    fn best(items: &[Item], slots: Slots) -> Option<Self> {
        // Neighbours are often in one bin, and wait for each other there; so every other one goes to bins of its own.
        let mut bins = [[Bin::EMPTY; BINS]; 2];
        for (number, item) in items.iter().enumerate() {
            let bin = &mut bins[number % 2][slots.of(item)];
            bin.items.add(item);
            bin.places.join_place(item.place());
        }
        let [mut bins, others] = bins;
        for (bin, other) in bins.iter_mut().zip(&others) {
            bin.join(other);
        }
        let mut right = [Bin::EMPTY; BINS + 1];
        for bin in (1..BINS).rev() {
            right[bin] = right[bin + 1];
            right[bin].join(&bins[bin]);
        }
        let mut left = Bin::EMPTY;
        let mut least = f32::INFINITY;
        let mut best = None;
        for bin in 1..BINS {
            left.join(&bins[bin - 1]);
            let right = &right[bin];
            let cost = left.items.cost() + right.items.cost();
            if left.items.count > 0 && right.items.count > 0 && cost < least {
                least = cost;
                best = Some(Self { bin, sides: [left.places, right.places] });
            }
        }
        best
    }
}

/// Cubes at these places, of which many may share one.
#[cfg(test)]
pub(super) fn items_at(places: &[(u8, u8, u8)]) -> Vec<Item> {
    let item = |(id, &(x, y, z)): (usize, &(u8, u8, u8))| {
        let low = Vec3A::new(f32::from(x), f32::from(y), f32::from(z));
        Item::new([low, low, low + 0.5], id as TriangleId)
    };
    places.iter().enumerate().map(item).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn holds(around: &Around, place: Vec4) -> bool {
        around.low.xyz().cmple(place.xyz()).all() && place.xyz().cmple(around.high.xyz()).all()
    }

    proptest! {
        #[test]
        fn nothing_is_lost_both_sides_have_some_and_every_arithmetic_does_the_same(
            places in prop::collection::vec((0u8..200, 0u8..20, 0u8..3), WIDTH + 1..1500),
        ) {
            let mut before = None;
            for arithmetic in Available::all() {
                let mut items = items_at(&places);
                let around = places_of(&items);
                let Divided { at, sides } = divide(&mut items, &around, arithmetic);
                prop_assert!(at > 0 && at < items.len());
                for (index, item) in items.iter().enumerate() {
                    prop_assert!(holds(&sides[usize::from(index >= at)], item.place()));
                }
                let mut ids: Vec<TriangleId> = items.iter().map(Item::id).collect();
                let same = (at, ids.clone());
                prop_assert_eq!(before.get_or_insert(same.clone()), &same);
                ids.sort_unstable();
                prop_assert_eq!(ids, (0..places.len() as TriangleId).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn two_heaps_are_taken_apart() {
        let places: Vec<(u8, u8, u8)> =
            (0..603).map(|number| (if number % 3 == 0 { 200 } else { 0 }, 0, 0)).collect();
        for arithmetic in Available::all() {
            let mut items = items_at(&places);
            let around = places_of(&items);
            assert_eq!(divide(&mut items, &around, arithmetic).at, 402);
            assert!(items[..402].iter().all(|item| item.0.low.x == 0.0));
        }
    }

    #[test]
    fn what_is_at_the_boundary_of_a_bin_comes_after_it() {
        // As many places as there are boundaries, and the last one.
        let places: Vec<(u8, u8, u8)> = (0..=BINS as u8).map(|x| (2 * x, 0, 0)).collect();
        let items = items_at(&places);
        let around = places_of(&items);
        let (axis, extent) = around.longest();
        let slots = Slots { axis, low: around.low(axis), scale: BINS as f32 / extent };
        let found = items.iter().map(|item| slots.of(item));
        assert!(found.eq((0..BINS).chain([BINS - 1])));
    }

    #[test]
    fn items_in_one_place_are_halved() {
        for arithmetic in Available::all() {
            let mut items = items_at(&[(7, 7, 7); 320]);
            let around = places_of(&items);
            assert_eq!(divide(&mut items, &around, arithmetic).at, 160);
        }
    }
}
