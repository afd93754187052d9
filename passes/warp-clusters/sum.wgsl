// Sums the squares of a level of the pyramid from those of the finer one. [ACRSM §4.5]

#import "pyramid.wgsl"

struct Settings {
    /// The level, 1 or more.
    level: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> pyramid: array<Scaled>;

/// One thread a square; z is the layer.
@compute @workgroup_size(8, 8)
fn sum(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= size_at(settings.level)) {
        return;
    }
    let finer = settings.level - 1u;
    let first = 2u * id.xy;
    pyramid[place_of(settings.level, id.z, id.xy)] = add_scaled(
        add_scaled(sum_at(finer, id.z, first), sum_at(finer, id.z, first + vec2(1u, 0u))),
        add_scaled(sum_at(finer, id.z, first + vec2(0u, 1u)), sum_at(finer, id.z, first + vec2(1u))),
    );
}
