//! Reports: one page template, tables in HTML, Markdown and LaTeX, charts in SVG, and numbers with intervals.
//!
//! A page needs no other file and no network. The same content gives the same bytes.

mod chart;
pub mod escape;
pub mod number;
mod page;
mod table;

pub use chart::{
    AxisKind, Band, BarChart, BarRow, Drawing, Ink, Line, MOST_COLORS, MOST_DASHES, MOST_PARTS, Point,
    Segment, Series, XyAxis, XyChart,
};
pub use number::Measured;
pub use page::Page;
pub use table::{Column, Entry, Table, plain_table};
