//! The shaft of a voxel and a light: everything that rays from one to the other may meet (Haines &
//! Wallace 1991).
//!
//! It is the convex hull of two boxes, the voxel widened by its padding and the ends of rays; so it is
//! bounded by sides of the box around both, and by planes that touch both boxes along edges of one
//! direction, at corners of the same kind (both the lower left ones, say). All tests are in f64, and
//! what rounding errs by is many times less than what the boxes are widened by.
//!
//! Haines, Wallace: Shaft Culling for Efficient Ray-Cast Radiosity. Eurographics Workshop on Rendering 1991.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use super::{Source, Span};
use crate::occlusion::Level;

/// Two for each axis that an edge may have, four where boxes touch the same planes.
const MOST_PLANES: usize = 12;

/// What f64 errs by in a product of vectors, as a share of the product of their magnitudes; four times.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

/// A plane; the shaft is where `(x - place) · outwards <= 0`.
#[derive(Clone, Copy, Debug, Default)]
struct Plane {
    place: DVec3,
    outwards: DVec3,
}

impl Plane {
    #[inline]
    fn height(&self, point: DVec3) -> f64 {
        (point - self.place).dot(self.outwards)
    }
}

/// Where a triangle's plane lies between voxel and light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    /// It separates them, and its front (whence its corners are seen counterclockwise) faces the light.
    Front,
    /// It separates them, and its back faces the light.
    Back,
}

/// Everything between a voxel and a light.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    near: Span,
    far: Span,
    /// The axis along which they are farthest apart, and whether the light is at the greater coordinates.
    axis: usize,
    forward: bool,
    planes: [Plane; MOST_PLANES],
    count: usize,
}

impl Shaft {
    /// The shaft of a voxel; `None` if the light is not apart from it.
    pub fn new(near: Span, source: &Source) -> Option<Self> {
        let far = source.ends_from(&near);
        let (ahead, behind) = (far.low - near.high, near.low - far.high);
        let gaps = ahead.max(behind);
        let axis = (0..3).max_by(|&a, &b| gaps[a].total_cmp(&gaps[b]))?;
        if gaps[axis] <= 0.0 {
            return None;
        }
        let forward = ahead[axis] > 0.0;
        let planes = [Plane::default(); MOST_PLANES];
        let mut shaft = Self { near, far, axis, forward, planes, count: 0 };
        for along in 0..3 {
            for corner in 0..4 {
                shaft.touch(along, [corner & 1 != 0, corner & 2 != 0]);
            }
        }
        Some(shaft)
    }

    /// Adds the plane, along an axis, that touches both boxes at their corner of a kind (high or low
    /// along the other two axes), if it does.
    fn touch(&mut self, along: usize, high: [bool; 2]) {
        let axes = [(along + 1) % 3, (along + 2) % 3];
        let corner = |span: &Span| {
            let mut corner = span.low;
            for (axis, high) in axes.into_iter().zip(high) {
                if high {
                    corner[axis] = span.high[axis];
                }
            }
            corner
        };
        let (place, across) = (corner(&self.near), corner(&self.far) - corner(&self.near));
        for sign in [1.0, -1.0] {
            let mut outwards = DVec3::ZERO;
            outwards[axes[0]] = sign * across[axes[1]];
            outwards[axes[1]] = -sign * across[axes[0]];
            // Both boxes lie inside if nothing of them lies farther out than this corner.
            let out = |i: usize| if high[i] { outwards[axes[i]] } else { -outwards[axes[i]] };
            if out(0) >= 0.0 && out(1) >= 0.0 {
                self.planes[self.count] = Plane { place, outwards };
                self.count += 1;
                return;
            }
        }
    }

    /// Whether a triangle may come into it; `false` is certain.
    pub fn may_meet(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = *corners;
        let low = self.near.low.min(self.far.low);
        let high = self.near.high.max(self.far.high);
        if a.max(b).max(c).cmplt(low).any() || a.min(b).min(c).cmpgt(high).any() {
            return false;
        }
        let outside = |plane: &Plane| corners.iter().all(|&corner| plane.height(corner) > 0.0);
        if self.planes[..self.count].iter().any(outside) {
            return false;
        }
        let (near, far) = self.sides(corners);
        (near.0 <= 0.0 || far.0 <= 0.0) && (near.1 >= 0.0 || far.1 >= 0.0)
    }

    /// Whether an edge may come into it; `false` is certain.
    pub fn may_meet_edge(&self, from: DVec3, to: DVec3) -> bool {
        let low = self.near.low.min(self.far.low);
        let high = self.near.high.max(self.far.high);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let mut clip = |start: f64, end: f64| {
            if start > 0.0 && end > 0.0 {
                return false;
            }
            if start > 0.0 {
                enter = enter.max(start / (start - end));
            } else if end > 0.0 {
                leave = leave.min(start / (start - end));
            }
            enter <= leave
        };
        (0..3).all(|axis| {
            clip(low[axis] - from[axis], low[axis] - to[axis])
                && clip(from[axis] - high[axis], to[axis] - high[axis])
        }) && self.planes[..self.count]
            .iter()
            .all(|plane| clip(plane.height(from), plane.height(to)))
    }

    /// Whether a triangle's plane is certain to have the whole voxel on one side and the whole light on
    /// the other, and how the triangle faces the light.
    pub fn facing(&self, corners: &[DVec3; 3]) -> Option<Facing> {
        let (near, far) = self.sides(corners);
        if near.1 < 0.0 && far.0 > 0.0 {
            Some(Facing::Front)
        } else if far.1 < 0.0 && near.0 > 0.0 {
            Some(Facing::Back)
        } else {
            None
        }
    }

    /// The least and greatest heights of the voxel, and of the light, above a triangle's plane, in units
    /// of the length of its normal, and rounding included.
    fn sides(&self, &[a, b, c]: &[DVec3; 3]) -> ((f64, f64), (f64, f64)) {
        let (first, second) = (b - a, c - a);
        let normal = first.cross(second);
        let sizes = first.abs().element_sum() * second.abs().element_sum();
        let heights = |span: &Span| {
            let (centre, half) = (0.5 * (span.low + span.high), 0.5 * (span.high - span.low));
            let (middle, reach) = (normal.dot(centre - a), normal.abs().dot(half));
            let error = ROUNDING * sizes * ((centre - a).abs() + half).element_sum();
            (middle - reach - error, middle + reach + error)
        };
        (heights(&self.near), heights(&self.far))
    }

    /// Calls `found` with the place of every voxel that it comes into, slab by slab from the near end.
    pub fn voxels(
        &self,
        level: &Level,
        mut found: impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { near, far, axis, forward, .. } = *self;
        let count = level.resolution[axis];
        let own = level.voxel_of(0.5 * (near.low + near.high))[axis];
        let first = if forward { own } else { count - 1 - own };
        // The slab before its own too, for what the padding reaches there.
        for slab in first.saturating_sub(1)..count {
            let place = if forward { slab } else { count - 1 - slab };
            let start = level.min[axis] + f64::from(place) * level.side[axis] - level.pad;
            let end = start + level.side[axis] + 2.0 * level.pad;
            let Some((from, to)) = self.shares(start, end) else { continue };
            let at = |share: f64, low: DVec3, high: DVec3| low + share * (high - low);
            let low = at(from, near.low, far.low).min(at(to, near.low, far.low));
            let high = at(from, near.high, far.high).max(at(to, near.high, far.high));
            let (mut least, mut most) = (level.voxel_of(low), level.voxel_of(high));
            (least[axis], most[axis]) = (place, place);
            for z in least[2]..=most[2] {
                for y in least[1]..=most[1] {
                    for x in least[0]..=most[0] {
                        found(level.index([x, y, z]))?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// The part of the way, from 0 at the voxel to 1 at the light, on which it may be in a slab across
    /// its axis.
    fn shares(&self, start: f64, end: f64) -> Option<(f64, f64)> {
        let (near, far) = (&self.near, &self.far);
        let (near_low, near_high) = (near.low[self.axis], near.high[self.axis]);
        let (far_low, far_high) = (far.low[self.axis], far.high[self.axis]);
        // A share s has coordinates from near_low + s (far_low - near_low) to the same with high.
        let (from, to) = if self.forward {
            ((start - near_high) / (far_high - near_high), (end - near_low) / (far_low - near_low))
        } else {
            ((near_low - end) / (near_low - far_low), (near_high - start) / (near_high - far_high))
        };
        let (from, to) = (from.max(0.0), to.min(1.0));
        (from <= to).then_some((from, to))
    }
}

/// The corners of a triangle in f64.
pub(crate) fn widened(corners: [Vec3; 3]) -> [DVec3; 3] {
    corners.map(|corner| corner.as_dvec3())
}
