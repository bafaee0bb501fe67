//! Reports for the eye: charts as SVG, pages as HTML. Written by hand, with nothing that a browser would
//! have to fetch.

mod axis;
mod chart;
mod labels;
mod look;
mod markup;
mod page;

pub use axis::{LogAxis, bytes, tick_label};
pub use chart::{Chart, Dimension, Mark, document};
pub use look::{Hue, Look, Shape, style};
pub use markup::{escape, png_uri};
pub use page::{Cell, Page, Shown};
