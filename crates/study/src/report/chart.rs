//! Charts as SVG that stands alone: colours and fonts are attributes, so that a file can go into a paper as it
//! is; every painted element has a class as well, by which a page can give it other colours.

mod axis;
mod bars;
mod labels;
mod legend;
mod palette;
mod scale;
mod svg;
mod xy;

pub(super) use bars::{BarChart, BarRow, Segment};
pub(super) use palette::{Ink, MOST_COLOURS, MOST_DASHES, MOST_PARTS, style_sheet};
pub(super) use xy::{AxisKind, Line, Point, Series, XyAxis, XyChart};
