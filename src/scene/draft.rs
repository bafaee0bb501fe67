//! A scene as loaders and generators hand it over: f64 world coordinates, nothing checked yet.

use std::{fmt, sync::Arc};

use glam::{DVec3, Vec3};

use super::{Camera, Light, Material, Scene, SceneError, sensible};
use crate::geometry::{Triangle, Triangles};

/// One triangle in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DraftTriangle {
    /// The corners.
    pub corners: [DVec3; 3],
    /// Shading normals at the corners; zero vectors for a flat surface.
    pub normals: [Vec3; 3],
    /// Index into [`Draft::materials`].
    pub material: u32,
}

/// What was left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// Faces with an index that names no vertex.
    pub out_of_range: u64,
    /// Faces with a coordinate that is NaN or infinite, or becomes so in f32.
    pub not_finite: u64,
    /// Triangles of exactly zero area once rounded to f32.
    pub zero_area: u64,
}

impl Dropped {
    /// All together.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.out_of_range + self.not_finite + self.zero_area
    }
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of zero area, {} not finite, {} with an index out of range",
            self.zero_area, self.not_finite, self.out_of_range
        )
    }
}

/// A scene in the making.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// Name for messages.
    pub name: String,
    /// The triangles.
    pub triangles: Vec<DraftTriangle>,
    /// The materials; a default one is added if there is none.
    pub materials: Vec<Material>,
    /// The lights; sensible ones are added if there are none.
    pub lights: Vec<Light>,
    /// The camera; a sensible one is added if there is none.
    pub camera: Option<Camera>,
    /// See [`Scene::ambient`].
    pub ambient: Vec3,
    /// See [`Scene::background`].
    pub background: Vec3,
    /// See [`Scene::exposure`].
    pub exposure: Option<f32>,
    /// What the loader dropped already.
    pub dropped: Dropped,
    /// What the loader decided, one line each.
    pub notes: Vec<String>,
}

/// Geometry stays where it is while its centre is within this many of its diagonals of the origin:
/// up to there f32 loses at most 3 of its 24 bits to the offset.
const FAR_FROM_ORIGIN: f64 = 8.0;

impl Draft {
    /// Moves, rounds, checks and orders everything.
    ///
    /// # Errors
    /// [`SceneError::Empty`] if no triangle is left, [`SceneError::TooLarge`] beyond 2³² triangles.
    pub fn finish(mut self) -> Result<Scene, SceneError> {
        if self.triangles.len() > u32::MAX as usize {
            return Err(SceneError::TooLarge {
                name: self.name,
                problem: format!(
                    "{} triangles are more than a 32-bit index holds",
                    self.triangles.len()
                ),
            });
        }
        if self.materials.is_empty() {
            self.materials.push(Material::default());
        }
        let origin = self.local_origin();
        if origin != DVec3::ZERO {
            self.notes.push(format!(
                "geometry is far from the origin: moved by ({}, {}, {}) before rounding to single precision",
                -origin.x, -origin.y, -origin.z
            ));
        }
        let mut kept: Vec<(Triangle, DraftTriangle)> = Vec::with_capacity(self.triangles.len());
        for triangle in std::mem::take(&mut self.triangles) {
            let rounded = triangle.corners.map(|corner| (corner - origin).as_vec3());
            if !rounded.iter().all(|corner| corner.is_finite()) {
                self.dropped.not_finite += 1;
            } else if has_zero_area(&rounded) {
                self.dropped.zero_area += 1;
            } else {
                kept.push((rounded, triangle));
            }
        }
        if self.dropped.total() > 0 {
            self.notes.push(format!("dropped {} faces: {}", self.dropped.total(), self.dropped));
        }
        if kept.is_empty() {
            let dropped = match self.dropped.total() {
                0 => String::new(),
                n => format!(" left of {n} faces: {}", self.dropped),
            };
            return Err(SceneError::Empty { name: self.name, dropped });
        }
        let transparent =
            |triangle: &DraftTriangle| self.materials[triangle.material as usize].is_transparent();
        // Opaque first; the sort is stable, so the order of the file is kept otherwise.
        kept.sort_by_key(|(_, triangle)| transparent(triangle));
        let opaque = kept.partition_point(|(_, triangle)| !transparent(triangle));
        let corners =
            |part: &[(Triangle, DraftTriangle)]| part.iter().map(|t| t.0).collect::<Vec<_>>();
        let triangles = Triangles::new(corners(&kept[..opaque]), corners(&kept[opaque..]));
        let smooth = kept.iter().any(|(_, triangle)| triangle.normals != [Vec3::ZERO; 3]);
        let normals = if smooth { kept.iter().map(|t| t.1.normals).collect() } else { Vec::new() };
        let material_of = kept.iter().map(|t| t.1.material).collect();
        drop(kept);

        let mut scene = Scene {
            name: self.name,
            triangles: Arc::new(triangles),
            normals,
            material_of,
            materials: self.materials,
            lights: self.lights.into_iter().map(|light| light.relative_to(origin)).collect(),
            camera: Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0),
            ambient: self.ambient,
            background: self.background,
            exposure: self.exposure,
            origin,
            dropped: self.dropped,
            notes: self.notes,
        };
        match self.camera {
            Some(camera) => scene.camera = Camera { position: camera.position - origin, ..camera },
            None => sensible::add_camera(&mut scene),
        }
        if scene.lights.is_empty() {
            sensible::add_lights(&mut scene);
        }
        Ok(scene)
    }

    /// Where the local origin goes: zero for geometry near the origin, else the middle of its box,
    /// rounded to a power of two near its diagonal so that it is exact and readable.
    fn local_origin(&self) -> DVec3 {
        let finite = self.triangles.iter().flat_map(|t| t.corners).filter(|c| c.is_finite());
        let (min, max) = finite
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), corner| {
                (min.min(corner), max.max(corner))
            });
        if min.cmpgt(max).any() {
            return DVec3::ZERO;
        }
        let (centre, diagonal) = (0.5 * (min + max), (max - min).length());
        if centre.length() <= FAR_FROM_ORIGIN * diagonal {
            return DVec3::ZERO;
        }
        let unit = diagonal.log2().floor().exp2();
        (centre / unit).round() * unit
    }
}

/// Whether the three points lie on one line, decided without error: every product and difference of
/// f32 values is taken in f64 with its rounding error, so only an exact zero counts as zero.
fn has_zero_area([a, b, c]: &Triangle) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let zero = |ax: f64, ay: f64, bx: f64, by: f64, cx: f64, cy: f64| {
        robust::orient2d(
            robust::Coord { x: ax, y: ay },
            robust::Coord { x: bx, y: by },
            robust::Coord { x: cx, y: cy },
        ) == 0.0
    };
    zero(a.x, a.y, b.x, b.y, c.x, c.y)
        && zero(a.y, a.z, b.y, b.z, c.y, c.z)
        && zero(a.z, a.x, b.z, b.x, c.z, c.x)
}
