// Whether two points on surfaces see each other.

#import "ray-tracing.wgsl"
#import "surface-points.wgsl"

/// Whether each of two points is in front of the other, and nothing is between them.
fn see_each_other(a: SurfacePoint, b: SurfacePoint) -> bool {
    let way = b.position - a.position;
    if dot(a.normal, way) <= 0.0 || dot(b.normal, way) >= 0.0 {
        return false;
    }
    let origin = offset_origin(a.position, a.normal);
    return !occluded(origin, offset_origin(b.position, b.normal) - origin, 0.0, 1.0);
}
