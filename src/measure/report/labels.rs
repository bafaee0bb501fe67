//! Where labels go, so that none covers another.

use super::look::RADIUS;

/// A rectangle, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boxed {
    /// Least x.
    pub left: f64,
    /// Greatest x.
    pub right: f64,
    /// Least y.
    pub top: f64,
    /// Greatest y.
    pub bottom: f64,
}

impl Boxed {
    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn is_within(&self, other: &Self) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }
}

/// Labels of one chart.
pub struct Labels {
    area: Boxed,
    marks: Vec<Boxed>,
    placed: Vec<Boxed>,
}

/// From a mark to its ring.
pub const RING: f64 = 4.0;
/// From a mark to its label.
const DISTANCE: f64 = RADIUS + RING + 3.0;
/// Lines away from its mark that a label may be.
const LINES: u32 = 8;
/// Height of a label's letters above and below its baseline.
const ASCENT: f64 = 11.0;
const DESCENT: f64 = 4.0;

/// Width of a text in a proportional face without serifs: its average letter is a little over half its size.
#[must_use]
pub fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * 0.6 * size
}

impl Labels {
    /// None yet, in an area with marks at these places.
    #[must_use]
    pub fn new(area: Boxed, marks: &[(f64, f64)]) -> Self {
        let around = |&(x, y): &(f64, f64)| Boxed {
            left: x - RADIUS,
            right: x + RADIUS,
            top: y - RADIUS,
            bottom: y + RADIUS,
        };
        Self { area, marks: marks.iter().map(around).collect(), placed: Vec::new() }
    }

    /// Where a label of this width for a mark begins; `None` if it would cover another label wherever it was
    /// put, or is wider than the area. It covers marks only where there is no other place, and lies farther
    /// away where there is none beside the mark.
    pub fn put(&mut self, (x, y): (f64, f64), width: f64) -> Option<(f64, f64)> {
        let level = y + 0.5 * (ASCENT - DESCENT);
        let mut candidates = vec![(x + DISTANCE, level), (x - DISTANCE - width, level)];
        for line in 0..LINES {
            let away = DISTANCE + f64::from(line) * (ASCENT + DESCENT);
            for baseline in [y - away - DESCENT, y + away + ASCENT] {
                for left in [x - 0.5 * width, x, x - width] {
                    let left = left.min(self.area.right - width).max(self.area.left);
                    candidates.push((left, baseline));
                }
            }
        }
        let around = |&(x, y): &(f64, f64)| Boxed {
            left: x,
            right: x + width,
            top: y - ASCENT,
            bottom: y + DESCENT,
        };
        let fits = |candidate: &&(f64, f64), over_marks: bool| {
            let label = around(candidate);
            label.is_within(&self.area)
                && !self.placed.iter().any(|other| label.overlaps(other))
                && (over_marks || !self.marks.iter().any(|mark| label.overlaps(mark)))
        };
        let found = candidates
            .iter()
            .find(|candidate| fits(candidate, false))
            .or_else(|| candidates.iter().find(|candidate| fits(candidate, true)))?;
        self.placed.push(around(found));
        Some(*found)
    }

    /// The line from a mark to its label at a place that [`put`](Self::put) gave, where they are apart.
    #[must_use]
    pub fn leader(
        (x, y): (f64, f64),
        (left, baseline): (f64, f64),
        width: f64,
    ) -> Option<[f64; 4]> {
        let (top, bottom) = (baseline - ASCENT, baseline + DESCENT);
        let end = if top > y { top } else { bottom };
        let gap = (end - y).abs();
        let is_level = (top..=bottom).contains(&y);
        let start = y + (RADIUS + RING) * (end - y).signum();
        let is_apart = !is_level && gap > DISTANCE + ASCENT;
        is_apart.then(|| [x, start, x.clamp(left, left + width), end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Boxed = Boxed { left: 0.0, right: 300.0, top: 0.0, bottom: 200.0 };

    #[test]
    fn labels_of_crowded_marks_do_not_overlap() {
        let marks: Vec<(f64, f64)> = (0..30)
            .map(|i| (100.0 + 3.0 * f64::from(i % 6), 90.0 + 3.0 * f64::from(i / 6)))
            .collect();
        let mut labels = Labels::new(AREA, &marks);
        let placed = marks.iter().filter(|mark| labels.put(**mark, 80.0).is_some()).count();
        assert!((2..30).contains(&placed), "{placed}");
        for (index, a) in labels.placed.iter().enumerate() {
            assert!(a.is_within(&AREA));
            assert!(!labels.placed[..index].iter().any(|b| a.overlaps(b)), "{:?}", labels.placed);
        }
    }

    #[test]
    fn a_label_keeps_clear_of_marks_where_it_can() {
        let marks = [(100.0, 100.0), (120.0, 100.0)];
        let mut labels = Labels::new(AREA, &marks);
        let (x, _) = labels.put(marks[0], 60.0).unwrap();
        assert_eq!(x, 100.0 - DISTANCE - 60.0, "to the left, for its neighbour is on the right");
    }

    #[test]
    fn a_label_far_from_its_mark_has_a_leader() {
        let level = Labels::leader((100.0, 100.0), (113.0, 103.5), 60.0);
        let above = Labels::leader((100.0, 100.0), (70.0, 83.0), 60.0);
        assert!(level.is_none() && above.is_none(), "{level:?} {above:?}");
        let far = Labels::leader((100.0, 100.0), (120.0, 40.0), 60.0).unwrap();
        assert_eq!(far, [100.0, 90.0, 120.0, 44.0]);
    }

    #[test]
    fn what_is_wider_than_the_chart_is_not_written() {
        assert_eq!(Labels::new(AREA, &[]).put((150.0, 100.0), 301.0), None);
    }
}
