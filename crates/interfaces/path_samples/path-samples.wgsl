// The interface PathSamples: means of a progressive picture, and what is known of their error.

/// The last time when samples were twice as many as before.
struct Halves {
    /// The number of samples then; 0 before there are any.
    samples: u32,
    /// The estimate of relMSE then; 0 where there is none yet, and below 0 where it cannot be known yet.
    error: f32,
}
