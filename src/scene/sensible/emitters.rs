//! Point lights in place of emissive surfaces, for files that have no other light.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::{
    geometry::TriangleId,
    scene::{Light, Scene},
};

/// Most lights that are made.
const MOST: usize = 16;
/// How far before its surface a light stands, as a share of the size of that surface.
const CLEARANCE: f64 = 0.01;

/// What was found.
pub(super) struct Emitters {
    /// A light for each surface, brightest first, the brightest only.
    pub(super) lights: Vec<Light>,
    /// How many emissive surfaces there are.
    pub(super) surfaces: usize,
    /// Their share of the area of all surfaces.
    pub(super) share: f64,
    /// Whether they shine more or less than f32 holds, so that there are no lights in their place.
    pub(super) beyond_f32: bool,
}

/// One connected emissive surface.
#[derive(Default)]
struct Surface {
    corners: Vec<DVec3>,
    area: f64,
    /// Sum over triangles of area times normal.
    normal: DVec3,
    /// Sum over triangles of area times centroid.
    weighted: DVec3,
    /// Sum over triangles of area times emission.
    power: DVec3,
}

/// A point light for each connected emissive surface, of the intensity with which a flat one of the
/// same area and emission shines straight ahead.
pub(super) fn lights(scene: &Scene) -> Emitters {
    let mut surfaces = surfaces(scene);
    surfaces.sort_by(|a, b| b.power.element_sum().total_cmp(&a.power.element_sum()));
    if surfaces.is_empty() {
        return Emitters { lights: Vec::new(), surfaces: 0, share: 0.0, beyond_f32: false };
    }
    let everything = everything(scene);
    let middle = everything.centre();
    let brightest = surfaces.iter().take(MOST);
    // A scene may be so large or so small that its areas and squares of distances are not held.
    let beyond_f32 = brightest.clone().any(|surface| !is_held(surface.power.max_element()))
        || !is_held(scene.bounds().diagonal().powi(2));
    Emitters {
        lights: match beyond_f32 {
            true => Vec::new(),
            false => brightest.map(|surface| surface.light(middle)).collect(),
        },
        surfaces: surfaces.len(),
        share: surfaces.iter().map(|surface| surface.area).sum::<f64>() / everything.area,
        beyond_f32,
    }
}

/// Whether f32 holds the number and its reciprocal with all their digits.
pub(super) fn is_held(number: f64) -> bool {
    (number as f32).is_normal() && (number.recip() as f32).is_normal()
}

impl Surface {
    fn add(&mut self, corners: [DVec3; 3], emission: Vec3) {
        let normal = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = normal.length();
        self.area += area;
        self.normal += normal;
        self.weighted += area * (corners[0] + corners[1] + corners[2]) / 3.0;
        self.power += area * emission.as_dvec3();
        self.corners.extend(corners);
    }

    fn centre(&self) -> DVec3 {
        self.weighted / self.area
    }

    /// Just outside the surface, on the side where the middle of the scene is.
    fn light(&self, middle: DVec3) -> Light {
        let centre = self.centre();
        let inwards = (middle - centre).normalize_or(DVec3::NEG_Y);
        // A closed surface, such as a bulb, has no normal.
        let ahead = if self.normal.length() > 0.1 * self.area {
            self.normal.normalize() * self.normal.dot(inwards).signum()
        } else {
            inwards
        };
        let relative = || self.corners.iter().map(|&corner| corner - centre);
        let size = relative().map(DVec3::length).fold(0.0, f64::max);
        let front = relative().map(|corner| corner.dot(ahead)).fold(0.0, f64::max);
        let position = centre + (front + CLEARANCE * size) * ahead;
        Light::Point { position, intensity: self.power.as_vec3() }
    }
}

/// All triangles as one surface.
fn everything(scene: &Scene) -> Surface {
    let mut all = Surface::default();
    for id in 0..scene.triangles.len() as TriangleId {
        all.add(scene.triangles.get(id).map(|corner| corner.as_dvec3()), Vec3::ZERO);
        all.corners.clear();
    }
    all
}

/// Emissive triangles, joined where they share a corner.
fn surfaces(scene: &Scene) -> Vec<Surface> {
    let emissive: Vec<TriangleId> = (0..scene.triangles.len() as TriangleId)
        .filter(|&id| scene.material(id).emission != Vec3::ZERO)
        .collect();
    let mut parents: Vec<usize> = (0..emissive.len()).collect();
    let mut owners: HashMap<[u32; 3], usize> = HashMap::new();
    for (index, &id) in emissive.iter().enumerate() {
        for corner in scene.triangles.get(id) {
            // Adding zero makes one zero of the two.
            let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
            let owner = *owners.entry(key).or_insert(index);
            let (a, b) = (root(&mut parents, owner), root(&mut parents, index));
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut places: HashMap<usize, usize> = HashMap::new();
    let mut surfaces: Vec<Surface> = Vec::new();
    for (index, &id) in emissive.iter().enumerate() {
        let place = *places.entry(root(&mut parents, index)).or_insert(surfaces.len());
        if place == surfaces.len() {
            surfaces.push(Surface::default());
        }
        let corners = scene.triangles.get(id).map(|corner| corner.as_dvec3());
        surfaces[place].add(corners, scene.material(id).emission);
    }
    surfaces
}

/// The least index joined with this one.
fn root(parents: &mut [usize], mut index: usize) -> usize {
    while parents[index] != index {
        parents[index] = parents[parents[index]];
        index = parents[index];
    }
    index
}
