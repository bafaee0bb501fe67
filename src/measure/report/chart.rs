//! A chart of marks over two logarithmic axes, as SVG.
//!
//! Marks at zero lie in a lane of their own at the foot of the chart, beside or above one another where they
//! would cover each other: there is only one height that means zero, so height in the lane means nothing.

use super::axis::LogAxis;
use super::labels::{Boxed, Labels, RING, text_width};
use super::look::{Look, RADIUS, style};
use super::markup::{escape, put};

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Dimension {
    /// Quantity and unit.
    pub title: String,
    /// The scale.
    pub axis: LogAxis,
    /// How a value is written beside its tick.
    pub label: fn(f64) -> String,
}

/// A point of a chart.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical one.
    pub y: f64,
    /// Where x may lie.
    pub x_spread: Option<[f64; 2]>,
    /// Where y may lie.
    pub y_spread: Option<[f64; 2]>,
    /// Hue and shape.
    pub look: Look,
    /// Written beside it where there is room; nothing if empty.
    pub label: String,
    /// What a pointer that rests on it shows.
    pub tooltip: String,
}

/// A chart that can be drawn at any width.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// The horizontal axis.
    pub x: Dimension,
    /// The vertical one.
    pub y: Dimension,
    /// What the lane of zeros means, if there is one.
    pub zeros: String,
    /// The points.
    pub marks: Vec<Mark>,
    /// Places among the marks of those that no other beats, along the horizontal axis: ringed and joined.
    pub front: Vec<usize>,
    /// Places among the marks of those that belong together, along the horizontal axis: joined.
    pub curves: Vec<Vec<usize>>,
    /// What hues and shapes mean.
    pub legend: Vec<(Look, String)>,
}

/// Pixels around the plot.
const LEFT: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 64.0;
const BELOW: f64 = 50.0;
/// Pixels from line to line of text.
const LINE: f64 = 22.0;
/// Height of the plot, and the share of the width that it may not exceed.
const HEIGHT: f64 = 380.0;
/// Between marks that lie beside each other in the lane.
const GAP: f64 = 1.0;
/// Marks are labelled in text of this size.
const LABEL_SIZE: f64 = 13.0;

impl Chart {
    /// The chart as a part of an HTML page that holds its [`style`].
    #[must_use]
    pub fn svg(&self, width: f64) -> String {
        self.element(width, None)
    }

    /// The chart as a part of an SVG document, this far from its top; and its height.
    #[must_use]
    pub fn stacked(&self, width: f64, y: f64) -> (String, f64) {
        (self.element(width, Some(y)), self.height(width))
    }

    fn height(&self, width: f64) -> f64 {
        TOP + HEIGHT + BELOW + LINE * self.legend_places(width).1 as f64
    }

    fn element(&self, width: f64, y: Option<f64>) -> String {
        let height = self.height(width);
        let title = escape(&self.title);
        let place = match y {
            Some(y) => format!(" y=\"{y:.0}\" width=\"{width:.0}\" height=\"{height:.0}\""),
            None => String::new(),
        };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" viewBox=\"0 0 {width:.0} \
             {height:.0}\"{place} role=\"img\" aria-label=\"{title}\">\n"
        );
        put(
            &mut svg,
            format_args!("<rect class=\"paper\" width=\"{width:.0}\" height=\"{height:.0}\"/>\n"),
        );
        put(&mut svg, format_args!("<text class=\"title\" x=\"8\" y=\"28\">{title}</text>\n"));
        let plot = Plot { width: width - LEFT - RIGHT, chart: self };
        plot.axes(&mut svg);
        plot.marks(&mut svg);
        for ((look, text), (x, line)) in self.legend.iter().zip(self.legend_places(width).0) {
            let y = TOP + HEIGHT + BELOW + LINE * (line as f64 + 0.4);
            svg += &look.svg(x + 8.0, y, "");
            put(
                &mut svg,
                format_args!(
                    "<text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\n",
                    x + 20.0,
                    y + 4.0,
                    escape(text)
                ),
            );
        }
        svg + "</svg>\n"
    }

    /// Where the entries of the legend go, x and line, and how many lines there are.
    fn legend_places(&self, width: f64) -> (Vec<(f64, usize)>, usize) {
        let (mut x, mut line) = (8.0, 0);
        let mut places = Vec::new();
        for (_, text) in &self.legend {
            let entry = 20.0 + text_width(text, 12.0) + 14.0;
            if x > 8.0 && x + entry > width {
                (x, line) = (8.0, line + 1);
            }
            places.push((x, line));
            x += entry;
        }
        (places, line + usize::from(!self.legend.is_empty()))
    }
}

/// Charts below one another, as a document of its own.
#[must_use]
pub fn document(charts: &[Chart], width: f64) -> String {
    let mut parts = String::new();
    let mut height = 0.0;
    for chart in charts {
        let (part, taken) = chart.stacked(width, height);
        parts += &part;
        height += taken;
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\">\n<style>\n{}</style>\n{parts}</svg>\n",
        style()
    )
}

/// The area between the axes.
struct Plot<'a> {
    width: f64,
    chart: &'a Chart,
}

impl Plot<'_> {
    fn x(&self, value: f64) -> f64 {
        LEFT + self.width * self.chart.x.axis.place(value)
    }

    fn y(&self, value: f64) -> f64 {
        TOP + HEIGHT * (1.0 - self.chart.y.axis.place(value))
    }

    fn axes(&self, svg: &mut String) {
        let (right, foot) = (LEFT + self.width, TOP + HEIGHT);
        let lane = HEIGHT * self.chart.y.axis.lane();
        if lane > 0.0 {
            put(
                svg,
                format_args!(
                    "<rect class=\"lane\" x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{lane:.1}\"/>\n",
                    foot - lane,
                    self.width
                ),
            );
            put(
                svg,
                format_args!(
                    "<text class=\"tick\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">0</text>\n",
                    LEFT - 6.0,
                    foot - 0.5 * lane + 4.0
                ),
            );
            put(
                svg,
                format_args!(
                    "<text class=\"tick\" x=\"{}\" y=\"{:.1}\">{}</text>\n",
                    LEFT + 6.0,
                    foot - 6.0,
                    escape(&self.chart.zeros)
                ),
            );
        }
        for tick in self.chart.x.axis.ticks() {
            let (x, label) = (self.x(tick), (self.chart.x.label)(tick));
            put(svg, format_args!("<path class=\"rule\" d=\"M{x:.1} {TOP}V{foot}\"/>\n"));
            put(
                svg,
                format_args!(
                    "<text class=\"tick\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>\n",
                    foot + 17.0
                ),
            );
        }
        for tick in self.chart.y.axis.ticks() {
            let (y, label) = (self.y(tick), (self.chart.y.label)(tick));
            put(svg, format_args!("<path class=\"rule\" d=\"M{LEFT} {y:.1}H{right:.1}\"/>\n"));
            put(
                svg,
                format_args!(
                    "<text class=\"tick\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n",
                    LEFT - 6.0,
                    y + 4.0
                ),
            );
        }
        put(svg, format_args!("<path class=\"frame\" d=\"M{LEFT} {TOP}V{foot}H{right:.1}\"/>\n"));
        put(
            svg,
            format_args!(
                "<text x=\"8\" y=\"{}\">{}</text>\n",
                TOP - 12.0,
                escape(&self.chart.y.title)
            ),
        );
        put(
            svg,
            format_args!(
                "<text x=\"{right:.1}\" y=\"{}\" text-anchor=\"end\">{}</text>\n",
                foot + 37.0,
                escape(&self.chart.x.title)
            ),
        );
    }

    fn marks(&self, svg: &mut String) {
        let places = self.places();
        for (mark, &(x, y)) in self.chart.marks.iter().zip(&places) {
            if let Some([low, high]) = mark.x_spread {
                put(
                    svg,
                    format_args!(
                        "<path class=\"spread\" d=\"M{:.1} {y:.1}H{:.1}\"/>\n",
                        self.x(low),
                        self.x(high)
                    ),
                );
            }
            if let Some([low, high]) = mark.y_spread.filter(|_| mark.y > 0.0) {
                put(
                    svg,
                    format_args!(
                        "<path class=\"spread\" d=\"M{x:.1} {:.1}V{:.1}\"/>\n",
                        self.y(low),
                        self.y(high)
                    ),
                );
            }
        }
        let front: Vec<_> = self.chart.front.iter().map(|&mark| places[mark]).collect();
        let curves = self.chart.curves.iter().map(|curve| ("spread", curve));
        for (class, joined) in curves.chain([("front", &self.chart.front)]) {
            if joined.len() > 1 {
                let line: Vec<_> = joined
                    .iter()
                    .map(|&mark| format!("{:.1} {:.1}", places[mark].0, places[mark].1))
                    .collect();
                put(svg, format_args!("<path class=\"{class}\" d=\"M{}\"/>\n", line.join("L")));
            }
        }
        for (mark, &(x, y)) in self.chart.marks.iter().zip(&places) {
            *svg += &mark.look.svg(x, y, &mark.tooltip);
        }
        for (x, y) in &front {
            put(
                svg,
                format_args!(
                    "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{}\"/>\n",
                    RADIUS + RING
                ),
            );
        }
        let area = Boxed { left: LEFT, right: LEFT + self.width, top: TOP, bottom: TOP + HEIGHT };
        let mut labels = Labels::new(area, &places);
        // From the right, where there is least room.
        let mut labelled: Vec<usize> = (0..self.chart.marks.len())
            .filter(|&mark| !self.chart.marks[mark].label.is_empty())
            .collect();
        labelled.sort_by(|&a, &b| places[b].0.total_cmp(&places[a].0));
        for mark in labelled {
            let text = &self.chart.marks[mark].label;
            let width = text_width(text, LABEL_SIZE);
            let Some((x, y)) = labels.put(places[mark], width) else { continue };
            if let Some([from_x, from_y, to_x, to_y]) = Labels::leader(places[mark], (x, y), width)
            {
                put(
                    svg,
                    format_args!(
                        "<path class=\"spread\" d=\"M{from_x:.1} {from_y:.1}L{to_x:.1} {to_y:.1}\"/>\n"
                    ),
                );
            }
            put(
                svg,
                format_args!(
                    "<text class=\"label\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>\n",
                    escape(text)
                ),
            );
        }
    }

    /// The middles of all marks; those at zero are moved apart up and down within their lane.
    fn places(&self) -> Vec<(f64, f64)> {
        let step = 2.0 * RADIUS + GAP;
        let lane = HEIGHT * self.chart.y.axis.lane();
        // One line of text stands at the foot.
        let rows = (((lane - 2.0 * LINE) / step) as usize).max(1);
        let mut taken_to = vec![f64::NEG_INFINITY; rows];
        let mut places: Vec<_> =
            self.chart.marks.iter().map(|mark| (self.x(mark.x), self.y(mark.y))).collect();
        let mut zeros: Vec<usize> =
            (0..places.len()).filter(|&mark| self.chart.marks[mark].y <= 0.0).collect();
        zeros.sort_by(|&a, &b| places[a].0.total_cmp(&places[b].0));
        for mark in zeros {
            let x = places[mark].0;
            let free = taken_to.iter().position(|&end| end + step <= x);
            // Where none is free, the one that is covered least.
            let row = free.unwrap_or_else(|| {
                (0..rows).min_by(|&a, &b| taken_to[a].total_cmp(&taken_to[b])).unwrap_or(0)
            });
            taken_to[row] = x;
            // From the middle outwards: below, above, below.
            let from_middle = (row as f64 / 2.0).ceil() * if row % 2 == 1 { 1.0 } else { -1.0 };
            places[mark].1 += step * from_middle;
        }
        places
    }
}
