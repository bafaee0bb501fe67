//! Which part of a face of the view a cluster covers.
//!
//! Conservative: whatever comes within the view's `pad` of one of the cluster's triangles is covered. A small
//! cluster is its rectangle; of a large one each triangle is clipped to the face and drawn row by row.

use glam::{DVec2, DVec3, Vec3};

use super::view::{LightView, SLACK, View};
use crate::occlusion::{Cluster, WIDTH};

/// A square part of a face, divided into `cells` × `cells` cells of [`FINE`] × [`FINE`] fine ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub face: usize,
    /// Its corner with the least `u` and `v`, and its side.
    pub low: [f32; 2],
    pub side: f32,
    pub cells: usize,
}

/// Fine cells along the side of a cell: their 16 bits say where in the cell a cluster may be met.
pub(super) const FINE: usize = 4;

/// A rectangle of more cells than this, both ways, is drawn triangle by triangle.
const COARSE: usize = 2;

/// Steeper than this, corners are clipped before they are divided by their depth.
const STEEP: f32 = 8.0;

impl Window {
    fn fine(&self) -> usize {
        self.cells * FINE
    }

    /// Fine cells to a unit of u and v.
    fn scale(&self) -> f32 {
        self.fine() as f32 / self.side
    }

    /// Columns (axis 0) or rows (axis 1) of fine cells from `low` to `high` in u or v; `None` outside.
    fn range(&self, axis: usize, low: f32, high: f32) -> Option<(usize, usize)> {
        let place = |value: f32| (value - self.low[axis]) * self.scale();
        let (low, high) = (place(low - SLACK), place(high + SLACK));
        let most = self.fine() as f32;
        // Written so that NaN counts as everything.
        if high < 0.0 || low > most {
            return None;
        }
        // One fine cell's 2⁻⁸ more than the rounding of `place` here and in a query.
        const ROUNDING: f32 = 1.0 / 256.0;
        let first = if low > 0.0 { (low - ROUNDING).max(0.0) as usize } else { 0 };
        let last = if high < most { (high + ROUNDING) as usize } else { self.fine() - 1 };
        Some((first.min(self.fine() - 1), last.min(self.fine() - 1)))
    }
}

/// Cells of a window, each with the bits of its fine ones.
pub(super) type Covered = Vec<(u16, u16)>;

/// Adds the cells that the cluster covers; gives the least depth at which it does. Lowers the depths in `full`
/// behind which a cell is dark, where one of the triangles covers a whole cell.
pub(super) fn cover(
    view: &LightView,
    window: &Window,
    cluster: &Cluster,
    covered: &mut Covered,
    full: &mut [f32],
) -> Option<f32> {
    match rectangle(view, window, cluster) {
        Rectangle::Outside => None,
        Rectangle::Inside { columns, rows, depth } => {
            let cells = |(first, last): (usize, usize)| last / FINE - first / FINE;
            if cells(columns) > COARSE && cells(rows) > COARSE {
                return draw(view, window, cluster, covered, full);
            }
            for row in rows.0 / FINE..=rows.1 / FINE {
                let vertical = bits_within(rows, row) as u16;
                for column in columns.0 / FINE..=columns.1 / FINE {
                    let horizontal = bits_within(columns, column) as u16;
                    let mask = spread(vertical) * horizontal;
                    covered.push(((row * window.cells + column) as u16, mask));
                }
            }
            Some(depth)
        }
        Rectangle::Steep => draw(view, window, cluster, covered, full),
    }
}

/// Bits of the fine columns or rows of a cell that lie in a range.
fn bits_within((first, last): (usize, usize), cell: usize) -> u8 {
    let start = first.max(cell * FINE) - cell * FINE;
    let end = last.min(cell * FINE + FINE - 1) - cell * FINE;
    ((1 << (end + 1)) - (1 << start)) as u8
}

/// Bit `i` of four to bit `4 i` of sixteen.
fn spread(rows: u16) -> u16 {
    (rows & 1) | (rows & 2) << 3 | (rows & 4) << 6 | (rows & 8) << 9
}

enum Rectangle {
    Outside,
    /// Fine columns and rows.
    Inside {
        columns: (usize, usize),
        rows: (usize, usize),
        depth: f32,
    },
    /// Not to be had without clipping.
    Steep,
}

/// The rectangle around all corners.
fn rectangle(view: &LightView, window: &Window, cluster: &Cluster) -> Rectangle {
    let reach = 3.0 * view.pad;
    let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    let (mut depth, mut steep) = (f32::INFINITY, false);
    for corner in 0..3 {
        let [x, y, z] = cluster.corner(corner);
        for lane in 0..WIDTH {
            let place = view.across(window.face, Vec3::new(x[lane], y[lane], z[lane]));
            let inverse = match view.view {
                View::Cube { .. } => {
                    steep |= !(place.z >= view.near
                        && place.x.abs().max(place.y.abs()) <= STEEP * place.z);
                    place.z.recip()
                }
                View::Parallel { half, .. } => half.recip(),
            };
            for axis in 0..2 {
                low[axis] = low[axis].min((place[axis] - reach) * inverse);
                high[axis] = high[axis].max((place[axis] + reach) * inverse);
            }
            depth = depth.min(place.z);
        }
    }
    if steep {
        return Rectangle::Steep;
    }
    let ranges = (window.range(0, low[0], high[0]), window.range(1, low[1], high[1]));
    match ranges {
        (Some(columns), Some(rows)) => Rectangle::Inside { columns, rows, depth: depth - view.pad },
        _ => Rectangle::Outside,
    }
}

/// Draws the cluster triangle by triangle.
fn draw(
    view: &LightView,
    window: &Window,
    cluster: &Cluster,
    covered: &mut Covered,
    full: &mut [f32],
) -> Option<f32> {
    let fine = window.fine();
    // A bit a fine cell, row by row: at most 256 rows of 256.
    let mut bits = vec![[0u64; 4]; fine];
    let mut depth = f32::INFINITY;
    for lane in 0..WIDTH {
        if lane > 0 && cluster.ids()[lane] == cluster.ids()[lane - 1] {
            continue;
        }
        let corners = [0, 1, 2].map(|corner| {
            let [x, y, z] = cluster.corner(corner);
            view.across(window.face, Vec3::new(x[lane], y[lane], z[lane])).as_dvec3()
        });
        darken(view, window, &corners, full);
        let polygon = clip(view, window, &corners);
        depth = polygon.iter().fold(depth, |depth, corner| depth.min(corner.z as f32));
        rows(view, window, &polygon, &mut bits);
    }
    let before = covered.len();
    for row in 0..window.cells {
        let lines = &bits[row * FINE..(row + 1) * FINE];
        for column in 0..window.cells {
            let shift = column * FINE;
            let mask = (0..FINE).fold(0u16, |mask, line| {
                mask | ((lines[line][shift / 64] >> (shift % 64)) as u16 & 15) << (4 * line)
            });
            if mask != 0 {
                covered.push(((row * window.cells + column) as u16, mask));
            }
        }
    }
    (covered.len() > before).then_some(depth - view.pad)
}

/// Notes where one triangle covers whole cells, widened by all that a query's place and ray may err by: whoever is
/// behind it there, by more than the padding, is in its shadow. It must lie beyond `near` as a whole.
fn darken(view: &LightView, window: &Window, corners: &[DVec3; 3], full: &mut [f32]) {
    let pad = f64::from(view.pad);
    let nearest = corners.iter().fold(f64::INFINITY, |least, corner| least.min(corner.z));
    let (divisors, reach) = match view.view {
        View::Cube { .. } if nearest < f64::from(view.near) => return,
        View::Cube { .. } => (corners.map(|corner| corner.z), 3.0 * pad / nearest),
        View::Parallel { half, .. } => ([f64::from(half); 3], 3.0 * pad / f64::from(half)),
    };
    let [a, b, c] = [0, 1, 2].map(|i| corners[i].truncate() / divisors[i]);
    // Inside, all three edges have the sign of the area.
    let area = (b - a).perp_dot(c - a);
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let height = normal.dot(corners[0]);
    let depth = |place: DVec2| match view.view {
        View::Cube { .. } => height / normal.dot(place.extend(1.0)),
        View::Parallel { half, .. } => {
            let across = f64::from(half) * place;
            (height - normal.truncate().dot(across)) / normal.z
        }
    };
    let side = f64::from(window.side) / window.cells as f64;
    // As much as in `Window::range`, twice.
    let margin = reach + f64::from(SLACK) + side / FINE as f64 / 128.0;
    let low = DVec2::new(f64::from(window.low[0]), f64::from(window.low[1]));
    let cells = |least: f64, most: f64| {
        let last = window.cells as f64;
        let first = ((least / side).ceil().clamp(0.0, last)) as usize;
        first..((most / side).floor().clamp(0.0, last) as usize).max(first)
    };
    let (least, most) = (a.min(b).min(c) - low, a.max(b).max(c) - low);
    for row in cells(least.y, most.y) {
        for column in cells(least.x, most.x) {
            let middle = low + side * DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let half = 0.5 * side + margin;
            let inside = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| {
                let edge = (to - from) * area.signum();
                let lever = (edge.x.abs() + edge.y.abs()) * half;
                edge.perp_dot(middle - from) > lever * (1.0 + 1e-9) + f64::MIN_POSITIVE
            });
            if !inside {
                continue;
            }
            let corners = [(-half, -half), (-half, half), (half, -half), (half, half)];
            let farthest = corners.iter().fold(0f64, |farthest, &(x, y)| {
                let depth = depth(middle + DVec2::new(x, y));
                if depth > 0.0 { farthest.max(depth) } else { f64::INFINITY }
            });
            let dark = (farthest + 4.0 * pad) as f32;
            let full = &mut full[row * window.cells + column];
            *full = full.min(dark);
        }
    }
}

/// Clips a triangle to the pyramid that the window sees, a little enlarged.
fn clip(view: &LightView, window: &Window, corners: &[DVec3; 3]) -> Vec<DVec3> {
    let mut polygon = corners.to_vec();
    let pad = f64::from(view.pad);
    if let View::Cube { .. } = view.view {
        // In front, at half of what counts as near, so that the padding of what is left is bounded.
        cut(&mut polygon, |p| p.z - 0.5 * f64::from(view.near));
        for axis in 0..2 {
            let low = f64::from(window.low[axis] - SLACK);
            let high = f64::from(window.low[axis] + window.side + SLACK);
            cut(&mut polygon, |p| p[axis] - low * p.z + 4.0 * pad);
            cut(&mut polygon, |p| high * p.z - p[axis] + 4.0 * pad);
        }
    }
    polygon
}

/// Sutherland and Hodgman 1974: keeps the part of a polygon where `inside` is not negative.
fn cut(polygon: &mut Vec<DVec3>, inside: impl Fn(&DVec3) -> f64) {
    let whole = std::mem::take(polygon);
    for (index, from) in whole.iter().enumerate() {
        let to = &whole[(index + 1) % whole.len()];
        let (a, b) = (inside(from), inside(to));
        if a >= 0.0 {
            polygon.push(*from);
        }
        if (a < 0.0) != (b < 0.0) {
            polygon.push(*from + (*to - *from) * (a / (a - b)));
        }
    }
}

/// Sets the bits of the fine cells that come within the padding of a convex polygon.
fn rows(view: &LightView, window: &Window, polygon: &[DVec3], bits: &mut [[u64; 4]]) {
    if polygon.is_empty() {
        return;
    }
    let reach = 3.0 * f64::from(view.pad);
    let scale = f64::from(window.scale());
    let mut margin = 0f64;
    let places: Vec<[f64; 2]> = polygon
        .iter()
        .map(|corner| {
            let inverse = match view.view {
                View::Cube { .. } => corner.z.recip(),
                View::Parallel { half, .. } => f64::from(half).recip(),
            };
            margin = margin.max(reach * inverse);
            [0, 1].map(|axis| (corner[axis] * inverse - f64::from(window.low[axis])) * scale)
        })
        .collect();
    // And what a query's place errs by: see `Window::range`.
    let margin = (margin + f64::from(SLACK)) * scale + 1.0 / 256.0;
    let fine = window.fine();
    let (low, high) = places
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[1]), high.max(p[1])));
    let first = (low - margin).floor().clamp(0.0, fine as f64) as usize;
    let last = (high + margin).floor().clamp(-1.0, (fine - 1) as f64) as isize;
    for row in first as isize..=last {
        let band = (row as f64 - margin, (row + 1) as f64 + margin);
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (index, a) in places.iter().enumerate() {
            let b = &places[(index + 1) % places.len()];
            if let Some((one, other)) = within_band(a, b, band) {
                from = from.min(one.min(other));
                to = to.max(one.max(other));
            }
        }
        let (from, to) = ((from - margin).floor(), (to + margin).floor());
        if to < 0.0 || from >= fine as f64 || from > to {
            continue;
        }
        let (from, to) = (from.max(0.0) as usize, (to as usize).min(fine - 1));
        for column in from..=to {
            bits[row as usize][column / 64] |= 1 << (column % 64);
        }
    }
}

/// The u at both ends of the part of an edge that lies in a band of v.
fn within_band(a: &[f64; 2], b: &[f64; 2], (low, high): (f64, f64)) -> Option<(f64, f64)> {
    if a[1].max(b[1]) < low || a[1].min(b[1]) > high {
        return None;
    }
    let at = |v: f64| {
        let share = (v - a[1]) / (b[1] - a[1]);
        if share.is_finite() { a[0] + share.clamp(0.0, 1.0) * (b[0] - a[0]) } else { a[0] }
    };
    let level = a[1] == b[1];
    let one = if level || (low..=high).contains(&a[1]) {
        a[0]
    } else {
        at(if a[1] < low { low } else { high })
    };
    let other = if level || (low..=high).contains(&b[1]) {
        b[0]
    } else {
        at(if b[1] < low { low } else { high })
    };
    Some((one, other))
}
