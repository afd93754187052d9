//! Images, and how far apart two of them are.
//!
//! * [`Image`]: linear Rec. 709 RGBA in `f32`, read from and written to EXR, PNG and PFM, with the
//!   provenance of the picture inside the file.
//! * [`Pair`]: an image and its reference, and the measures between them: RMSE, relMSE, mean energy,
//!   difference images.
//! * [`flip`] and [`hdr_flip`]: the perceived difference ꟻLIP.
//! * [`Comparison`]: all of these at once, as a table or as JSON.
//!
//! Sums are `f64`, taken row by row and then over the rows in order, so a measure does not depend on
//! the number of threads.

mod compare;
mod difference;
mod display;
mod error;
mod file;
mod flip;
mod image;
mod pair;
mod pfm;

pub use compare::{Comparison, ComparisonOptions, FlipStatistics};
pub use display::{Display, Tonemap, linear_from_srgb, srgb_from_linear};
pub use error::ImageError;
pub use file::{FileFormat, PROVENANCE_KEY, read_provenance};
pub use flip::{FlipMap, PIXELS_PER_DEGREE, flip, hdr_flip};
pub use image::{Image, luminance};
pub use pair::{Epsilon, NonFinite, Pair};
