// Moves points to where their triangles are now: `followed` of shaders/surface-point.wgsl.

#input points: SurfacePoints // The points.
#output now: SurfacePoints(count: points.count) // The points now.

#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "surface-point.wgsl"

struct Settings {
    points_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read_write> now: SurfacePoints;

@compute @workgroup_size(64)
fn follow(row: Row) {
    let i = index_in(row, 64u);
    if i >= settings.points_count {
        return;
    }
    now.points[i] = followed(points.points[i]);
    if i == 0u {
        now.header = points.header;
    }
}
