//! Where a mesh stands: an affine map in f64, for corners and for normals.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::DraftTriangle;

/// An affine map with what it means for normals and for the order of corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    affine: DAffine3,
    normal_matrix: Option<DMat3>,
    mirrored: bool,
}

impl Placement {
    pub(super) fn new(affine: DAffine3) -> Self {
        let determinant = affine.matrix3.determinant();
        let invertible = determinant.is_finite() && determinant != 0.0;
        Self {
            affine,
            normal_matrix: invertible.then(|| affine.matrix3.inverse().transpose()),
            mirrored: determinant < 0.0,
        }
    }

    /// The triangle in the world. A mirrored one turns its corners round, so that its front stays
    /// in front.
    pub(super) fn place(&self, triangle: &DraftTriangle) -> DraftTriangle {
        Self::place_each(&[*self; 3], triangle)
    }

    /// The triangle in the world, each corner by a map of its own.
    pub(super) fn place_each(each: &[Self; 3], triangle: &DraftTriangle) -> DraftTriangle {
        let mut placed = *triangle;
        for (at, placement) in each.iter().enumerate() {
            placed.corners[at] = placement.affine.transform_point3(triangle.corners[at]);
            placed.normals[at] = placement.normal(triangle.normals[at]);
        }
        if each[0].mirrored {
            placed.corners.swap(1, 2);
            placed.normals.swap(1, 2);
        }
        placed
    }

    /// Unit normals, except that an unturned one keeps its bits and a zero one stays zero.
    fn normal(&self, normal: Vec3) -> Vec3 {
        match self.normal_matrix {
            Some(matrix) if matrix == DMat3::IDENTITY => normal,
            Some(matrix) => (matrix * normal.as_dvec3()).normalize_or(DVec3::ZERO).as_vec3(),
            None => Vec3::ZERO,
        }
    }
}
