// The interface SurfacePoints: points on the surfaces of the scene, such as those that become virtual lights. They may go
// from frame to frame. [SMC-IR §3.2]

/// The triangle of an empty point.
const NO_TRIANGLE: u32 = 0xffffffffu;

/// A point on a surface.
struct SurfacePoint {
    /// Position in world space [m].
    position: vec3<f32>,
    /// Index of the triangle that it lies on; NO_TRIANGLE where there is no point, such as where a ray met nothing.
    triangle: u32,
    /// Geometric normal, unit, on the side from which the point was reached.
    normal: vec3<f32>,
    /// Seed of the point: given where it is created, and kept as long as it lives.
    seed: u32,
    /// Weights of the second and third vertex of the triangle, by which the point follows it.
    barycentrics: vec2<f32>,
    /// Diffuse reflectance of the material, without the detail of textures: see `albedo_of`.
    albedo: u32,
    /// Mark by which a pass reports a property of a point; 0 where a point is created.
    mark: u32,
}

/// Properties of all points.
struct SurfacePointsHeader {
    /// Number of points, those included that are empty: at most what there is room for.
    count: u32,
    /// Frames of the algorithm that created the points.
    iteration: u32,
    /// How many have a mark, where a pass documents what it marks.
    marked: u32,
    pad: u32,
}

struct SurfacePoints {
    header: SurfacePointsHeader,
    points: array<SurfacePoint>,
}

/// An empty point.
fn no_point() -> SurfacePoint {
    var point: SurfacePoint;
    point.triangle = NO_TRIANGLE;
    return point;
}

/// A reflectance in 30 bits: ten for the square root of each channel, so that dark ones are rounded less.
fn packed_albedo(albedo: vec3<f32>) -> u32 {
    let rounded = vec3<u32>(sqrt(clamp(albedo, vec3(0.0), vec3(1.0))) * 1023.0 + 0.5);
    return rounded.r | (rounded.g << 10u) | (rounded.b << 20u);
}

/// The diffuse reflectance of a point.
fn albedo_of(point: SurfacePoint) -> vec3<f32> {
    let root = vec3<f32>((vec3(point.albedo) >> vec3(0u, 10u, 20u)) & vec3(0x3ffu)) / 1023.0;
    return root * root;
}
