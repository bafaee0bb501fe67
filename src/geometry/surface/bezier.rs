//! Cubic Bézier curves, and sheets of bicubic Bézier patches: open ones, and closed bodies.

use std::ops::{Add, Mul, Sub};

use glam::{DVec2, DVec3};

use super::{SecondDerivatives, Surface, Topology};

/// What control points are: places in the plane or in space.
pub trait Point: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {}

impl Point for DVec2 {}
impl Point for DVec3 {}

/// A cubic Bézier curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic<P>(pub [P; 4]);

impl<P: Point> Cubic<P> {
    /// The straight line from `a` to `b`, at constant speed.
    #[must_use]
    pub fn line(a: P, b: P) -> Self {
        Self([a, blend(a, b, 1.0 / 3.0), blend(a, b, 2.0 / 3.0), b])
    }

    /// The point at `t`; exactly an end point at 0 and 1.
    #[must_use]
    pub fn point(&self, t: f64) -> P {
        self.polar(t, t, t)
    }

    /// The derivative at `t`.
    #[must_use]
    pub fn derivative(&self, t: f64) -> P {
        let [a, b, c] = self.differences();
        blend(blend(a, b, t), blend(b, c, t), t)
    }

    /// Control points of the derivative.
    #[must_use]
    pub fn differences(&self) -> [P; 3] {
        [0, 1, 2].map(|i| (self.0[i + 1] - self.0[i]) * 3.0)
    }

    /// Control points of the second derivative.
    #[must_use]
    pub fn second_differences(&self) -> [P; 2] {
        let first = self.differences();
        [0, 1].map(|i| (first[i + 1] - first[i]) * 2.0)
    }

    /// The part of the curve from `from` to `to`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let (start, end) = (self.polar(from, from, from), self.polar(to, to, to));
        Self([start, self.polar(from, from, to), self.polar(from, to, to), end])
    }

    /// The polar form: the algorithm of de Casteljau with a parameter of its own for every step.
    fn polar(&self, r: f64, s: f64, t: f64) -> P {
        let [a, b, c, d] = self.0;
        let (ab, bc, cd) = (blend(a, b, r), blend(b, c, r), blend(c, d, r));
        blend(blend(ab, bc, s), blend(bc, cd, s), t)
    }
}

/// Between `a` at 0 and `b` at 1, both met exactly.
fn blend<P: Point>(a: P, b: P, t: f64) -> P {
    a * (1.0 - t) + b * t
}

/// A smooth curve of cubic Bézier pieces, all of equal length in its parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Path<P> {
    pieces: Vec<Cubic<P>>,
}

impl<P: Point> Path<P> {
    /// The smooth curve through the points (Catmull & Rom 1974): its tangents are half the
    /// difference of the neighbours. `before` and `after` are those of the ends, if they have any.
    ///
    /// # Panics
    /// With fewer than two points.
    #[must_use]
    pub fn through(points: &[P], before: Option<P>, after: Option<P>) -> Self {
        assert!(points.len() > 1, "a path needs two points");
        let last = points.len() - 1;
        let tangent = |i: usize| match (i, before, after) {
            (0, None, _) => points[1] - points[0],
            (0, Some(before), _) => (points[1] - before) * 0.5,
            (_, _, None) if i == last => points[last] - points[last - 1],
            (_, _, Some(after)) if i == last => (after - points[last - 1]) * 0.5,
            _ => (points[i + 1] - points[i - 1]) * 0.5,
        };
        let pieces = (0..last).map(|i| {
            let (a, b) = (points[i], points[i + 1]);
            Cubic([a, a + tangent(i) * (1.0 / 3.0), b - tangent(i + 1) * (1.0 / 3.0), b])
        });
        Self { pieces: pieces.collect() }
    }

    /// The straight line from `a` to `b`.
    #[must_use]
    pub fn line(a: P, b: P) -> Self {
        Self { pieces: vec![Cubic::line(a, b)] }
    }

    /// The pieces.
    #[must_use]
    pub fn pieces(&self) -> &[Cubic<P>] {
        &self.pieces
    }

    /// The point at `t` from 0 to 1.
    #[must_use]
    pub fn point(&self, t: f64) -> P {
        let (index, place) = piece(t, self.pieces.len());
        self.pieces[index].point(place)
    }

    /// The derivative at `t`.
    #[must_use]
    pub fn derivative(&self, t: f64) -> P {
        let (index, place) = piece(t, self.pieces.len());
        self.pieces[index].derivative(place) * self.pieces.len() as f64
    }

    /// All control points, one row.
    fn controls(&self) -> Vec<P> {
        let first = self.pieces[0].0[0];
        [first].into_iter().chain(self.pieces.iter().flat_map(|p| p.0[1..].to_vec())).collect()
    }
}

/// The piece of `count` equal ones that holds `t`, and the place of `t` in it.
fn piece(t: f64, count: usize) -> (usize, f64) {
    let scaled = t * count as f64;
    let index = (scaled.max(0.0) as usize).min(count - 1);
    (index, scaled - index as f64)
}

/// Whether rows are equally long.
fn are_alike(rows: &[Vec<DVec3>]) -> bool {
    rows.iter().all(|row| row.len() == rows[0].len())
}

/// How far from a pole of a body its normal is taken.
const BESIDE_POLE: f64 = 1e-5;

/// Bicubic Bézier patches that pass smoothly through a grid of given points, as a [`Path`] does
/// through a row of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Control points, `3·patches + 1` each way, u running fastest.
    control: Vec<DVec3>,
    /// Patches in u and v.
    patches: (usize, usize),
    /// Closed around u, with a pole at both ends of v.
    is_body: bool,
}

impl Sheet {
    /// The sheet through rows of points of equal length: u along a row, v from row to row.
    ///
    /// # Panics
    /// With fewer than two rows or columns, or rows that differ in length.
    #[must_use]
    pub fn through(rows: &[Vec<DVec3>]) -> Self {
        assert!(rows.len() > 1 && rows[0].len() > 1, "a sheet needs two rows and two columns");
        assert!(are_alike(rows), "rows of a sheet are equally long");
        let rows: Vec<_> =
            rows.iter().map(|row| Path::through(row, None, None).controls()).collect();
        Self::along_columns(&rows, false)
    }

    /// The closed body around `loops`, rounded off at a first and a last point. The loops run
    /// counter-clockwise as seen from the last point and have an even number of points each.
    ///
    /// # Panics
    /// Without a loop, with an odd or an empty one, or with loops that differ in length.
    #[must_use]
    pub fn body(first: DVec3, loops: &[Vec<DVec3>], last: DVec3) -> Self {
        let points = loops[0].len();
        assert!(
            points > 0 && points.is_multiple_of(2),
            "every point of a loop needs an opposite one"
        );
        assert!(are_alike(loops), "loops of a body are equally long");
        let controls = 3 * points + 1;
        let mut rows = vec![vec![first; controls]];
        for around in loops {
            let mut around = around.clone();
            around.push(around[0]);
            let (before, after) = (Some(around[points - 1]), Some(around[1]));
            rows.push(Path::through(&around, before, after).controls());
        }
        rows.push(vec![last; controls]);
        Self::along_columns(&rows, true)
    }

    /// The sheet whose control rows are given at the ends of patches only.
    fn along_columns(rows: &[Vec<DVec3>], is_body: bool) -> Self {
        let (width, height) = (rows[0].len(), 3 * (rows.len() - 1) + 1);
        let mut control = vec![DVec3::ZERO; width * height];
        for u in 0..width {
            let column: Vec<_> = rows.iter().map(|row| row[u]).collect();
            // Over a pole a column goes on as the opposite one, so the pole is round, not a tip.
            let opposite = (u + (width - 1) / 2) % (width - 1);
            let beyond = |row: usize| is_body.then(|| rows[row][opposite]);
            let smooth = Path::through(&column, beyond(1), beyond(rows.len() - 2)).controls();
            for (v, point) in smooth.into_iter().enumerate() {
                control[v * width + u] = point;
            }
        }
        Self { control, patches: ((width - 1) / 3, rows.len() - 1), is_body }
    }

    /// The patch that holds (u, v), as rows of control points, and the place inside it.
    fn patch(&self, u: f64, v: f64) -> ([Cubic<DVec3>; 4], f64, f64) {
        let (column, u) = piece(u, self.patches.0);
        let (row, v) = piece(v, self.patches.1);
        (self.controls(column, row), u, v)
    }

    fn controls(&self, column: usize, row: usize) -> [Cubic<DVec3>; 4] {
        let width = 3 * self.patches.0 + 1;
        [0, 1, 2, 3].map(|j| {
            Cubic([0, 1, 2, 3].map(|i| self.control[(3 * row + j) * width + 3 * column + i]))
        })
    }

    /// Both derivatives at (u, v), up to the number of patches.
    fn tangents(&self, u: f64, v: f64) -> (DVec3, DVec3) {
        let (rows, u, v) = self.patch(u, v);
        (
            Cubic(rows.map(|row| row.derivative(u))).point(v),
            Cubic(rows.map(|row| row.point(u))).derivative(v),
        )
    }
}

impl Surface for Sheet {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        let (rows, u, v) = self.patch(u, v);
        Cubic(rows.map(|row| row.point(u))).point(v)
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        // At a pole ∂u is zero: the normal a little beside it is the limit to many digits.
        let v = if self.is_body { v.clamp(BESIDE_POLE, 1.0 - BESIDE_POLE) } else { v };
        let (along_u, along_v) = self.tangents(u, v);
        along_u.cross(along_v).normalize()
    }

    fn second_derivatives(&self) -> SecondDerivatives {
        let (across, along) = (self.patches.0 as f64, self.patches.1 as f64);
        let mut bounds = SecondDerivatives::default();
        for row in 0..self.patches.1 {
            for column in 0..self.patches.0 {
                let rows = self.controls(column, row);
                let columns = [0, 1, 2, 3].map(|i| Cubic(rows.map(|row| row.0[i])));
                let longest = |cubics: &[Cubic<DVec3>]| {
                    cubics
                        .iter()
                        .flat_map(Cubic::second_differences)
                        .map(DVec3::length)
                        .fold(0.0, f64::max)
                };
                let slopes = rows.map(|row| row.differences());
                let twist = [0, 1, 2]
                    .into_iter()
                    .flat_map(|i| Cubic(slopes.map(|slope| slope[i])).differences())
                    .map(DVec3::length)
                    .fold(0.0, f64::max);
                bounds.uu = bounds.uu.max(longest(&rows) * across * across);
                bounds.uv = bounds.uv.max(twist * across * along);
                bounds.vv = bounds.vv.max(longest(&columns) * along * along);
            }
        }
        bounds
    }

    fn topology(&self) -> Topology {
        let closed = self.is_body;
        Topology { closed_u: closed, pole_at_start: closed, pole_at_end: closed }
    }
}
