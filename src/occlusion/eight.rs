//! Eight triangles, stored as one vector test wants them.

use glam::Vec3A;

use crate::geometry::lanes::{Lanes, Vector};

/// Triangles of one vector test.
pub(crate) const AT_ONCE: usize = 8;

/// The corners of eight triangles: corner, coordinate, triangle.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct Eight([[[f32; AT_ONCE]; 3]; 3]);

impl Eight {
    pub(crate) fn new(triangles: [&[Vec3A; 3]; AT_ONCE]) -> Self {
        let mut corners = [[[0.0; AT_ONCE]; 3]; 3];
        for (corner, values) in corners.iter_mut().enumerate() {
            for (lane, triangle) in triangles.iter().enumerate() {
                let [x, y, z] = triangle[corner].to_array();
                (values[0][lane], values[1][lane], values[2][lane]) = (x, y, z);
            }
        }
        Self(corners)
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
