//! Measures of a sequence of frames: flicker seen through a moving camera, error and its change at tracked
//! pixels, deviation if nothing moves, lag after a change of the light.

mod difference;
mod error_series;
mod lag;
mod pinhole;
mod static_deviation;

pub use difference::{TemporalDifference, Tid, View, temporal_difference};
pub use error_series::{ErrorSeries, FrameError, TRACKED_PIXELS, tracked_pixels};
pub use lag::lag;
pub use pinhole::Pinhole;
pub use static_deviation::{StaticDeviation, static_deviation};
