//! Logarithmic axes, with a lane of its own for zero, which no logarithm has.

/// A logarithmic axis from 0 to 1; with a lane, zeros lie at its foot, and the logarithm above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogAxis {
    /// Least and greatest value of the logarithmic part, both positive.
    low: f64,
    high: f64,
    /// Share of the axis that zeros have.
    lane: f64,
}

/// Room beyond the outermost values: a twentieth of the axis.
const MARGIN: f64 = 0.05;

/// The least ratio of the two ends: values that are nearly alike are to look so.
const LEAST_RATIO: f64 = 4.0;

/// Up to so many decades, marks at 2 and 5 are labelled as well.
const FEW_DECADES: f64 = 3.0;

impl LogAxis {
    /// An axis that shows all values; those that are not positive and finite belong to the lane.
    #[must_use]
    pub fn over(values: impl IntoIterator<Item = f64>) -> Self {
        let positive = values.into_iter().filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = positive
            .fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low > high { (1.0, 10.0) } else { (low, high) };
        let widen = (LEAST_RATIO / (high / low)).max(1.0).sqrt();
        let (low, high) = (low / widen, high * widen);
        let margin = (high / low).powf(MARGIN);
        Self { low: low / margin, high: high * margin, lane: 0.0 }
    }

    /// The same axis above a lane for zeros that takes this share of it.
    #[must_use]
    pub fn with_lane(self, share: f64) -> Self {
        Self { lane: share, ..self }
    }

    /// The share of the axis that zeros have; none without a lane.
    #[must_use]
    pub fn lane(&self) -> f64 {
        self.lane
    }

    /// Where a value lies, from 0 to 1; zero in the middle of its lane.
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        if value <= 0.0 {
            return 0.5 * self.lane;
        }
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        self.lane + (1.0 - self.lane) * share.clamp(0.0, 1.0)
    }

    /// The values that get a label: powers of ten, and between few of them 2 and 5.
    #[must_use]
    pub fn ticks(&self) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let steps: &[f64] = if decades <= FEW_DECADES { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        (first..=last)
            .flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)))
            .filter(|tick| (self.low..=self.high).contains(tick))
            .collect()
    }
}

/// A number of one or two digits on an axis: 0.05, 200, 10⁶.
#[must_use]
pub fn tick_label(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decade = value.log10().floor() as i32;
    if (-3..=4).contains(&decade) {
        let decimals = (-decade).max(0) as usize;
        return format!("{value:.decimals$}");
    }
    let digit = (value / 10f64.powi(decade)).round();
    let power: String = decade.to_string().chars().map(superscript).collect();
    if digit == 1.0 { format!("10{power}") } else { format!("{digit}·10{power}") }
}

/// Bytes in the unit that fits: 950 B, 1.5 kB, 20 MB.
#[must_use]
pub fn bytes(bytes: f64) -> String {
    let units = ["B", "kB", "MB", "GB"];
    let (mut value, mut unit) = (bytes, 0);
    // 999.5 would be written as 1000.
    while value >= 999.5 && unit + 1 < units.len() {
        (value, unit) = (value / 1000.0, unit + 1);
    }
    let decimals = usize::from(value < 9.95 && value.fract() != 0.0);
    format!("{value:.decimals$} {}", units[unit])
}

fn superscript(character: char) -> char {
    match character {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '-' => '⁻',
        digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ratios_are_equal_distances() {
        let axis = LogAxis::over([0.1, 1.0, 10.0, 1000.0]);
        let [a, b, c] = [0.1, 1.0, 10.0].map(|value| axis.place(value));
        assert!((2.0 * b - a - c).abs() < 1e-12 && a > 0.0 && axis.place(1000.0) < 1.0);
    }

    #[test]
    fn zeros_lie_below_all_else() {
        let axis = LogAxis::over([0.0, 3.0, 300.0]).with_lane(0.3);
        assert!(axis.place(0.0) < 0.3 && axis.place(3.0) > 0.3 && axis.place(300.0) < 1.0);
    }

    #[test]
    fn an_axis_of_one_value_or_none_has_room_and_ticks() {
        for values in [vec![7.0], vec![], vec![0.0, f64::NAN, f64::INFINITY]] {
            let axis = LogAxis::over(values.iter().copied());
            assert!(axis.ticks().len() > 1, "{values:?}: {axis:?}");
            let place = axis.place(7.0);
            assert!(place > 0.0 && place < 1.0, "{values:?}: {place}");
        }
    }

    #[test]
    fn ticks_are_within_the_axis_and_few() {
        for high in [2.0, 30.0, 1e3, 1e6] {
            let ticks = LogAxis::over([1.0, high]).ticks();
            assert!((2..=10).contains(&ticks.len()), "{high}: {ticks:?}");
        }
    }

    #[test]
    fn bytes_are_told_in_the_unit_that_fits() {
        let told = [0.0, 999.0, 1000.0, 1536.0, 20e6, 999_600.0, 5e13].map(bytes);
        assert_eq!(told, ["0 B", "999 B", "1 kB", "1.5 kB", "20 MB", "1.0 MB", "50000 GB"]);
    }

    #[test]
    fn labels_are_short() {
        let values = [0.0, 0.002, 0.05, 1.0, 20.0, 50000.0, 1e5, 2e6, 1e-7];
        let labels = ["0", "0.002", "0.05", "1", "20", "50000", "10⁵", "2·10⁶", "10⁻⁷"];
        assert_eq!(values.map(tick_label), labels);
    }
}
