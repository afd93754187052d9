// Counts the frames since lights or geometry have moved.

#input of: ReflectiveShadowMap // What is watched. The pass has `history: (reset: [MovedUpstream], ...)`.
#input past: Progress // `prev` of the output: its age is the count.
#output still: Progress // Its `step` is 0 in a frame in which something has moved, and in the first.

#import "progress.wgsl"

struct Settings {
    past_age: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> still: Progress;

@compute @workgroup_size(1)
fn count() {
    still = Progress(settings.past_age, 0u, 0.0, 0u);
}
