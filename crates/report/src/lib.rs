//! Reports: one page template, tables in HTML, Markdown and LaTeX, charts in SVG and PDF, figures of pictures in PDF and LaTeX, and
//! numbers with intervals.
//!
//! A page needs no other file and no network. The same content gives the same bytes.

mod chart;
mod composed;
pub mod escape;
mod font;
pub mod number;
mod page;
mod pdf;
mod table;

pub use chart::{
    AxisKind, BarChart, BarRow, COLUMN, Drawing, Ink, Line, MOST_COLORS, MOST_DASHES, MOST_PARTS, PAGE,
    Point, Segment, Series, XyAxis, XyChart,
};
pub use composed::{Column as FigureColumn, Composed, Raster};
pub use number::Measured;
pub use page::Page;
pub use table::{Column, Entry, Table, plain_table};
