//! The shadow polygons of one voxel and light.
//!
//! A polygon comes into the voxel where its edge comes into the shaft of voxel and light. So all that a
//! segment within the voxel may cross are the polygons of those edges, and the triangles that the voxel
//! lists.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use super::crossing::{
    is_in_front, is_lit_from_the_front, passes, through_polygon, through_triangle,
};
use crate::geometry::TriangleId;
use crate::shadow::voxels::{Neighbours, Shaft, Source, Voxels, edge};

/// A voxel with more triangles before it is not prepared, and neither is one with more polygons.
const MOST_TRIANGLES: usize = 1024;
const MOST_POLYGONS: usize = 192;

/// Where in the voxel the known point may be, in shares of its sides: the first that is not on any border.
const REFERENCES: [[f64; 3]; 4] =
    [[0.5, 0.5, 0.5], [0.43, 0.57, 0.39], [0.23, 0.71, 0.83], [0.81, 0.19, 0.33]];

/// What polygons are made of.
pub(super) struct Ground<'a> {
    pub voxels: &'a Voxels,
    pub neighbours: &'a Neighbours,
    pub source: &'a Source,
}

/// A point whose number of volumes is known, and all that may be crossed on the way from it.
pub(super) struct Region {
    reference: DVec3,
    count: i32,
    polygons: Box<[Polygon]>,
    triangles: Box<[(TriangleId, bool)]>,
}

/// The shadow polygon of an edge, and how many volumes lie on its positive side, less those on the other.
struct Polygon {
    from: Vec3,
    to: Vec3,
    weight: i32,
}

impl Region {
    /// In how many volumes a point of the voxel lies; `None` where that is not certain.
    pub fn count_at(&self, point: DVec3, source: &Source, voxels: &Voxels) -> Option<i32> {
        let mut count = self.count;
        for Polygon { from, to, weight } in &self.polygons {
            let (a, b) = (from.as_dvec3(), to.as_dvec3());
            count += weight * through_polygon(a, b, source, self.reference, point)?;
        }
        for &(id, lit_from_the_front) in &self.triangles {
            let corners = voxels.corners(id);
            count += through_triangle(&corners, lit_from_the_front, self.reference, point)?;
        }
        Some(count)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of::<Self>() + size_of_val(&*self.polygons) + size_of_val(&*self.triangles)
    }
}

impl Ground<'_> {
    /// The polygons of a voxel; `None` where they are too many, or where light and voxel are not apart, or
    /// where it is not certain which side of a triangle is lit.
    pub fn prepare(&self, voxel: [u32; 3]) -> Option<Region> {
        let span = self.voxels.span(voxel);
        let shaft = Shaft::new(span, self.source)?;
        let before = self.triangles_in(&shaft)?;
        let mut lit = Vec::with_capacity(before.len());
        for &id in &before {
            lit.push(is_lit_from_the_front(&self.voxels.corners(id), self.source)?);
        }
        let mut polygons = Vec::new();
        for (&id, &front) in before.iter().zip(&lit) {
            self.add_polygons(id, front, &shaft, &mut polygons)?;
        }
        let own = self.voxels.opaque_in(self.voxels.level().index(voxel));
        let triangles = before.iter().copied().zip(lit.iter().copied());
        let triangles: Box<[_]> =
            triangles.filter(|(id, _)| own.binary_search(id).is_ok()).collect();
        let (reference, count) = REFERENCES.into_iter().find_map(|share| {
            let reference = span.low + DVec3::from(share) * (span.high - span.low);
            Some((reference, self.count_from(reference, &before, &lit)?))
        })?;
        Some(Region { reference, count, polygons: polygons.into(), triangles })
    }

    /// The opaque triangles that may come into a shaft, in ascending order.
    fn triangles_in(&self, shaft: &Shaft) -> Option<Vec<TriangleId>> {
        let mut found = Vec::new();
        let all = shaft.voxels(self.voxels.level(), |index| {
            let listed = self.voxels.opaque_in(index).iter().copied();
            found.extend(listed.filter(|&id| shaft.may_meet(&self.voxels.corners(id))));
            if found.len() > MOST_TRIANGLES {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        found.sort_unstable();
        found.dedup();
        all.is_continue().then_some(found)
    }

    /// Adds the polygons of a triangle's edges, those that it shares with a neighbour once.
    fn add_polygons(
        &self,
        id: TriangleId,
        front: bool,
        shaft: &Shaft,
        polygons: &mut Vec<Polygon>,
    ) -> Option<()> {
        let sign = |front: bool| if front { 1 } else { -1 };
        let corners = self.voxels.corners(id);
        for number in 0..3 {
            let (from, to) = edge(&corners, number);
            if !shaft.may_meet_edge(from, to) {
                continue;
            }
            // Seen along its own edge, a triangle lit from the front lies on the positive side.
            let mut weight = sign(front);
            if let Some(neighbour) = self.neighbours.beyond(id, number) {
                if neighbour < id {
                    continue;
                }
                let other = self.voxels.corners(neighbour);
                let same_way = (0..3).any(|number| edge(&other, number) == (from, to));
                let lit = is_lit_from_the_front(&other, self.source)?;
                weight += if same_way { sign(lit) } else { -sign(lit) };
            }
            if weight != 0 {
                if polygons.len() == MOST_POLYGONS {
                    return None;
                }
                polygons.push(Polygon { from: from.as_vec3(), to: to.as_vec3(), weight });
            }
        }
        Some(())
    }

    /// How many of the triangles block every ray from a point; `None` where that is not the same for all.
    fn count_from(&self, point: DVec3, triangles: &[TriangleId], lit: &[bool]) -> Option<i32> {
        let (towards, slack) = self.source.towards(point);
        let mut count = 0;
        for (&id, &front) in triangles.iter().zip(lit) {
            let corners = self.voxels.corners(id);
            if is_in_front(&corners, point)? != front {
                count += i32::from(passes(&corners, point, towards, slack)?);
            }
        }
        Some(count)
    }
}
