//! Charts as self-contained SVG or PDF. Colors and fonts are attributes, so that a file can be put into a paper as it is; every
//! painted element also has a class, with which a page can change its color.

/// Width of charts of a page \[px\]: narrow enough to be read where a page is narrow.
pub const PAGE: f64 = 540.0;

/// Width of charts of a paper \[px\]: a column of 240 points, in which the text of charts has 8 to 10 points.
pub const COLUMN: f64 = 320.0;

mod axis;
mod bars;
mod drawing;
mod labels;
mod legend;
mod palette;
mod scale;
mod xy;

pub use bars::{BarChart, BarRow, Segment};
pub use drawing::Drawing;
pub(crate) use drawing::n;
pub(crate) use palette::style_sheet;
pub use palette::{Ink, MOST_COLORS, MOST_DASHES, MOST_PARTS};
pub use xy::{AxisKind, Line, Point, Series, XyAxis, XyChart};
