// The interface Progress: how far a result is that takes several frames. A pipeline that outputs one as `progress` has each
// of its frames repeated until the result has converged. Between the first and the last of them, passes are left out
// on which neither it nor a history buffer depends.

/// The progress of a result that takes several frames.
struct Progress {
    /// Steps so far: samples, iterations, whatever the pass counts.
    step: u32,
    /// The greatest number of steps.
    steps: u32,
    /// Estimate of the remaining error, by the pass's own measure; 0 until there is one, and below 0 while it cannot be known.
    error: f32,
    /// 1 when the result has converged and needs no more steps.
    done: u32,
}

/// Steps that a frame adds to those before, of at most `per_frame` and `steps` in all.
fn steps_of_frame(before: Progress, per_frame: u32, steps: u32) -> u32 {
    return select(min(per_frame, steps - min(before.step, steps)), 0u, before.done != 0u);
}
