//! Points on the surfaces of the scene, which may go from frame to frame.

use pass::{Content, Fact, Figure, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of points.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of points that there is room for");

const POINTS: Struct = Struct::new("crates/interfaces/surface_points/surface-points.wgsl", "SurfacePoints");

/// The interface `SurfacePoints`.
pub const INTERFACE: Interface = Interface::new(
    "SurfacePoints",
    "Points on the surfaces of the scene, such as those that the camera sees, or those that become virtual lights.",
    &[Member::required("", Content::Struct(POINTS), "what is true of all points, and the points")],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/surface_points")
.with_figures(&[Figure::new("marked", "points that have a mark: see the pass", "")]);

wgsl_structs::wgsl! {
    "surface_points/surface-points.wgsl" {
        pub const NO_TRIANGLE;
        pub struct SurfacePoint;
        pub struct SurfacePointsHeader;
    }
}

impl SurfacePoint {
    /// An empty point.
    pub const NONE: SurfacePoint = SurfacePoint {
        position: [0.0; 3],
        triangle: NO_TRIANGLE,
        normal: [0.0; 3],
        seed: 0,
        barycentrics: [0.0; 2],
        albedo: 0,
        mark: 0,
    };

    /// Returns whether there is no point.
    pub fn is_none(&self) -> bool {
        self.triangle == NO_TRIANGLE
    }

    /// Returns the diffuse reflectance.
    pub fn albedo(&self) -> [f64; 3] {
        [0, 10, 20].map(|bit| (f64::from((self.albedo >> bit) & 0x3ff) / 1023.0).powi(2))
    }
}

/// Returns a reflectance in 30 bits, as `packed_albedo` of surface-points.wgsl does.
pub fn packed_albedo(albedo: [f64; 3]) -> u32 {
    let [r, g, b] = albedo.map(|channel| (channel.clamp(0.0, 1.0).sqrt() * 1023.0).round() as u32);
    r | (g << 10) | (b << 20)
}

/// Describes an output of `count` points.
///
/// # Errors
/// Where surface-points.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::one(port, cx.buffer(POINTS, u64::from(count))?).fact(COUNT, count))
}

/// Returns the bytes of a buffer with these points.
pub fn to_bytes(iteration: u32, points: &[SurfacePoint]) -> Vec<u8> {
    let header =
        SurfacePointsHeader { count: points.len() as u32, iteration, ..SurfacePointsHeader::default() };
    [bytemuck::bytes_of(&header), bytemuck::cast_slice(points)].concat()
}

/// Returns the header and the points in the bytes of a buffer; `None` where there are too few bytes for its count.
pub fn from_bytes(bytes: &[u8]) -> Option<(SurfacePointsHeader, Vec<SurfacePoint>)> {
    crate::with_rows(bytes, |header: &SurfacePointsHeader| header.count)
}
