//! Triangles and lights, and nothing else.

use glam::Vec3;
use umbra::geometry::Triangle;
use umbra::scene::{Draft, DraftTriangle, Light, Scene};

/// A white point light.
pub fn point(position: Vec3) -> Light {
    Light::Point { position: position.as_dvec3(), intensity: Vec3::ONE }
}

/// A white directional light.
pub fn sun(direction: Vec3) -> Light {
    Light::Directional { direction: direction.as_dvec3(), irradiance: Vec3::ONE }
}

/// A scene of bare triangles under some lights.
pub fn scene(mesh: &[Triangle], lights: Vec<Light>) -> Scene {
    let triangle = |corners: &Triangle| DraftTriangle {
        corners: corners.map(|corner| corner.as_dvec3()),
        normals: [Vec3::ZERO; 3],
        material: 0,
    };
    let triangles = mesh.iter().map(triangle).collect();
    Draft { triangles, lights, ..Draft::default() }.finish().unwrap()
}
