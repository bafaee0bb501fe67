//! From a surface to triangles: a grid of parameters, two triangles a cell, one at a pole.
//!
//! Cells share the vertices of their grid, and a closed edge is one column of vertices, so there are
//! no cracks inside a surface. Two surfaces that share an edge and its resolution evaluate it at
//! the same parameters and get the same points.

use glam::DVec3;

use super::{Surface, Topology};

/// Cells of the parameter grid along u and v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Along u.
    pub u: usize,
    /// Along v.
    pub v: usize,
}

impl Resolution {
    /// The resolution at which no point of a triangle is farther than `tolerance` from the point of
    /// the surface at the same parameters.
    ///
    /// Over a cell of sides a and b that error is at most ⅛(a²·Suu + 2ab·Suv + b²·Svv), with bounds
    /// S of the second derivatives (Filip, Magedson & Markot 1986); 2ab ≤ a² + b² parts the cell's
    /// sides, and each gets half of the tolerance.
    ///
    /// # Panics
    /// If the surface has a cusp, which no bound holds; if the tolerance is not above 0, which none but flat surfaces keep.
    #[must_use]
    pub fn for_tolerance(surface: &impl Surface, tolerance: f64) -> Self {
        assert!(tolerance > 0.0, "no resolution keeps a tolerance of {tolerance}");
        let bounds = surface.second_derivatives();
        let cells = |bound: f64| {
            assert!(bound.is_finite(), "a surface with a cusp has no resolution for a tolerance");
            (0.5 * (bound / tolerance).sqrt()).ceil() as usize
        };
        Self { u: cells(bounds.uu + bounds.uv), v: cells(bounds.vv + bounds.uv) }.fitting(surface)
    }

    /// This resolution, or the least that the surface needs.
    #[must_use]
    pub fn fitting(self, surface: &impl Surface) -> Self {
        let Topology { closed_u, pole_at_start, pole_at_end } = surface.topology();
        Self {
            u: self.u.max(if closed_u { 3 } else { 1 }),
            v: self.v.max(if pole_at_start && pole_at_end { 2 } else { 1 }),
        }
    }
}

/// Triangles with shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Places of the vertices.
    pub positions: Vec<DVec3>,
    /// Unit normals of the surface there.
    pub normals: Vec<DVec3>,
    /// Indices of three vertices each, counter-clockwise as seen from the side of the normals.
    pub triangles: Vec<[u32; 3]>,
}

/// How many triangles [`tessellate`] makes.
#[must_use]
pub fn triangle_count(surface: &impl Surface, resolution: Resolution) -> u64 {
    let Resolution { u, v } = resolution.fitting(surface);
    let topology = surface.topology();
    let poles = u64::from(topology.pole_at_start) + u64::from(topology.pole_at_end);
    u as u64 * (2 * v as u64 - poles)
}

/// The triangles of a surface at a resolution that is made [`fitting`](Resolution::fitting) first.
///
/// # Panics
/// With more than 2³² vertices.
#[must_use]
pub fn tessellate(surface: &impl Surface, resolution: Resolution) -> Mesh {
    let Resolution { u: across, v: along } = resolution.fitting(surface);
    let topology = surface.topology();
    let columns = if topology.closed_u { across } else { across + 1 };
    let mut mesh = Mesh::default();
    for row in 0..=along {
        let v = row as f64 / along as f64;
        let pole = (row == 0 && topology.pole_at_start) || (row == along && topology.pole_at_end);
        for column in 0..columns {
            let u = column as f64 / across as f64;
            // A pole is one point to the last bit.
            mesh.positions.push(surface.point(if pole { 0.0 } else { u }, v));
            mesh.normals.push(surface.normal(u, v));
        }
    }
    let vertex = |row: usize, column: usize| {
        let column = if topology.closed_u { column % columns } else { column };
        u32::try_from(row * columns + column).expect("vertex count fits u32")
    };
    for row in 0..along {
        for column in 0..across {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column), vertex(row + 1, column + 1)];
            if !(topology.pole_at_start && row == 0) {
                mesh.triangles.push([a, b, d]);
            }
            if !(topology.pole_at_end && row + 1 == along) {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}
