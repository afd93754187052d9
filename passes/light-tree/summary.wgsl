// Counts the lights that are not dark, and finds the box around those on surfaces.

#import "algorithms/summarize.wgsl"
#import "lit-lights.wgsl"

struct Settings {
    lights_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// [scratch]
var<storage, read_write> summary: Summary;

fn reduce_length() -> u32 {
    return min(lights.count, settings.lights_count);
}

fn reduce_element(i: u32) -> Summary {
    let light = lights.lights[i];
    var own = reduce_identity();
    if is_lit(light) {
        own.count = 1u;
        if light.kind != INFINITELY_FAR {
            own.low = light.position;
            own.high = light.position;
        }
    }
    return own;
}

fn reduce_store(result: Summary) {
    summary = result;
}
