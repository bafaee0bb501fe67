//! What is rendered: triangles with materials, lights, a camera.
//!
//! Loaders and built-in generators fill a [`Draft`] in f64 world coordinates; [`Draft::finish`]
//! moves it to a local origin, rounds it to f32 once, drops what is not a triangle and gives the
//! [`Scene`] that everything else reads.

pub mod builtin;
mod camera;
mod draft;
pub(crate) mod error;
mod gltf;
mod light;
mod load;
mod material;
mod memory;
mod mtl;
mod obj;
mod placement;
mod polygon;
mod sensible;
pub(crate) mod text;
mod toml;
mod write;

use std::{path::PathBuf, sync::Arc};

use glam::{DVec3, Vec3};

pub use camera::Camera;
pub use draft::{Draft, DraftTriangle, Dropped};
pub use error::SceneError;
pub use light::{Illumination, Light};
pub use load::{draft, load};
pub use material::Material;
pub use memory::default_budget;
pub use write::{files, write};

use crate::geometry::{Bounds, TriangleId, Triangles};

/// A scene ready for queries and rendering, in local f32 coordinates.
///
/// Geometry far from the world's origin is moved before it is rounded to f32, or it would lose its detail: local
/// coordinates are those of the world minus [`origin`](Self::origin), which is zero for most scenes. Whoever brings
/// rays of their own takes [`to_local`](Self::to_local) of their ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name for messages and statistics.
    pub name: String,
    /// The triangles, opaque ones first.
    pub triangles: Arc<Triangles>,
    /// Shading normals of each triangle's corners, in the order of `triangles`; zero vectors where
    /// the surface is flat. Empty if no triangle has any.
    pub normals: Vec<[Vec3; 3]>,
    /// Index into `materials` of each triangle.
    pub material_of: Vec<u32>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The lights, in local coordinates.
    pub lights: Vec<Light>,
    /// The camera, in local coordinates.
    pub camera: Camera,
    /// Light that reaches every point of every surface without shadow.
    pub ambient: Vec3,
    /// Radiance of rays that leave the scene.
    pub background: Vec3,
    /// Factor from radiance to picture values; `None`: chosen from the picture.
    pub exposure: Option<f32>,
    /// World coordinates = local coordinates + this; see [`Scene::to_local`].
    pub origin: DVec3,
    /// What was left out of the file.
    pub dropped: Dropped,
    /// What the program decided for the user (a camera, lights, a shift): one line each.
    pub notes: Vec<String>,
    /// The files that it was read from: whatever the file named pulls in, too.
    pub files: Vec<PathBuf>,
}

impl Scene {
    /// A point of the world in the scene's coordinates, moved in f64 and rounded once, as its corners were.
    ///
    /// ```
    /// # use umbra::scene::{Draft, DraftTriangle};
    /// use umbra::geometry::Ray;
    /// use umbra::glam::{DVec3, Vec3};
    ///
    /// // A sheet 4 m above the ground, in metres of a national grid.
    /// let place = DVec3::new(84_992.25, 447_488.5, 4.0);
    /// let corners = [place, place + 2.0 * DVec3::X, place + 2.0 * DVec3::Y];
    /// let sheet = DraftTriangle { corners, normals: [Vec3::ZERO; 3], material: 0 };
    /// let scene = Draft { triangles: vec![sheet], ..Draft::default() }.finish()?;
    ///
    /// let below = place + DVec3::new(0.5, 0.5, -4.0);
    /// let ray = Ray::between(scene.to_local(below), scene.to_local(below + 9.0 * DVec3::Z));
    /// assert!(umbra::exact::blocks(&ray, &scene.triangles.get(0)));
    /// # Ok::<(), umbra::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn to_local(&self, world: DVec3) -> Vec3 {
        (world - self.origin).as_vec3()
    }

    /// A point of the scene in the coordinates of the world.
    #[must_use]
    pub fn to_world(&self, local: Vec3) -> DVec3 {
        local.as_dvec3() + self.origin
    }

    /// The material of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[must_use]
    #[inline]
    pub fn material(&self, triangle: TriangleId) -> &Material {
        &self.materials[self.material_of[triangle as usize] as usize]
    }

    /// The box of all triangles.
    ///
    /// # Panics
    /// Without a triangle that is finite; a scene that [`Draft::finish`] made has one.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.triangles.bounds().expect("a scene has a finite triangle")
    }

    /// Whether any triangle lets light through.
    #[must_use]
    pub fn has_transparent(&self) -> bool {
        (self.triangles.opaque_count() as usize) < self.triangles.len()
    }
}
