// Points where their triangles are now.

#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "surface-point.wgsl"

struct Settings {
    points_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read_write> followed_points: SurfacePoints;

@compute @workgroup_size(64)
fn follow(row: Row) {
    let i = index_in(row, 64u);
    if i >= settings.points_count {
        return;
    }
    followed_points.points[i] = followed(points.points[i]);
    if i == 0u {
        followed_points.header = points.header;
    }
}
