// How far a progressive picture is.

struct Progress {
    /// Samples a pixel so far.
    samples: u32,
    /// Estimate of the picture's own relMSE; 0 until two samples are there.
    error: f32,
    /// 1 when no more samples are wanted.
    done: u32,
    /// The most samples there will be.
    limit: u32,
}
