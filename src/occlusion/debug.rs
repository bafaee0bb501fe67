//! Backends in a line: what they take, not the millions of numbers that they hold.

use std::any::type_name;
use std::fmt;

#[cfg(feature = "embree")]
use super::Embree;
use super::{Brute, Bvh2, Cwbvh, DividedGrid, Engine, Grid, NestedGrid, Occlusion, Walk};
use crate::geometry::intersect::TriangleTest;

impl fmt::Debug for dyn Occlusion + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Occlusion").field("bytes", &self.memory()).finish_non_exhaustive()
    }
}

impl<W: Walk, T: TriangleTest> fmt::Debug for Engine<W, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Engine")
            .field("walk", &type_name::<W>())
            .field("test", &type_name::<T>())
            .field("triangles", &self.triangles().len())
            .field("bytes", &Occlusion::memory(self))
            .finish_non_exhaustive()
    }
}

#[cfg(feature = "embree")]
impl fmt::Debug for Embree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Embree").field("bytes", &self.memory()).finish_non_exhaustive()
    }
}

macro_rules! in_bytes {
    ($($walk:ident),+) => {$(
        impl fmt::Debug for $walk {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let bytes = Walk::memory(self);
                f.debug_struct(stringify!($walk)).field("bytes", &bytes).finish_non_exhaustive()
            }
        }
    )+};
}

in_bytes!(Brute, Bvh2, Cwbvh, DividedGrid, Grid, NestedGrid);
