//! Which triangle lies beyond each edge of a mesh.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::{NOBODY, TriangleId, Triangles, is_finite};

/// For each edge of each opaque triangle, the one other triangle that has an edge between the same two
/// points, if it is one. Those that are not finite, which block nothing, are nobody's neighbours.
pub(crate) struct Neighbours(Vec<[TriangleId; 3]>);

/// An edge of a triangle: from its corner of this number (0 to 2) to the next.
#[inline]
pub(crate) fn edge<T: Copy>(corners: &[T; 3], number: usize) -> (T, T) {
    (corners[number], corners[(number + 1) % 3])
}

/// A point by its coordinates; minus zero is zero.
type Point = [u32; 3];

fn point(corner: Vec3) -> Point {
    (corner + 0.0).to_array().map(f32::to_bits)
}

impl Neighbours {
    /// Bytes that they will take.
    pub fn bytes(triangles: &Triangles) -> usize {
        triangles.opaque_count() as usize * size_of::<[TriangleId; 3]>()
    }

    /// Sorts the edges by their ends.
    pub fn new(triangles: &Triangles) -> Self {
        let mut edges: Vec<([Point; 2], TriangleId, u8)> = (0..triangles.opaque_count())
            .into_par_iter()
            .filter(|&id| is_finite(&triangles.get(id)))
            .flat_map_iter(|id| {
                let corners = triangles.get(id).map(point);
                (0..3).map(move |number| {
                    let (from, to) = edge(&corners, number);
                    ([from.min(to), from.max(to)], id, number as u8)
                })
            })
            .collect();
        edges.par_sort_unstable();
        let mut neighbours = vec![[NOBODY; 3]; triangles.opaque_count() as usize];
        for group in edges.chunk_by(|a, b| a.0 == b.0) {
            if let [(ends, first, at_first), (_, second, at_second)] = *group
                && ends[0] != ends[1]
                && first != second
            {
                neighbours[first as usize][usize::from(at_first)] = second;
                neighbours[second as usize][usize::from(at_second)] = first;
            }
        }
        Self(neighbours)
    }

    /// The triangle beyond an edge; `None` at a border, and where more than two triangles meet.
    #[inline]
    pub fn beyond(&self, id: TriangleId, number: usize) -> Option<TriangleId> {
        let neighbour = self.0[id as usize][number];
        (neighbour != NOBODY).then_some(neighbour)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_of_an_edge_are_neighbours_and_three_are_not() {
        let [a, b, c, d, e] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Z];
        let pair = Neighbours::new(&Triangles::from_iter([[a, b, c], [d, b, a]]));
        assert_eq!(pair.beyond(0, 0), Some(1));
        assert_eq!(pair.beyond(1, 1), Some(0));
        assert_eq!((pair.beyond(0, 1), pair.beyond(0, 2)), (None, None));
        let three = Neighbours::new(&Triangles::from_iter([[a, b, c], [d, b, a], [a, b, e]]));
        assert!((0..3).all(|id| (0..3).all(|number| three.beyond(id, number).is_none())));
    }

    #[test]
    fn minus_zero_is_where_zero_is() {
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NEG_Y];
        let mesh = Triangles::from_iter([[a, b, c], [b, Vec3::splat(-0.0), d]]);
        assert_eq!(Neighbours::new(&mesh).beyond(0, 0), Some(1));
    }
}
