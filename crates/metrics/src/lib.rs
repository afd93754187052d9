//! Images, and measures of the difference between two of them.
//!
//! * [`Image`]: linear Rec. 709 RGBA in `f32`, read from and written to EXR, PNG and PFM, with the
//!   provenance of the picture inside the file.
//! * [`Pair`]: an image and its reference, and the measures between them: RMSE, relMSE, MAPE, SSIM, mean
//!   energy, difference images.
//! * [`flip`] and [`hdr_flip`]: the perceived difference ꟻLIP.
//! * [`Comparison`]: all of these at once, as a table or as JSON.
//! * [`misalignment`]: signs that two pictures are not of the same camera.
//! * [`temporal`]: flicker, error over time, and lag of a sequence of frames.
//! * [`virtual_lights`]: how many lights reach the image, how many move, and how much energy a clamp removes.
//! * [`decode`]: decodes foreign pictures, within bounds; scenes use it for their textures.
//! * [`tev`]: sends pictures to a running tev.
//! * [`seeds`] and [`statistics`]: separate estimates of bias and variance, and intervals over several runs.
//!
//! Sums are `f64` in a fixed order, over each row and then over the rows, so a measure does not depend on the
//! number of threads.

mod alignment;
mod compare;
mod difference;
mod display;
mod error;
mod file;
mod flip;
mod image;
mod pair;
mod pfm;
mod ssim;

pub mod decode;
pub mod seeds;
pub mod statistics;
pub mod temporal;
pub mod tev;
pub mod virtual_lights;

pub use alignment::{Misalignment, misalignment};
pub use compare::{Comparison, ComparisonOptions, FlipStatistics};
pub use display::{Display, Tonemap, linear_from_srgb, srgb_from_linear};
pub use error::ImageError;
pub use file::{FileFormat, PROVENANCE_KEY, read_attributes, read_provenance};
pub use flip::{FlipMap, PIXELS_PER_DEGREE, flip, hdr_flip};
pub use image::{Glance, Image, luminance};
pub use pair::{DEFAULT_TRIM, Epsilon, NonFinite, Pair};
