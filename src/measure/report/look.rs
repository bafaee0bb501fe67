//! How marks look: hue and shape each say one thing, and no two marks differ in hue alone.

use std::fmt::Write;

use crate::render::palette::{
    BLUE, BLUISH_GREEN, ORANGE, REDDISH_PURPLE, SKY_BLUE, Srgb, VERMILLION,
};

/// The colour of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hue {
    /// Blue; the lighter one of the palette on dark paper.
    Blue,
    /// Vermillion.
    Vermillion,
    /// Bluish green.
    Green,
    /// Reddish purple.
    Purple,
    /// Orange.
    Orange,
    /// That of text.
    Ink,
}

impl Hue {
    const ALL: [Self; 6] =
        [Self::Blue, Self::Vermillion, Self::Green, Self::Purple, Self::Orange, Self::Ink];

    /// Its class in style sheets.
    #[must_use]
    pub fn class(self) -> &'static str {
        match self {
            Self::Blue => "blue",
            Self::Vermillion => "vermillion",
            Self::Green => "green",
            Self::Purple => "purple",
            Self::Orange => "orange",
            Self::Ink => "ink",
        }
    }

    /// On white paper, and on black.
    fn colours(self) -> [Srgb; 2] {
        match self {
            Self::Blue => [BLUE, SKY_BLUE],
            Self::Vermillion => [VERMILLION; 2],
            Self::Green => [BLUISH_GREEN; 2],
            Self::Purple => [REDDISH_PURPLE; 2],
            Self::Orange => [ORANGE; 2],
            Self::Ink => [[51, 51, 51], [221, 221, 221]],
        }
    }
}

/// The outline of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A circle.
    Circle,
    /// A square.
    Square,
    /// A triangle on its base.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A short bar, which stands for a hue alone.
    Bar,
}

impl Shape {
    /// Its outline about the origin.
    fn path(self) -> &'static str {
        match self {
            Self::Circle => "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z",
            Self::Square => "M-4.5-4.5h9v9h-9z",
            Self::Triangle => "M0-6L5.6 4.2H-5.6z",
            Self::Diamond => "M0-6.4L6.4 0L0 6.4L-6.4 0z",
            Self::Bar => "M-7-3h14v6h-14z",
        }
    }
}

/// Distance from the middle of a mark to its edge, in pixels.
pub const RADIUS: f64 = 6.0;

/// A mark as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Look {
    /// Colour.
    pub hue: Hue,
    /// Outline.
    pub shape: Shape,
    /// Whether the outline is filled.
    pub filled: bool,
}

impl Look {
    /// As an SVG element with its middle at a place.
    #[must_use]
    pub fn svg(self, x: f64, y: f64, tooltip: &str) -> String {
        let fill = if self.filled { "filled" } else { "hollow" };
        let (class, path) = (self.hue.class(), self.shape.path());
        let title = match tooltip {
            "" => String::new(),
            text => format!("<title>{}</title>", super::markup::escape(text)),
        };
        format!(
            "<path class=\"mark {fill} {class}\" transform=\"translate({x:.1} {y:.1})\" \
             d=\"{path}\">{title}</path>\n"
        )
    }
}

/// Style rules of all charts, on white and on black paper.
#[must_use]
pub fn style() -> String {
    let mut style = include_str!("chart.css").to_owned();
    let rules = |paper: usize| {
        Hue::ALL.iter().fold(String::new(), |mut rules, hue| {
            let [r, g, b] = hue.colours()[paper];
            let (class, colour) = (hue.class(), format!("#{r:02x}{g:02x}{b:02x}"));
            let _ = writeln!(
                rules,
                ".filled.{class}{{fill:{colour}}} .hollow.{class}{{stroke:{colour}}}"
            );
            rules
        })
    };
    style += &rules(0);
    style
        + &format!(
            "@media (prefers-color-scheme: dark) {{\n{}{}}}\n",
            include_str!("chart_dark.css"),
            rules(1)
        )
}
