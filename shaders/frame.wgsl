// The number of the frame and its time. A pass that imports this runs in every frame.

/// The frame and its time.
struct Frame {
    /// Number of frames since the start.
    index: u32,
    /// Seconds since the start.
    time: f32,
    /// Seconds since the frame before.
    step: f32,
    pad: f32,
}

var<uniform> frame: Frame;
