// The share of a frame in the mean over frames, for an entry point that is marked `[sampled]`.

/// The share of a new sample in the mean of all of them, where there are `age` already.
fn share_of_sample(age: u32) -> f32 {
    return 1.0 / f32(age + 1u);
}
