//! Rays, aimed at parts of a mesh as it is after rounding.

use glam::DVec3;

use crate::exact::random::Random;
use crate::geometry::{Ray, Triangle, Triangles};

/// Aims at a mesh.
pub(super) struct Range<'a> {
    mesh: &'a [Triangle],
    pub centre: DVec3,
    /// Half the box's sides.
    pub half: DVec3,
}

impl<'a> Range<'a> {
    pub fn new(mesh: &'a [Triangle]) -> Self {
        let bounds = mesh.iter().copied().collect::<Triangles>().bounds().unwrap_or_default();
        let half = 0.5 * (bounds.max.as_dvec3() - bounds.min.as_dvec3());
        Self { mesh, centre: bounds.centre(), half }
    }

    /// The largest half side.
    pub fn size(&self) -> f64 {
        self.half.max_element()
    }

    /// A point in the box, or a little outside.
    pub fn anywhere(&self, random: &mut Random) -> DVec3 {
        // Flat meshes are seen from outside their plane too.
        self.centre + 1.2 * self.half.max(DVec3::splat(0.3 * self.size())) * random.point()
    }

    pub fn triangle(&self, random: &mut Random) -> [DVec3; 3] {
        self.mesh[random.below(self.mesh.len())].map(|corner| corner.as_dvec3())
    }

    pub fn corner(&self, random: &mut Random) -> DVec3 {
        self.triangle(random)[random.below(3)]
    }

    pub fn edge(&self, random: &mut Random) -> DVec3 {
        let corners = self.triangle(random);
        let first = random.below(3);
        let (a, b) = (corners[first], corners[(first + 1) % 3]);
        let along = if random.one_in(2) { random.below(5) as f64 / 4.0 } else { random.unit() };
        a + along * (b - a)
    }

    pub fn face(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = self.triangle(random);
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + u * (b - a) + v * (c - a)
    }

    /// A step of 10⁻⁹ to 10⁻⁴ of the mesh's size.
    pub fn nudge(&self, random: &mut Random) -> DVec3 {
        self.size() * random.nudge()
    }

    /// A point in, on or near some triangle.
    pub fn target(&self, random: &mut Random) -> DVec3 {
        match random.below(5) {
            0 => self.corner(random),
            1 => self.edge(random),
            2 => self.edge(random) + self.nudge(random),
            3 => self.face(random),
            _ => self.anywhere(random),
        }
    }
}

/// A ray from a point, rounded, through another: most go on beyond it, some end before, some never end.
pub(super) fn through(origin: DVec3, target: DVec3, random: &mut Random) -> Ray {
    let origin = origin.as_vec3();
    let reach = [1.5, 2.0, 4.0, 0.75][random.below(4)];
    let direction = (reach * (target - origin.as_dvec3())).as_vec3();
    if random.one_in(4) {
        Ray::towards(origin, direction)
    } else {
        Ray { origin, direction, end: 1.0 }
    }
}

/// The open segment between two points, both rounded: what a shadow query to a point light is.
pub(super) fn segment(origin: DVec3, light: DVec3) -> Ray {
    Ray::between(origin.as_vec3(), light.as_vec3())
}
