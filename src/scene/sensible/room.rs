//! Rooms: scenes whose box has walls.

use glam::{DVec3, Vec3};

use crate::geometry::Bounds;
use crate::scene::{Camera, Light, Scene};

/// A wall lies within so much of the extent of its side.
const NEAR: f64 = 0.05;
/// And is turned by less than about ten degrees: the cosine of that.
const PARALLEL: f64 = 0.985;
/// A side of which less than this share is covered is open.
const OPEN: f64 = 0.1;
/// One of which more is has a wall.
const WALLED: f64 = 0.8;
/// Walls of which so many times more look outwards than inwards are those of a solid.
const SOLID: f64 = 2.0;
/// Vertical field of view within a room, in degrees.
const FIELD_OF_VIEW: f64 = 65.0;
/// Where eyes and lamps are, as shares of the way from the middle of a room to its walls.
const TOWARDS_CORNER: f64 = 0.85;
const EYE_HEIGHT: f64 = 0.4;
const LAMP_HEIGHT: f64 = 0.8;

/// What stands along the sides of a scene's box.
pub(super) struct Walls {
    bounds: Bounds,
    /// How much of each side is covered by triangles that lie along it, as a share.
    covered: [(DVec3, f64); 6],
    /// Share of all sides that walls cover with their front, seen from within; and seen from outside.
    inwards: f64,
    outwards: f64,
    /// Whether anything else is between them.
    is_furnished: bool,
}

impl Walls {
    pub fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        let extent = bounds.extent().as_dvec3();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut covered =
            [0, 1, 2, 3, 4, 5].map(|i| (if i % 2 == 0 { axes[i / 2] } else { -axes[i / 2] }, 0.0));
        let (mut inwards, mut outwards, mut is_furnished) = (0.0, 0.0, false);
        for (id, _) in (0..).zip(scene.triangles.corners()) {
            let corners = scene.triangles.get(id).map(|corner| corner.as_dvec3());
            let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let mut is_beside = false;
            for (side, covered) in &mut covered {
                if !lies_along(*side, &corners, &bounds) {
                    continue;
                }
                is_beside = true;
                let seen = area.dot(*side);
                if seen.abs() > PARALLEL * area.length() {
                    let share =
                        seen.abs() / (extent.x * extent.y * extent.z / extent.dot(side.abs()));
                    *covered += share;
                    *if seen > 0.0 { &mut outwards } else { &mut inwards } += share;
                }
            }
            is_furnished |= !is_beside;
        }
        Self { bounds, covered, inwards, outwards, is_furnished }
    }

    /// The one side of the box that has no wall while the other five have.
    pub fn open_side(&self) -> Option<DVec3> {
        let mut open = None;
        for (side, covered) in self.covered {
            if covered < OPEN {
                if open.replace(side).is_some() {
                    return None;
                }
            } else if covered < WALLED {
                return None;
            }
        }
        open
    }

    /// Whether there are walls on all sides, and something within that is seen from there only.
    pub fn close_a_room(&self) -> bool {
        let is_closed = self.covered.iter().all(|&(_, covered)| covered >= WALLED);
        is_closed && self.is_furnished && !self.are_of_a_solid()
    }

    /// Those of a solid, of whose inside there may be anything, look outwards.
    fn are_of_a_solid(&self) -> bool {
        self.outwards > SOLID * self.inwards
    }

    /// Whether one looks from there into a room through the side that has no wall, which is beside it and not above.
    fn show_a_room(&self, camera: &Camera) -> bool {
        let is_before = |side: DVec3| {
            side != self.nearest_side(camera.up)
                && (camera.position - self.bounds.centre()).dot(side) > 0.0
        };
        self.open_side().is_some_and(is_before) && !self.are_of_a_solid()
    }

    /// Whether a point lies between them.
    fn hold(&self, point: DVec3) -> bool {
        (point - self.bounds.centre()).abs().cmplt(0.5 * self.bounds.extent().as_dvec3()).all()
    }

    /// The side that a direction points to most.
    fn nearest_side(&self, direction: DVec3) -> DVec3 {
        let sides = self.covered.iter().map(|&(side, _)| side);
        let nearest = sides.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
        nearest.unwrap_or(DVec3::Y)
    }

    /// Looks at the middle from that corner which is farthest from all that stands in the room.
    pub fn corner_view(&self, scene: &Scene, up: DVec3) -> Camera {
        let centre = self.bounds.centre();
        let half = 0.5 * self.bounds.extent().as_dvec3();
        let ceiling = self.nearest_side(up);
        let across = ceiling.any_orthonormal_vector();
        let along = ceiling.cross(across);
        let place = |(a, b): (f64, f64)| {
            centre + half * (TOWARDS_CORNER * (a * across + b * along) + EYE_HEIGHT * ceiling)
        };
        let places = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(place);
        let mut space = [f64::INFINITY; 4];
        for (id, _) in (0..).zip(scene.triangles.corners()) {
            let corners = scene.triangles.get(id).map(|corner| corner.as_dvec3());
            if self.covered.iter().any(|(side, _)| lies_along(*side, &corners, &self.bounds)) {
                continue;
            }
            let around = scene.triangles.bounds_of(id);
            for (space, place) in space.iter_mut().zip(places) {
                *space = space.min(distance(&around, place));
            }
        }
        let farthest =
            (1..4).fold(0, |best, next| if space[next] > space[best] { next } else { best });
        Camera::look_at(places[farthest], centre, up, FIELD_OF_VIEW.to_radians())
    }

    /// For a camera in a closed room, or before an open one: a lamp under the ceiling that gives the floor beneath it this
    /// irradiance.
    pub fn lamp_for(&self, camera: &Camera, irradiance: Vec3) -> Option<Light> {
        let is_within = self.close_a_room() && self.hold(camera.position);
        if !is_within && !self.show_a_room(camera) {
            return None;
        }
        let up = self.nearest_side(camera.up);
        let half = 0.5 * self.bounds.extent().as_dvec3().dot(up.abs());
        let height = (1.0 + LAMP_HEIGHT) * half;
        Some(Light::Point {
            position: self.bounds.centre() + LAMP_HEIGHT * half * up,
            intensity: irradiance * (height * height) as f32,
        })
    }
}

/// Whether a triangle is part of what stands along a side.
fn lies_along(side: DVec3, corners: &[DVec3; 3], bounds: &Bounds) -> bool {
    let from = (0.5 - NEAR) * bounds.extent().as_dvec3().dot(side.abs());
    corners.iter().all(|corner| from <= (*corner - bounds.centre()).dot(side))
}

/// From a box to a point outside of it; 0 within.
fn distance(around: &Bounds, point: DVec3) -> f64 {
    let (min, max) = (around.min.as_dvec3(), around.max.as_dvec3());
    point.distance(point.clamp(min, max))
}
