//! A scene while it is put together from surfaces, at any tessellation.
//!
//! The same description is run more than once: only to count triangles, to make them, and to measure how
//! far they are from the surfaces.

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

use crate::geometry::surface::{
    Deviation, Mesh, Path, Resolution, Revolution, SecondDerivatives, Surface, Topology, Tube,
    cosine_and_sine, tessellate, triangle_count,
};
use crate::scene::{Draft, DraftTriangle, Material};

/// Where triangles go, or are only counted or measured.
pub(super) struct Model {
    /// The scene so far; without triangles unless they are made.
    pub(super) draft: Draft,
    /// Triangles so far.
    pub(super) count: u64,
    /// How far they are from the surfaces, if that is measured.
    pub(super) deviation: Deviation,
    /// Factor on every resolution, along each parameter.
    density: f64,
    purpose: Purpose,
}

/// What a description is run for, besides counting triangles.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Nothing.
    Count,
    /// The triangles themselves.
    Make,
    /// Their distance from the surfaces.
    Measure,
}

/// A material of a [`Model`].
#[derive(Clone, Copy)]
pub(super) struct MaterialId(u32);

/// One smooth run of a profile of (radius, height), and its cells.
pub(super) type Run<'a> = (&'a [(f64, f64)], usize);

impl Model {
    /// An empty model whose resolutions are multiplied by `density`.
    pub(super) fn new(name: &str, density: f64, purpose: Purpose) -> Self {
        let draft = Draft { name: name.to_owned(), ..Draft::default() };
        Self { draft, count: 0, deviation: Deviation::default(), density, purpose }
    }

    /// Adds a material.
    pub(super) fn material(&mut self, name: &str, material: Material) -> MaterialId {
        self.draft.materials.push(Material { name: name.to_owned(), ..material });
        MaterialId(self.draft.materials.len() as u32 - 1)
    }

    /// Adds a surface, `place` taking it to the world. Cells along u and v are those at density 1.
    pub(super) fn surface(
        &mut self,
        surface: &impl Surface,
        (u, v): (usize, usize),
        material: MaterialId,
        place: DAffine3,
    ) {
        let scaled = |cells: usize| (cells as f64 * self.density).round() as usize;
        let resolution = Resolution { u: scaled(u), v: scaled(v) };
        self.count += triangle_count(surface, resolution);
        match self.purpose {
            Purpose::Count => {}
            Purpose::Make => self.mesh(&tessellate(surface, resolution), material, place),
            Purpose::Measure => self.deviation += Deviation::of(surface, resolution, place),
        }
    }

    /// Adds the runs of a profile turned around the Y axis, with an edge where two runs meet.
    pub(super) fn lathe(
        &mut self,
        profile: &[Run],
        around: usize,
        material: MaterialId,
        place: DAffine3,
    ) {
        for (points, along) in profile {
            let points: Vec<_> = points.iter().map(|&point| DVec2::from(point)).collect();
            self.surface(&Revolution::through(&points), (around, *along), material, place);
        }
    }

    /// Adds a ball.
    pub(super) fn ball(
        &mut self,
        centre: DVec3,
        radius: f64,
        cells: (usize, usize),
        material: MaterialId,
    ) {
        let profile = [-4, -3, -2, -1, 0, 1, 2, 3, 4].map(|eighth| {
            let (cosine, sine) = cosine_and_sine(f64::from(eighth) / 16.0);
            // The poles are exactly on the axis.
            DVec2::new(radius * cosine, radius * sine)
        });
        let place = DAffine3::from_translation(centre);
        self.surface(&Revolution::through(&profile), cells, material, place);
    }

    /// Adds a tube through the points; `side` is the normal of their plane, or nearly.
    pub(super) fn tube(
        &mut self,
        points: &[DVec3],
        radius: f64,
        side: DVec3,
        cells: (usize, usize),
        material: MaterialId,
        place: DAffine3,
    ) {
        let tube = Tube { path: Path::through(points, None, None), radius, side: side.normalize() };
        self.surface(&tube, cells, material, place);
    }

    /// Adds a flat parallelogram; its front is on the side of `across` × `along`.
    pub(super) fn panel(
        &mut self,
        corner: DVec3,
        across: DVec3,
        along: DVec3,
        cells: (usize, usize),
        material: MaterialId,
    ) {
        self.surface(&Panel { corner, across, along }, cells, material, DAffine3::IDENTITY);
    }

    /// Adds a box between two corners, two triangles a side.
    pub(super) fn cuboid(
        &mut self,
        low: DVec3,
        high: DVec3,
        material: MaterialId,
        place: DAffine3,
    ) {
        let size = high - low;
        let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
        let sides =
            [(low, y, x), (low, z, y), (low, x, z), (high, -x, -y), (high, -y, -z), (high, -z, -x)];
        for (corner, across, along) in sides {
            self.surface(&Panel { corner, across, along }, (1, 1), material, place);
        }
    }

    fn mesh(&mut self, mesh: &Mesh, material: MaterialId, place: DAffine3) {
        let flat = mesh.normals.iter().all(|normal| *normal == mesh.normals[0]);
        let positions: Vec<_> = mesh.positions.iter().map(|p| place.transform_point3(*p)).collect();
        let normals: Vec<_> = mesh
            .normals
            .iter()
            .map(|normal| place.transform_vector3(*normal).normalize().as_vec3())
            .collect();
        self.draft.triangles.extend(mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|index| index as usize);
            DraftTriangle {
                corners: [positions[a], positions[b], positions[c]],
                normals: if flat { [Vec3::ZERO; 3] } else { [normals[a], normals[b], normals[c]] },
                material: material.0,
            }
        }));
    }
}

/// Turned about the Y axis by a fraction of a turn, then moved.
pub(super) fn turned(turns: f64, position: DVec3) -> DAffine3 {
    let (cosine, sine) = cosine_and_sine(turns);
    let x = DVec3::new(cosine, 0.0, -sine);
    let z = DVec3::new(sine, 0.0, cosine);
    DAffine3::from_mat3_translation(DMat3::from_cols(x, DVec3::Y, z), position)
}

/// The Y axis turned towards `direction`, then moved: for rods and what sits on them.
pub(super) fn aimed(direction: DVec3, position: DVec3) -> DAffine3 {
    let y = direction.normalize();
    let across = if y.x * y.x < 0.5 { DVec3::X } else { DVec3::Z };
    let z = across.cross(y).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(y.cross(z), y, z), position)
}

/// A flat parallelogram.
struct Panel {
    corner: DVec3,
    across: DVec3,
    along: DVec3,
}

impl Surface for Panel {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.across * u + self.along * v
    }

    fn normal(&self, _: f64, _: f64) -> DVec3 {
        self.across.cross(self.along).normalize()
    }

    fn second_derivatives(&self) -> SecondDerivatives {
        SecondDerivatives::default()
    }

    fn topology(&self) -> Topology {
        Topology::default()
    }
}
