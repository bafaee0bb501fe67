//! A scene as loaders and generators hand it over: f64 world coordinates, nothing checked yet.

use std::{fmt, path::PathBuf, sync::Arc};

use glam::{DVec3, Vec3};

use super::{
    Camera, Light, Material, Scene, SceneError,
    light::{is_colour, is_exposure},
    material::listed,
    sensible,
};
use crate::geometry::{Triangle, Triangles};
use crate::words::counted;

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

/// A scene in the making: how triangles that are in no file become a [`Scene`].
///
/// ```
/// use umbra::glam::{DVec3, Vec3};
/// use umbra::scene::{Draft, DraftTriangle, Light};
///
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Z];
/// let floor = DraftTriangle { corners, normals: [Vec3::ZERO; 3], material: 0 };
/// let lamp = Light::Point { position: 2.0 * DVec3::Y, intensity: Vec3::ONE };
/// let draft = Draft {
///     name: "floor".to_owned(),
///     triangles: vec![floor],
///     lights: vec![lamp],
///     ..Draft::default()
/// };
/// let scene = draft.finish()?;
/// assert_eq!((scene.triangles.len(), scene.lights.len()), (1, 1));
/// // There was no camera, so one was added.
/// assert!(scene.notes[0].starts_with("no usable camera"));
/// # Ok::<(), umbra::scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// Which way is up, for a sensible camera; guessed from the shape of the scene if unknown.
    pub up: Option<DVec3>,
    /// Whether `ambient` is to be chosen, for files that say nothing about it.
    pub choose_ambient: bool,
    /// Whether `background` is to be chosen, for files that say nothing about it.
    pub choose_background: bool,
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
    /// The files that were read.
    pub files: Vec<PathBuf>,
}

/// Geometry stays where it is while its centre is within this many of its diagonals of the origin:
/// up to there f32 loses at most 3 of its 24 bits to the offset.
const FAR_FROM_ORIGIN: f64 = 8.0;

impl Draft {
    /// Moves, rounds, checks and orders everything.
    ///
    /// # Errors
    /// [`SceneError::Empty`] if no triangle is left, [`SceneError::TooLarge`] beyond 2³² triangles,
    /// [`SceneError::Unsound`] if a triangle has a material that is not there. Lights, a camera and surroundings whose
    /// numbers make no sense are no error: they are left out with a note, and others take their place.
    pub fn finish(mut self) -> Result<Scene, SceneError> {
        if self.name.is_empty() {
            self.name = "unnamed scene".to_owned();
        }
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
        self.check_materials()?;
        self.clamp_materials();
        let origin = self.local_origin();
        if origin != DVec3::ZERO {
            self.notes.push(format!(
                "geometry is far from the origin: its local origin is at ({}, {}, {}) of the world",
                origin.x, origin.y, origin.z
            ));
        }
        let round =
            |triangle: &DraftTriangle| triangle.corners.map(|corner| (corner - origin).as_vec3());
        let transparent =
            |triangle: &DraftTriangle| self.materials[triangle.material as usize].is_transparent();
        // Opaque first, each in the order of the file. Places in the draft rather than copies: a
        // large draft is the peak of memory.
        let (mut opaque, mut seen_through) = (Vec::new(), Vec::new());
        for (index, triangle) in (0u32..).zip(&self.triangles) {
            let corners = round(triangle);
            if !corners.iter().all(|corner| corner.is_finite()) {
                self.dropped.not_finite += 1;
            } else if has_zero_area(&corners) {
                self.dropped.zero_area += 1;
            } else if transparent(triangle) {
                seen_through.push(index);
            } else {
                opaque.push(index);
            }
        }
        if self.dropped.total() > 0 {
            let faces = counted(self.dropped.total(), "face");
            self.notes.push(format!("dropped {faces}: {}", self.dropped));
        }
        if opaque.is_empty() && seen_through.is_empty() {
            let dropped = match self.dropped.total() {
                0 => String::new(),
                n => format!(" left of {}: {}", counted(n, "face"), self.dropped),
            };
            return Err(SceneError::Empty { name: self.name, dropped });
        }
        let at = |index: &u32| &self.triangles[*index as usize];
        let triangles = Triangles::new(
            opaque.iter().map(|index| round(at(index))),
            seen_through.iter().map(|index| round(at(index))),
        );
        let kept = || opaque.iter().chain(&seen_through).map(at);
        let material_of = kept().map(|triangle| triangle.material).collect();
        let smooth = kept().any(|triangle| sound_normals(triangle) != [Vec3::ZERO; 3]);
        let normals = if smooth { kept().map(sound_normals).collect() } else { Vec::new() };
        drop((opaque, seen_through, std::mem::take(&mut self.triangles)));
        self.drop_unsound_lights_and_camera();
        self.drop_unsound_surroundings();
        let lights = self.lights.into_iter().map(Light::with_unit_vectors);
        let lights = lights.map(|light| light.relative_to(origin));

        let mut scene = Scene {
            name: self.name,
            triangles: Arc::new(triangles),
            normals,
            material_of,
            materials: self.materials,
            lights: lights.collect(),
            camera: Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0),
            ambient: self.ambient,
            background: self.background,
            exposure: self.exposure,
            origin,
            dropped: self.dropped,
            notes: self.notes,
            files: self.files,
        };
        match self.camera {
            Some(camera) => scene.camera = Camera { position: camera.position - origin, ..camera },
            None => sensible::add_camera(&mut scene, self.up),
        }
        if scene.lights.is_empty() {
            sensible::add_lights(&mut scene);
        }
        if self.choose_ambient {
            sensible::choose_ambient(&mut scene);
        }
        if self.choose_background {
            sensible::choose_background(&mut scene);
        }
        Ok(scene)
    }

    /// Says something once, however often it is found.
    pub(super) fn note(&mut self, text: impl AsRef<str>) {
        let text = text.as_ref();
        if !self.notes.iter().any(|note| note == text) {
            self.notes.push(text.to_owned());
        }
    }

    /// Numbers that are not finite must not reach a renderer.
    fn drop_unsound_lights_and_camera(&mut self) {
        let count = self.lights.len();
        self.lights.retain(Light::is_sound);
        if self.lights.len() < count {
            let lights = counted((count - self.lights.len()) as u64, "light");
            self.notes.push(format!("left out {lights} whose numbers make no sense"));
        }
        if self.camera.is_some_and(|camera| !camera.is_sound()) {
            self.notes.push("left out a camera whose numbers make no sense".to_owned());
            self.camera = None;
        }
    }

    /// Refuses a triangle whose material is not there.
    fn check_materials(&self) -> Result<(), SceneError> {
        let count = self.materials.len();
        let missing = |triangle: &DraftTriangle| triangle.material as usize >= count;
        let Some(index) = self.triangles.iter().position(missing) else { return Ok(()) };
        let material = self.triangles[index].material;
        Err(SceneError::Unsound {
            name: self.name.clone(),
            problem: format!(
                "triangle {index} is of material {material}, and there are {count}, counted from 0; give one of these"
            ),
        })
    }

    /// The same for what a surface makes of light.
    fn clamp_materials(&mut self) {
        let mut changed = Vec::new();
        for material in &mut self.materials {
            let clamped = material.clamped();
            if *material != clamped {
                changed.push(clamped.name.clone());
                *material = clamped;
            }
        }
        if !changed.is_empty() {
            let note = format!("clamped the numbers that make no sense of {}", listed(&changed));
            self.notes.push(note);
        }
    }

    /// The same for light from everywhere and for the factor to picture values.
    fn drop_unsound_surroundings(&mut self) {
        if !is_colour(&self.ambient) || !is_colour(&self.background) {
            (self.choose_ambient, self.choose_background) = (true, true);
            self.notes.push(
                "left out the ambient light and the background: the numbers of one make no sense"
                    .to_owned(),
            );
        }
        if self.exposure.is_some_and(|factor| !is_exposure(factor)) {
            self.exposure = None;
            self.notes.push("left out an exposure that makes no sense".to_owned());
        }
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
        // A lone point has no diagonal to round to.
        if diagonal == 0.0 || centre.length() <= FAR_FROM_ORIGIN * diagonal {
            return DVec3::ZERO;
        }
        let unit = diagonal.log2().floor().exp2();
        (centre / unit).round() * unit
    }
}

/// The shading normals, or none where one is missing or not finite.
fn sound_normals(triangle: &DraftTriangle) -> [Vec3; 3] {
    let sound = |normal: &Vec3| normal.is_finite() && *normal != Vec3::ZERO;
    if triangle.normals.iter().all(sound) { triangle.normals } else { [Vec3::ZERO; 3] }
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
