//! Charts as drawings, which are written as self-contained SVG and as PDF. In SVG colours and fonts are attributes, so
//! that a file can be put into a paper as it is; every painted element also has a class, with which a page can change
//! its colour.

mod axis;
mod bars;
mod drawing;
mod labels;
mod legend;
mod palette;
mod pdf;
mod scale;
mod svg;
mod xy;

pub(super) use bars::{BarChart, BarRow, Segment};
pub(super) use drawing::Drawing;
pub(super) use palette::{Ink, MOST_COLOURS, MOST_DASHES, MOST_PARTS, style_sheet};
pub(super) use xy::{AxisKind, Line, Point, Series, XyAxis, XyChart};
