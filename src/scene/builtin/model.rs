//! A scene while it is put together from surfaces, at any tessellation.
//!
//! The same description is run twice: once only to count triangles, once to make them.

use glam::{DAffine3, DVec2, DVec3, Vec3};

use crate::geometry::surface::{
    Cubic, Mesh, Resolution, Revolution, Surface, tessellate, triangle_count,
};
use crate::scene::{Draft, DraftTriangle, Material};

/// Where triangles go, or are only counted.
pub(super) struct Model {
    /// The scene so far; without triangles when counting.
    pub(super) draft: Draft,
    /// Triangles so far.
    pub(super) count: u64,
    /// Factor on every resolution, along each parameter.
    density: f64,
    counting: bool,
}

/// A material of a [`Model`].
#[derive(Clone, Copy)]
pub(super) struct MaterialId(u32);

impl Model {
    /// An empty model whose resolutions are multiplied by `density`.
    pub(super) fn new(name: &str, density: f64, counting: bool) -> Self {
        let draft = Draft { name: name.to_owned(), ..Draft::default() };
        Self { draft, count: 0, density, counting }
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
        let scaled = |cells: usize| (cells as f64 * self.density).round().max(1.0) as usize;
        let resolution = Resolution { u: scaled(u), v: scaled(v) };
        self.count += triangle_count(surface, resolution);
        if !self.counting {
            self.mesh(&tessellate(surface, resolution), material, place);
        }
    }

    /// Adds the pieces of a profile turned around the Y axis, each with its cells along v.
    pub(super) fn lathe(
        &mut self,
        profile: &[(Cubic<DVec2>, usize)],
        around: usize,
        material: MaterialId,
        place: DAffine3,
    ) {
        for &(profile, along) in profile {
            self.surface(&Revolution { profile }, (around, along), material, place);
        }
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

    fn mesh(&mut self, mesh: &Mesh, material: MaterialId, place: DAffine3) {
        let flat = mesh.normals.iter().all(|normal| *normal == mesh.normals[0]);
        let positions: Vec<_> = mesh.positions.iter().map(|p| place.transform_point3(*p)).collect();
        let normals: Vec<_> = mesh
            .normals
            .iter()
            .map(|n| place.transform_vector3(*n).normalize().as_vec3())
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

/// A flat parallelogram.
pub(super) struct Panel {
    pub(super) corner: DVec3,
    pub(super) across: DVec3,
    pub(super) along: DVec3,
}

impl Surface for Panel {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.across * u + self.along * v
    }

    fn normal(&self, _: f64, _: f64) -> DVec3 {
        self.across.cross(self.along).normalize()
    }

    fn second_derivatives(&self) -> crate::geometry::surface::SecondDerivatives {
        crate::geometry::surface::SecondDerivatives::default()
    }

    fn topology(&self) -> crate::geometry::surface::Topology {
        crate::geometry::surface::Topology::default()
    }
}
