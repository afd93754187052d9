// The sample of a frame, which is averaged over frames.
//
// A pipeline with a pass whose shader imports this takes another sample in each frame, even where nothing moves: other
// random numbers, and another place within each pixel. Without it a still picture stays the same, bit by bit.

/// The share of a new sample in the mean of all of them, where there are `age` already.
fn share_of_sample(age: u32) -> f32 {
    return 1.0 / f32(age + 1u);
}
