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

/// Samples that a frame adds to those before, of at most `per_frame` and `limit` in all.
fn samples_of_frame(before: Progress, per_frame: u32, limit: u32) -> u32 {
    return select(min(per_frame, limit - min(before.samples, limit)), 0u, before.done != 0u);
}
