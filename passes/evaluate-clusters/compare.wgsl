// Sums over the neighbours of each cluster, of which it is one itself. [ACRSM Eq. 4.7]

#import "centre.wgsl"
#import "dispatch.wgsl"

struct Settings {
    clusters_count: u32,
    /// Half the side of the square in which other centres are neighbours; 0: all of the layer are. Larger: a cluster is
    /// compared with what is farther away, and less with what it shares a surface with. [default: 128, unit: "px"]
    window: u32,
    /// The clusters that this dispatch adds: `begin` to `end`.
    begin: u32,
    end: u32,
}

var<uniform> settings: Settings;
var<storage, read> centres: array<Centre>;
/// Σδ² and Σδ over the neighbours of each, in units of the outcome.
var<storage, read_write> sums: array<vec2<f32>>;

@compute @workgroup_size(64)
fn compare(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.clusters_count {
        return;
    }
    var sum = vec2(0.0);
    if settings.begin > 0u {
        sum = sums[index];
    }
    let own = centres[index];
    if own.layer == NO_LAYER {
        sums[index] = sum;
        return;
    }
    let reach = f32(settings.window);
    for (var i = settings.begin; i < min(settings.end, settings.clusters_count); i++) {
        let other = centres[i];
        let near = settings.window == 0u || all(abs(other.uv - own.uv) <= vec2(reach));
        if other.layer == own.layer && near {
            sum += vec2(other.delta * other.delta, other.delta);
        }
    }
    sums[index] = sum;
}
