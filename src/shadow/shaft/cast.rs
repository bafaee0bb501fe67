//! The shadow of one triangle, cast on packets of queries.
//!
//! First on the boxes of sixteen packets at once: most triangles that may shade a part of a bundle touch two or three of its
//! packets. Then on the queries of those, sixteen at once again.

use super::columns::Row;
use super::planes::Planes;
use crate::geometry::TriangleId;
use crate::geometry::lanes::Sixteen;

/// Beyond this a plane is certain for a whole box; a little more than 1, for the rounding of sums.
const CERTAIN: f32 = 1.001;

/// Four planes of a triangle, each coefficient sixteen times.
pub(super) struct Shadow<S> {
    pub triangle: TriangleId,
    /// Normal and value of each.
    planes: [[S; 4]; 4],
    /// Whether it is not certain on which side of the triangle the light is: then planes say nothing.
    pub unsided: bool,
}

/// Of sixteen packets, a bit each.
pub(super) struct Judged {
    /// Those that the shadow may fall on.
    pub touched: u16,
    /// Those that are in it.
    pub covered: u16,
}

/// Of the queries of a packet, a bit each.
pub(super) struct Cast {
    /// Those that are in the shadow.
    pub blocked: u16,
    /// Those that the exact test must decide.
    pub doubtful: u16,
}

impl<S: Sixteen> Shadow<S> {
    /// That of one of eight triangles.
    #[inline(always)]
    pub fn of(known: &Planes, lane: usize, triangle: TriangleId) -> Self {
        let mut planes = [[S::splat(0.0); 4]; 4];
        for (number, plane) in planes.iter_mut().enumerate() {
            let [x, y, z] = &known.normals[number];
            let value = &known.values[number];
            *plane =
                [S::splat(x[lane]), S::splat(y[lane]), S::splat(z[lane]), S::splat(value[lane])];
        }
        Self { triangle, planes, unsided: known.unsided & (1 << lane) != 0 }
    }

    /// On which of sixteen boxes it falls, given by their middles and halves. Not for those without a side.
    ///
    /// A plane's value in a box is that in the middle, and half of the box times the normal's magnitudes more or less. What
    /// rounding there errs by is within the bound that the plane was divided by, as it is for an origin.
    #[inline(always)]
    pub fn judge(&self, middles: &[Row; 3], halves: &[Row; 3]) -> Judged {
        let [x, y, z] = load::<S>(middles);
        let [half_x, half_y, half_z] = load::<S>(halves);
        let (mut lowest, mut highest) = (S::splat(f32::INFINITY), S::splat(f32::INFINITY));
        for [nx, ny, nz, value] in self.planes {
            let middle = nx.mul_add(x, ny.mul_add(y, nz.mul_add(z, value)));
            let reach = nx.abs().mul_add(half_x, ny.abs().mul_add(half_y, nz.abs().mul(half_z)));
            lowest = lowest.min(middle.sub(reach));
            highest = highest.min(middle.add(reach));
        }
        Judged {
            touched: !highest.less(S::splat(-CERTAIN)),
            covered: S::splat(CERTAIN).less(lowest),
        }
    }

    /// On which of a packet's open queries it falls.
    #[inline(always)]
    pub fn cast(&self, origins: &[Row; 3], open: u16) -> Cast {
        if self.unsided {
            return Cast { blocked: 0, doubtful: open };
        }
        let [x, y, z] = load::<S>(origins);
        let mut least = S::splat(f32::INFINITY);
        for [nx, ny, nz, value] in self.planes {
            least = least.min(nx.mul_add(x, ny.mul_add(y, nz.mul_add(z, value))));
        }
        let (certain, missed) = (S::splat(1.0).less(least), least.less(S::splat(-1.0)));
        Cast { blocked: open & certain, doubtful: open & !(certain | missed) }
    }
}

#[inline(always)]
fn load<S: Sixteen>(rows: &[Row; 3]) -> [S; 3] {
    [S::load(&rows[0].0), S::load(&rows[1].0), S::load(&rows[2].0)]
}
