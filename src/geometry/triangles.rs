//! Triangles as every engine stores them.

use glam::{Vec3, Vec3A};

use super::Bounds;
use super::intersect::vicinity;

/// Index of a triangle in [`Triangles`].
pub type TriangleId = u32;

/// No triangle has this id: there are never more than [`u32::MAX`].
pub(crate) const NOBODY: TriangleId = TriangleId::MAX;

/// The three corners of one triangle.
pub type Triangle = [Vec3; 3];

/// Whether no corner is infinite or NaN. Triangles that are not finite block nothing.
#[must_use]
pub fn is_finite(triangle: &Triangle) -> bool {
    triangle.iter().all(|corner| corner.is_finite())
}

/// The triangles of a scene, opaque ones first.
///
/// 48 bytes a triangle: three corners, each padded to 16 bytes so that it loads as one vector.
/// Because the opaque triangles come first, "is this occluder opaque" is one comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    corners: Vec<[Vec3A; 3]>,
    opaque: u32,
    finite: usize,
    bounds: Option<Bounds>,
    slack: f64,
}

impl Triangles {
    /// Stores `opaque` triangles, followed by `transparent` ones.
    ///
    /// # Panics
    /// With more than `u32::MAX` triangles: the loaders refuse such files before.
    #[must_use]
    pub fn new(
        opaque: impl IntoIterator<Item = Triangle>,
        transparent: impl IntoIterator<Item = Triangle>,
    ) -> Self {
        let pad = |triangle: Triangle| triangle.map(Vec3A::from);
        let mut corners: Vec<_> = opaque.into_iter().map(pad).collect();
        let count = |n: usize| u32::try_from(n).expect("triangle count fits u32");
        let opaque = count(corners.len());
        corners.extend(transparent.into_iter().map(pad));
        count(corners.len());
        let (finite, bounds) = finite(&corners);
        let slack = vicinity::slack(bounds.unwrap_or_default().largest_coordinate());
        Self { corners, opaque, finite, bounds, slack }
    }

    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Number of opaque triangles: those with an id below this.
    #[must_use]
    pub fn opaque_count(&self) -> u32 {
        self.opaque
    }

    /// Whether the triangle blocks light entirely.
    #[must_use]
    #[inline]
    pub fn is_opaque(&self, id: TriangleId) -> bool {
        id < self.opaque
    }

    /// The corners of one triangle.
    #[must_use]
    #[inline]
    pub fn get(&self, id: TriangleId) -> Triangle {
        self.corners[id as usize].map(Vec3::from)
    }

    /// The corners of all triangles, padded for vector loads.
    #[must_use]
    #[inline]
    pub fn corners(&self) -> &[[Vec3A; 3]] {
        &self.corners
    }

    /// The box of one triangle.
    #[must_use]
    pub fn bounds_of(&self, id: TriangleId) -> Bounds {
        Bounds::of(self.get(id))
    }

    /// Whether all of them are [finite](is_finite).
    #[must_use]
    pub fn are_finite(&self) -> bool {
        self.finite == self.corners.len()
    }

    /// The box of all triangles that are [finite](is_finite); `None` if there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// How near a ray must come to one of these triangles for a hit by a test that rounds to count: some
    /// roundings of the largest coordinate.
    #[must_use]
    #[inline]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.corners.capacity() * size_of::<[Vec3A; 3]>()
    }
}

impl FromIterator<Triangle> for Triangles {
    /// All opaque.
    fn from_iter<I: IntoIterator<Item = Triangle>>(triangles: I) -> Self {
        Self::new(triangles, [])
    }
}

/// How many triangles are finite, and the box of these.
fn finite(triangles: &[[Vec3A; 3]]) -> (usize, Option<Bounds>) {
    let (mut count, mut min, mut max) = (0, Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for &[a, b, c] in triangles {
        if a.is_finite() && b.is_finite() && c.is_finite() {
            count += 1;
            min = min.min(a).min(b).min(c);
            max = max.max(a).max(b).max(c);
        }
    }
    (count, (count > 0).then(|| Bounds { min: min.into(), max: max.into() }))
}
