//! Sheets: triangles that together go right across a shaft, so that no ray passes.
//!
//! Start from a triangle that blocks one ray of the shaft, add the neighbour beyond every edge that
//! comes into the shaft, and so on. It is a sheet if
//! 1. the plane of each of its triangles has the whole voxel on one side and the whole light on the
//!    other,
//! 2. beyond each of its edges that comes into the shaft is exactly one other of its triangles, and
//! 3. those two do not fold over at the edge: seen from the light, they lie on either side of it.
//!
//! *Then every ray of the shaft is blocked.* Turn all triangles to face the light. By 2 and 3, the border
//! of their sum as an oriented surface does not come into the shaft; by 1, the ends of rays do not come
//! onto the surface. So while both ends of a segment move within voxel and light, the number of crossings,
//! each counted by its direction, stays the same. By 1 all directions are the same, so the number is that
//! of crossings; and the first triangle has a ray that crosses its inside, near the one it is known to
//! block. So it is at least 1 for all segments that meet no edge; and those that do are limits of such, and
//! triangles are closed. As no end comes onto a plane, the crossing lies within the open segment.
//!
//! One convex polygon that covers the shaft is the sheet whose edges all stay outside. Open and
//! non-manifold meshes need no care: an edge without exactly one neighbour may not come into the shaft.

use glam::DVec3;

use crate::geometry::TriangleId;
use crate::shadow::voxels::{Facing, Neighbours, Shaft, Voxels, edge};

/// Triangles of a sheet at most: finely tessellated surfaces need larger voxels, not longer proofs.
const MOST_TRIANGLES: usize = 64;

/// Looks for sheets across one shaft.
pub(super) struct Sheets<'a> {
    pub voxels: &'a Voxels,
    pub neighbours: &'a Neighbours,
    pub shaft: &'a Shaft,
}

impl Sheets<'_> {
    /// Whether there is a sheet around a triangle, which blocks a ray of the shaft.
    pub fn covers_from(&self, triangle: TriangleId) -> bool {
        let mut sheet = vec![triangle];
        let mut done = 0;
        while let Some(&id) = sheet.get(done) {
            done += 1;
            let corners = self.voxels.corners(id);
            let Some(facing) = self.shaft.facing(&corners) else { return false };
            for number in 0..3 {
                let (from, to) = edge(&corners, number);
                if !self.shaft.may_meet_edge(from, to) {
                    continue;
                }
                let Some(beyond) = self.neighbours.beyond(id, number) else { return false };
                if !self.goes_on((from, to), facing, beyond) {
                    return false;
                }
                if !sheet.contains(&beyond) {
                    if sheet.len() == MOST_TRIANGLES {
                        return false;
                    }
                    sheet.push(beyond);
                }
            }
        }
        true
    }

    /// Whether a triangle lies on the other side of an edge than the one whose edge it is, which faces
    /// the light like this.
    fn goes_on(&self, (from, to): (DVec3, DVec3), facing: Facing, beyond: TriangleId) -> bool {
        let corners = self.voxels.corners(beyond);
        let Some(other) = self.shaft.facing(&corners) else { return false };
        let opposite = (0..3).any(|number| edge(&corners, number) == (to, from));
        // Turned to face the light alike, the two must run along the edge in opposite directions.
        opposite == (facing == other)
    }
}
