//! Eight triangles, stored as one vector test wants them.
//!
//! Gathering corners from all over the scene costs more than the test itself.

use crate::geometry::lanes::{Available, Lanes, LanesJob, Vector};
use crate::geometry::{TriangleId, Triangles, prefetch};

/// Triangles of an [`Eight`], and of all that is made of them.
pub const WIDTH: usize = 8;

/// So many eights before theirs, triangles are announced.
pub(crate) const AHEAD: usize = 8;

/// The corners of eight triangles: corner, coordinate, triangle.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct Eight([[[f32; WIDTH]; 3]; 3]);

impl Eight {
    /// Of these triangles; by whichever arithmetic is fastest.
    pub(crate) fn new(
        triangles: &Triangles,
        ids: &[TriangleId; WIDTH],
        arithmetic: Available,
    ) -> Self {
        arithmetic.run(Gather { triangles, ids })
    }

    /// Has memory asked for the corners of triangles of which others will be made soon. What is done with eight triangles is too
    /// much for the processor to see those of the next, and too little for their corners not to be waited for.
    #[inline(always)]
    pub(crate) fn announce(triangles: &Triangles, ids: &[TriangleId]) {
        for &id in ids {
            prefetch(&triangles.corners()[id as usize]);
        }
    }

    /// The coordinates of a corner of all eight, by axis.
    #[inline(always)]
    pub(crate) fn corner(&self, corner: usize) -> &[[f32; WIDTH]; 3] {
        &self.0[corner]
    }

    /// The corners of as many triangles as there are lanes, from `first` on.
    #[inline(always)]
    pub(crate) fn load<L: Lanes>(&self, first: usize) -> [Vector<L>; 3] {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = &self.0;
        [
            [L::load(ax, first), L::load(ay, first), L::load(az, first)],
            [L::load(bx, first), L::load(by, first), L::load(bz, first)],
            [L::load(cx, first), L::load(cy, first), L::load(cz, first)],
        ]
    }
}

struct Gather<'a> {
    triangles: &'a Triangles,
    ids: &'a [TriangleId; WIDTH],
}

impl LanesJob for Gather<'_> {
    type Answer = Eight;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Eight {
        let mut corners = [[[0.0; WIDTH]; 3]; 3];
        let mut first = 0;
        while first < WIDTH {
            let ids = &self.ids[first..first + L::COUNT];
            let gathered = L::gather(self.triangles.corners(), ids);
            for (corners, gathered) in corners.iter_mut().zip(gathered) {
                for (values, gathered) in corners.iter_mut().zip(gathered) {
                    gathered.store_to(values, first);
                }
            }
            first += L::COUNT;
        }
        Eight(corners)
    }
}
