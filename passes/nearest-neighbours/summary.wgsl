// Counts the points among which neighbours are searched, and finds the box around them.

#import "algorithms/summarize.wgsl"
#import "neighbourhood.wgsl"

struct Settings {
    among_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> among: SurfacePoints;
/// [scratch]
var<storage, read_write> summary: Summary;

fn reduce_length() -> u32 {
    return min(among.header.count, settings.among_count);
}

fn reduce_element(i: u32) -> Summary {
    let point = among.points[i];
    if point.triangle == NO_TRIANGLE {
        return reduce_identity();
    }
    let position = point.position * units_per_metre();
    return Summary(position, 1u, position, 0u);
}

fn reduce_store(result: Summary) {
    summary = result;
}
