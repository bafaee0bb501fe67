//! What a query leaves out, because it is known not to block: the mailbox of §9 of the paper.
//!
//! The paper stores the number of the last ray in each object. Two threads would then write one
//! field, and a number that wraps around would name an old ray. Here every worker has a table of its
//! own, small enough for the nearest cache: the slot of a triangle holds the triangle and the number
//! of the ray that was tested against it, and the table is emptied when the numbers wrap. Two
//! triangles of one slot displace each other, which costs a second test and no answer.
//!
//! Only opaque triangles that were tested and missed are noted: Figure 1 would lose the attenuation
//! of a transparent one that a search for opaque ones had marked in passing.
//!
//! The spawning triangle is not kept in a slot, as the paper has it, since it must not be displaced:
//! it is left out for exactness, the others only to save work.
//!
//! Arnaldi, Priol, Bouatouch: A New Space Subdivision Method for Ray Tracing CSG Modelled Scenes. The
//! Visual Computer 3(2), 1987. The hashed table is that of Wald's dissertation (Saarbrücken 2004).

use super::Cell;
use crate::geometry::{NOBODY, TriangleId};

/// Slots of the table: 2 KiB.
const SLOTS: usize = 256;

#[derive(Clone, Copy, Default)]
struct Slot {
    triangle: TriangleId,
    ray: u32,
}

/// Triangles that one worker's present query need not test.
#[derive(Clone)]
pub struct LeftOut {
    opaque: u32,
    spawner: TriangleId,
    cell: Cell,
    ray: u32,
    slots: Option<Box<[Slot; SLOTS]>>,
}

impl LeftOut {
    /// Leaves out nothing so far; `opaque` triangles come first. With a `mailbox`, single triangles
    /// can be noted.
    #[must_use]
    pub fn new(opaque: u32, mailbox: bool) -> Self {
        let slots = mailbox.then(|| Box::new([Slot::default(); SLOTS]));
        // Slots are empty, which is triangle 0 by ray 0.
        Self { opaque, spawner: NOBODY, cell: Cell::default(), ray: 1, slots }
    }

    /// Begins a query: all triangles count again, but `spawner`, if one is named.
    #[inline]
    pub fn begin(&mut self, spawner: Option<TriangleId>) {
        self.spawner = spawner.unwrap_or(NOBODY);
        self.cell = Cell::default();
        self.ray = self.ray.wrapping_add(1);
        if self.ray == 0 {
            // What was noted for ray n, 2³² queries ago, must not be taken for this one's.
            self.ray = 1;
            if let Some(slots) = &mut self.slots {
                **slots = [Slot::default(); SLOTS];
            }
        }
    }

    /// Number of opaque triangles.
    #[must_use]
    pub fn opaque(&self) -> u32 {
        self.opaque
    }

    /// Whether the query's own triangle is this one.
    #[must_use]
    #[inline]
    pub fn is_spawner(&self, triangle: TriangleId) -> bool {
        triangle == self.spawner
    }

    /// Whether the triangle need not be tested.
    #[must_use]
    #[inline]
    pub fn holds(&self, triangle: TriangleId) -> bool {
        self.is_spawner(triangle)
            || self.slots.as_ref().is_some_and(|slots| {
                let slot = slots[triangle as usize % SLOTS];
                slot.triangle == triangle && slot.ray == self.ray
            })
    }

    /// Whether all triangles of the cell were tested.
    #[must_use]
    #[inline]
    pub fn holds_cell(&self, cell: Cell) -> bool {
        self.cell.start <= cell.start && cell.end <= self.cell.end
    }

    /// Notes a triangle that this query tested and that does not block it.
    #[inline]
    pub fn note(&mut self, triangle: TriangleId) {
        if let Some(slots) = &mut self.slots
            && triangle < self.opaque
        {
            slots[triangle as usize % SLOTS] = Slot { triangle, ray: self.ray };
        }
    }

    /// Notes a cell of which no triangle blocks this query.
    #[inline]
    pub fn note_cell(&mut self, cell: Cell) {
        self.cell = cell;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_lasts_for_one_query() {
        let mut left_out = LeftOut::new(1000, true);
        left_out.begin(None);
        left_out.note(7);
        left_out.note_cell(Cell { start: 3, end: 9 });
        assert!(left_out.holds(7) && !left_out.holds(8));
        assert!(left_out.holds_cell(Cell { start: 4, end: 9 }));
        left_out.begin(None);
        assert!(!left_out.holds(7) && !left_out.holds_cell(Cell { start: 4, end: 9 }));
    }

    #[test]
    fn nothing_is_left_out_before_the_first_query() {
        let left_out = LeftOut::new(1000, true);
        assert!((0..1000).all(|id| !left_out.holds(id)));
    }

    #[test]
    fn numbers_that_wrap_around_do_not_name_old_rays() {
        let mut left_out = LeftOut::new(1000, true);
        left_out.note(7);
        left_out.ray = u32::MAX;
        left_out.note(8);
        left_out.begin(None);
        assert_eq!(left_out.ray, 1, "the number that 7 was noted under");
        assert!(!left_out.holds(7) && !left_out.holds(8));
        // Slot 0 is empty, not the note of triangle 0 by ray 0.
        assert!(!left_out.holds(0));
    }

    #[test]
    fn transparent_triangles_are_never_noted() {
        let mut left_out = LeftOut::new(5, true);
        left_out.begin(None);
        (0..10).for_each(|id| left_out.note(id));
        assert!((0..10).all(|id| left_out.holds(id) == (id < 5)));
    }

    #[test]
    fn a_displaced_note_is_tested_again_and_the_spawner_is_not_displaced() {
        let mut left_out = LeftOut::new(10_000, true);
        left_out.begin(Some(3));
        left_out.note(5);
        left_out.note(5 + SLOTS as u32);
        left_out.note(3 + SLOTS as u32);
        assert!(!left_out.holds(5) && left_out.holds(5 + SLOTS as u32) && left_out.holds(3));
    }
}
