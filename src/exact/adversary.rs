//! Queries that are hard to get right, one family per [`Class`].
//!
//! Every query is a function of its class and index alone: the same on every machine, in any order, on any
//! thread. So it uses no library functions that round differently from platform to platform.

use glam::DVec3;

use super::random::{Random, power_of_two};
use crate::geometry::{Ray, Triangle};

macro_rules! classes {
    ($($(#[$doc:meta])* $class:ident $name:literal,)*) => {
        /// A family of hard queries.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Class { $($(#[$doc])* $class,)* }

        impl Class {
            /// Every class.
            pub const ALL: &[Self] = &[$(Self::$class,)*];

            /// What reports and the command line call it.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$class => $name,)* }
            }
        }
    };
}

classes! {
    /// No aim at all.
    Random "random",
    /// At a point of an edge, or of its extension.
    Edge "edge",
    /// At a vertex.
    Vertex "vertex",
    /// Within 10⁻⁹ to 10⁻⁴ of an edge.
    NearEdge "near-edge",
    /// Within 10⁻⁹ to 10⁻⁴ of a vertex.
    NearVertex "near-vertex",
    /// Parallel to an axis, at edges and vertices too.
    AxisParallel "axis-parallel",
    /// In the plane of the triangle, exactly or but for rounding.
    InPlane "in-plane",
    /// Almost in the plane of the triangle: slopes down to 10⁻⁷.
    Grazing "grazing",
    /// A triangle about 10⁷ times as long as wide.
    Sliver "sliver",
    /// All scaled alike, by 10⁻³⁰ to 10¹⁸.
    Scaled "scaled",
    /// Each axis scaled by itself, over all the range of f32: products over- and underflow.
    Stretched "stretched",
    /// A long or short direction with an end that makes up for it.
    Rescaled "rescaled",
    /// Far from the zero point, up to 10⁷.
    Offset "offset",
    /// Among the denormals.
    Denormal "denormal",
    /// Coordinates −1, −0, 0 and 1.
    SignedZero "signed-zero",
    /// Small integers, where everything touches everything.
    Lattice "lattice",
    /// From a vertex, an edge or the face.
    OriginOnTriangle "origin-on-triangle",
    /// To a point of the triangle, exactly or but for rounding.
    EndOnTriangle "end-on-triangle",
    /// An end of the ray within 10⁻⁹ to 10⁻⁴ of the triangle.
    EndNearTriangle "end-near-triangle",
    /// Coincident or collinear corners.
    Degenerate "degenerate",
    /// Ends near the greatest and the least f32.
    ExtremeEnd "extreme-end",
    /// Towards a direction: no end.
    Directional "directional",
    /// Small and far away.
    Distant "distant",
    /// Any bits at all, often infinite or not a number.
    Bits "bits",
}

impl std::fmt::Display for Class {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(self.name())
    }
}

/// The query of this class with this index.
#[must_use]
pub fn query(class: Class, index: u64) -> (Ray, Triangle) {
    let mut random = Random::new(class as u64, index);
    let mut draft = match class {
        Class::SignedZero => Draft::from_points(&mut random, |random| random.lattice_point(1)),
        Class::Lattice => Draft::from_points(&mut random, |random| random.lattice_point(3)),
        _ if random.one_in(4) => {
            Draft::from_points(&mut random, |random| random.lattice_point(16) / 8.0)
        }
        _ => Draft::from_points(&mut random, Random::point),
    };
    match class {
        Class::Random | Class::SignedZero | Class::Lattice => {}
        Class::Edge => draft.aim_at(draft.edge_point(&mut random), &mut random),
        Class::Vertex => draft.aim_at(draft.corners[random.below(3)], &mut random),
        Class::NearEdge => {
            draft.aim_at(draft.edge_point(&mut random) + random.nudge(), &mut random)
        }
        Class::NearVertex => {
            draft.aim_at(draft.corners[random.below(3)] + random.nudge(), &mut random)
        }
        Class::AxisParallel => {
            let (target, axis) = (draft.target(&mut random), random.below(3));
            let along = draft.origin[axis];
            draft.origin = target;
            draft.origin[axis] = along;
            draft.aim_at(target, &mut random);
        }
        Class::InPlane | Class::Grazing => {
            let [a, b, c] = draft.corners;
            let steps = |random: &mut Random| {
                random.lattice(4) / 2.0 * (b - a) + random.lattice(4) / 2.0 * (c - a)
            };
            draft.origin = a + steps(&mut random);
            let target =
                if random.one_in(2) { a + steps(&mut random) } else { draft.target(&mut random) };
            if class == Class::Grazing {
                draft.origin += random.power_of_two(-24, -8) * random.point();
            }
            draft.aim_at(target, &mut random);
        }
        Class::Sliver => {
            let [a, b, _] = draft.corners;
            draft.corners[2] =
                a + 1.5 * random.unit() * (b - a) + random.power_of_two(-25, -21) * random.point();
            draft.corners.rotate_left(random.below(3));
            draft.aim_at_triangle(&mut random);
        }
        Class::Scaled | Class::Denormal => {
            let exponents = if class == Class::Scaled { (-100, 60) } else { (-149, -126) };
            draft.aim_at_triangle(&mut random);
            draft.stretch(DVec3::splat(random.power_of_two(exponents.0, exponents.1)));
        }
        Class::Stretched => {
            draft.aim_at_triangle(&mut random);
            draft.stretch(DVec3::from_array([0; 3].map(|_| random.power_of_two(-140, 125))));
        }
        Class::Rescaled => {
            draft.aim_at_triangle(&mut random);
            let factor = random.power_of_two(-100, 100);
            draft.direction *= factor;
            draft.end /= factor;
        }
        Class::Offset => {
            draft.aim_at_triangle(&mut random);
            let offset = random.power_of_two(0, 24) * random.point();
            draft.origin += offset;
            draft.corners = draft.corners.map(|corner| corner + offset);
        }
        Class::OriginOnTriangle => {
            draft.origin = draft.target(&mut random);
            if random.one_in(2) {
                draft.aim_at(random.point(), &mut random);
            } else {
                draft.aim_at_triangle(&mut random);
            }
        }
        Class::EndOnTriangle | Class::EndNearTriangle => {
            let mut target = draft.target(&mut random);
            if class == Class::EndNearTriangle {
                target += random.nudge();
            }
            draft.direction = target - draft.origin;
            draft.end = random.power_of_two(-3, 3);
            draft.direction /= draft.end;
            if class == Class::EndNearTriangle && random.one_in(2) {
                draft.origin += draft.direction * draft.end;
                draft.direction = -draft.direction;
            }
        }
        Class::Degenerate => {
            let [a, b, _] = draft.corners;
            let along = [0.0, 1.0, 0.5, -1.0, 2.0][random.below(5)];
            draft.corners[2] = a + along * (b - a);
            if random.one_in(8) {
                draft.corners = [a; 3];
            }
            draft.aim_at_triangle(&mut random);
        }
        Class::ExtremeEnd => {
            draft.aim_at_triangle(&mut random);
            let (end, factor) = if random.one_in(2) { (120.0, -120) } else { (-130.0, 100) };
            draft.direction *= power_of_two(factor);
            draft.end *= power_of_two(end as i32);
        }
        Class::Directional => {
            draft.aim_at_triangle(&mut random);
            draft.end = f64::INFINITY;
        }
        Class::Distant => {
            let (size, place) = (random.power_of_two(-20, -4), 4.0 * random.point());
            draft.corners = draft.corners.map(|corner| place + size * corner);
            draft.aim_at_triangle(&mut random);
        }
        Class::Bits => return (random.any_ray(), random.any_triangle()),
    }
    draft.rounded()
}

/// A query before rounding to f32.
struct Draft {
    origin: DVec3,
    direction: DVec3,
    end: f64,
    corners: [DVec3; 3],
}

impl Draft {
    fn from_points(random: &mut Random, mut point: impl FnMut(&mut Random) -> DVec3) -> Self {
        Self {
            origin: point(random),
            direction: point(random) - point(random),
            end: [1.0, 1.0, 2.0, f64::INFINITY][random.below(4)],
            corners: [0; 3].map(|_| point(random)),
        }
    }

    /// A point of an edge, or somewhat beyond its ends.
    fn edge_point(&self, random: &mut Random) -> DVec3 {
        let corner = random.below(3);
        let (a, b) = (self.corners[corner], self.corners[(corner + 1) % 3]);
        let along =
            if random.one_in(2) { random.lattice(5) / 4.0 } else { 1.2 * random.unit() - 0.1 };
        a + along * (b - a)
    }

    /// A point in, on or near the triangle.
    fn target(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = self.corners;
        match random.below(6) {
            0 => a,
            1 => self.edge_point(random),
            2 => self.edge_point(random) + random.nudge(),
            3 => 0.25 * a + 0.25 * b + 0.5 * c,
            4 => {
                let (from_a, along) = (random.unit(), random.unit());
                a + from_a * (b - a + along * (c - b))
            }
            _ => a + random.signed() * (b - a) + random.signed() * (c - a),
        }
    }

    /// Points the ray at the target, which it may or may not reach.
    fn aim_at(&mut self, target: DVec3, random: &mut Random) {
        self.direction =
            (target - self.origin) * [1.0, 2.0, 4.0, 0.75, 2.0 * random.unit()][random.below(5)];
    }

    fn aim_at_triangle(&mut self, random: &mut Random) {
        self.aim_at(self.target(random), random);
    }

    fn stretch(&mut self, factors: DVec3) {
        self.origin *= factors;
        self.direction *= factors;
        self.corners = self.corners.map(|corner| corner * factors);
    }

    fn rounded(self) -> (Ray, Triangle) {
        let ray = Ray {
            origin: self.origin.as_vec3(),
            direction: self.direction.as_vec3(),
            end: self.end as f32,
        };
        (ray, self.corners.map(|corner| corner.as_vec3()))
    }
}
