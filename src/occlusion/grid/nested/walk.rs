//! The walk: what in a grid does the ray meet, all at once; then, one after another, what is inside.
//!
//! Rays that start near the scene's cube go as they are. Others, and those so long or short that
//! f32 might over- or underflow, are first clipped and mapped to it in f64.
//!
//! **Many rays** pass the outermost grid in turn before any goes on. A ray by itself is a chain, in which the processor waits for
//! each link or guesses, and begins again if wrong; the first links of many do not depend on each other. Half of the
//! queries of an open scene end there.
//!
//! **The nearest hit** is looked for in the order in which the line enters the boxes, and what it enters behind a hit is left out.
//! Any hit is taken as things are stored (`build`).

use std::ops::Range;

use glam::{DVec3, Vec3A};

use super::group::GROUP;
use super::{NestedGrid, SLOTS};
use crate::geometry::Ray;
use crate::geometry::lanes::{Lanes, Sixteen};
use crate::occlusion::brute::visit_all;
use crate::occlusion::clip::Clip;
use crate::occlusion::{Visit, VisitMany};

/// Grids within grids at most: building ends before (`build`).
pub(super) const MOST_DEPTH: usize = 24;

/// Components of a direction smaller than this part of the largest are replaced by it: over the
/// length of the cube that displaces the ray by nothing, and no inverse overflows.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u64 << 40) as f32;

/// Largest components of directions, in sides of the cube, with which nothing below over- or underflows.
const LENGTHS: std::ops::Range<f32> = 1e-18..1e18;

/// A ray in the cube.
#[derive(Clone, Copy, Default)]
struct Line {
    inverse: Vec3A,
    /// A plane at p is passed at p·inverse + shift.
    shift: Vec3A,
    /// Along which axes the ray runs down: 1, else 0.
    down: [usize; 3],
    /// Where along the ray the line starts, and how fast it goes: `t` of the line is (t − start)·rate.
    start: f64,
    rate: f64,
}

impl Line {
    #[inline(always)]
    fn new(origin: Vec3A, direction: Vec3A, start: f64, rate: f64) -> Self {
        let magnitudes = direction.abs();
        let smallest = Vec3A::splat(SMALLEST_COMPONENT * magnitudes.max_element());
        let direction = Vec3A::select(magnitudes.cmplt(smallest), smallest, direction);
        let inverse = direction.recip();
        let signs = inverse.cmplt(Vec3A::ZERO).bitmask() as usize;
        Self {
            inverse,
            shift: -origin * inverse,
            down: [signs & 1, signs >> 1 & 1, signs >> 2],
            start,
            rate,
        }
    }

    /// Where the line ends if nothing beyond `end` of the ray is of interest.
    #[inline(always)]
    fn end(&self, end: f32) -> f32 {
        /// Room for rounding; it is no more than a place is misplaced by.
        const ROOM: f64 = 1e-7;
        if self.rate == 1.0 && self.start == 0.0 {
            end
        } else {
            (((f64::from(end) - self.start) * self.rate).min(1.0) + ROOM) as f32
        }
    }
}

/// A line, spread over lanes.
pub(super) struct LineLanes<S> {
    inverse: [S; 3],
    shift: [S; 3],
    /// Where it starts.
    pub start: S,
    /// Along which axes it runs down: 1, else 0.
    pub down: [usize; 3],
}

impl<S: Sixteen> LineLanes<S> {
    #[inline(always)]
    fn new(line: &Line) -> Self {
        let Line { inverse, shift, down, .. } = *line;
        Self {
            inverse: [S::splat(inverse.x), S::splat(inverse.y), S::splat(inverse.z)],
            shift: [S::splat(shift.x), S::splat(shift.y), S::splat(shift.z)],
            start: S::splat(0.0),
            down,
        }
    }

    /// Where it passes planes across an axis.
    #[inline(always)]
    pub fn at(&self, axis: usize, planes: &[f32; GROUP]) -> S {
        S::load(planes).mul_add(self.inverse[axis], self.shift[axis])
    }
}

/// Where a line enters the boxes of what a grid holds: of those that it meets.
struct Entries([[f32; GROUP]; SLOTS / GROUP]);

impl Entries {
    const NONE: Self = Self([[0.0; GROUP]; SLOTS / GROUP]);

    /// Of what the line meets, that which it enters first. Without a branch, as nobody can foresee which that is: bits of floats
    /// from zero up are in their order.
    #[inline(always)]
    fn first(&self, mut met: u64) -> usize {
        let mut least = u64::MAX;
        while met != 0 {
            let slot = met.trailing_zeros() as usize;
            met &= met - 1;
            let enter = self.0[slot / GROUP][slot % GROUP].to_bits();
            least = least.min(u64::from(enter) << 32 | slot as u64);
        }
        least as usize % SLOTS
    }

    /// Of what the line meets, that which it enters before `end`.
    #[inline(always)]
    fn until(&self, met: u64, end: f32) -> u64 {
        let (mut left, mut kept) = (met, 0);
        while left != 0 {
            let slot = left.trailing_zeros() as usize;
            left &= left - 1;
            kept |= u64::from(self.0[slot / GROUP][slot % GROUP] <= end) << slot;
        }
        kept
    }
}

impl NestedGrid {
    /// Bits of what a grid holds: of that whose boxes the line meets before `end`; and where, if somebody asks.
    #[inline(always)]
    fn met<S: Sixteen>(
        &self,
        groups: Range<usize>,
        line: &LineLanes<S>,
        end: f32,
        mut entries: Option<&mut Entries>,
    ) -> u64 {
        let end = S::splat(end);
        let mut all = 0;
        for (number, group) in self.groups[groups].iter().enumerate() {
            let (met, enter) = group.met(line, end);
            all |= u64::from(met) << (GROUP * number);
            if let Some(Entries(entries)) = &mut entries {
                enter.store(&mut entries[number % (SLOTS / GROUP)]);
            }
        }
        all
    }
}

/// A ray that has come to the outermost grid.
#[derive(Clone, Copy, Default)]
struct Start {
    line: Line,
    /// No farther than this `t` of the line.
    end: f32,
    /// Whether it comes from so far away that f64 cannot say where it goes.
    anyhow: bool,
    /// What it meets there.
    met: u64,
}

impl Start {
    /// Written in place: a copy would wait for what was just written piece by piece.
    #[inline(always)]
    fn set<L: Lanes>(&mut self, grid: &NestedGrid, ray: &Ray, entries: Option<&mut Entries>) {
        /// Farthest from the middle of the cube, in its sides.
        const NEAR: f32 = 1.0;
        let cube = &grid.cube;
        let origin = (Vec3A::from(ray.origin) - cube.corner) * cube.factor;
        let direction = Vec3A::from(ray.direction) * cube.factor;
        let near = (origin - 0.5).abs().cmple(Vec3A::splat(NEAR)).all();
        // Not where something is NaN.
        let (line, end) = if near && LENGTHS.contains(&direction.abs().max_element()) {
            self.anyhow = false;
            (Line::new(origin, direction, 0.0, 1.0), ray.end)
        } else {
            match self.come_from_afar(grid, ray) {
                Some(line) => line,
                None => return,
            }
        };
        (self.line, self.end) = (line, end);
        let lanes = LineLanes::new(&line);
        self.met = grid.met::<L::Sixteen>(0..grid.outermost, &lanes, end, entries);
    }

    #[cold]
    fn come_from_afar(&mut self, grid: &NestedGrid, ray: &Ray) -> Option<(Line, f32)> {
        (self.met, self.anyhow) = (0, false);
        let (enter, leave) = match grid.clip(ray) {
            Clip::Outside => return None,
            Clip::Everything => {
                self.anyhow = true;
                return None;
            }
            Clip::Inside(enter, leave) => (enter, leave),
        };
        let length = leave - enter;
        let direction = ray.direction.as_dvec3() * (grid.cube.scale * length);
        // A ray that only touches the cube has no length in it; nor has one that f64 cannot measure.
        let direction = if direction.abs().max_element() >= f64::from(LENGTHS.start) {
            direction
        } else {
            DVec3::splat(f64::from(LENGTHS.start))
        };
        let origin = grid.cube.place(ray.at(enter)).as_vec3a();
        let rate = length.recip();
        Some((Line::new(origin, direction.as_vec3a(), enter, rate), 1.0))
    }

    /// Whether the ray comes to anything.
    #[inline(always)]
    fn is_of_interest(&self) -> bool {
        (self.met != 0) | self.anyhow
    }
}

#[inline(always)]
pub(super) fn walk<L: Lanes, V: Visit + ?Sized>(grid: &NestedGrid, ray: &Ray, visitor: &mut V) {
    let mut start = Start::default();
    let mut entries = Entries::NONE;
    start.set::<L>(grid, ray, visitor.is_ordered().then_some(&mut entries));
    if start.is_of_interest() {
        go_on::<L, V>(grid, &start, &mut entries, visitor);
    }
}

#[inline(always)]
pub(super) fn walk_many<L: Lanes, V: VisitMany>(grid: &NestedGrid, rays: &[Ray], visitors: &mut V) {
    /// Rays at once: what is known of them stays in the nearest cache.
    const AT_ONCE: usize = 32;
    let mut starts = [Start::default(); AT_ONCE];
    // For rays that want what is nearest; none of these does.
    let mut entries = Entries::NONE;
    let mut first = 0;
    for rays in rays.chunks(AT_ONCE) {
        // Those that go on, by their number: without a branch, as nobody can foresee which do.
        let mut going = [0u8; AT_ONCE];
        let mut count = 0;
        for (number, ray) in rays.iter().enumerate() {
            if visitors.admits(first + number) {
                let start = &mut starts[number];
                start.set::<L>(grid, ray, None);
                going[count] = number as u8;
                count += usize::from(start.is_of_interest());
            }
        }
        for &number in &going[..count] {
            let number = usize::from(number);
            let visitor = &mut visitors.one(first + number);
            debug_assert!(!visitor.is_ordered(), "many rays ask for anything");
            go_on::<L, _>(grid, &starts[number], &mut entries, visitor);
        }
        first += AT_ONCE;
    }
}

/// From the outermost grid on.
#[inline(always)]
fn go_on<L: Lanes, V: Visit + ?Sized>(
    grid: &NestedGrid,
    start: &Start,
    entries: &mut Entries,
    visitor: &mut V,
) {
    if start.anyhow {
        return visit_all(&grid.order, 8, visitor);
    }
    let (line, mut end, mut met) = (&start.line, start.end, start.met);
    let lanes = LineLanes::<L::Sixteen>::new(line);
    // Grids around the present one of which something is left: their first groups, and what.
    let mut around = [[0u64; 2]; MOST_DEPTH];
    let (mut depth, mut first) = (0, 0);
    let ordered = visitor.is_ordered();
    loop {
        while met == 0 {
            if depth == 0 {
                return;
            }
            depth -= 1;
            [first, met] = around[depth];
            if ordered && (end < start.end || met & (met - 1) != 0) {
                // Less is left if something was found meanwhile.
                let last = first as usize + met.ilog2() as usize / GROUP;
                met &= grid.met(first as usize..last + 1, &lanes, end, Some(entries));
            }
        }
        let slot = if ordered && met & (met - 1) != 0 {
            entries.first(met)
        } else {
            met.trailing_zeros() as usize
        };
        met &= !(1 << slot);
        let (group, slot) = (&grid.groups[first as usize + slot / GROUP], slot % GROUP);
        if group.is_divided(slot) {
            if met != 0 {
                around[depth] = [first, met];
                depth += 1;
            }
            let inside = group.groups(slot);
            first = inside.start as u64;
            met = grid.met(inside, &lanes, end, ordered.then_some(&mut *entries));
        } else {
            let cell = group.cell(slot);
            let eight = &grid.eights[group.eight(slot)];
            if visitor.visit_eight(cell, grid.listed(cell), eight).is_break() {
                return;
            }
            if ordered {
                let nearer = line.end(visitor.end());
                if nearer < end {
                    end = nearer;
                    met = entries.until(met, end);
                }
            }
        }
    }
}
