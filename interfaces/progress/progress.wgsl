// How far a result is that is made in several frames: a pipeline that outputs one as `progress` has each of its frames
// repeated until it is done.

struct Progress {
    /// Steps so far: samples, iterations, whatever the pass counts.
    step: u32,
    /// The most steps there will be.
    steps: u32,
    /// Estimate of what is still wrong, by the pass's own measure; 0 until there is one.
    error: f32,
    /// 1 when no more steps are wanted.
    done: u32,
}

/// Steps that a frame adds to those before, of at most `per_frame` and `steps` in all.
fn steps_of_frame(before: Progress, per_frame: u32, steps: u32) -> u32 {
    return select(min(per_frame, steps - min(before.step, steps)), 0u, before.done != 0u);
}
