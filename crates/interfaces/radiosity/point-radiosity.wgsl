// The interface Radiosity: the light that leaves the surface at each of a number of points. [SMC-IR §3.2.3]

/// The radiosity of a point.
struct PointRadiosity {
    /// All that leaves the surface but what it emits itself [W/m²]; 0 where there is no point.
    radiosity: vec3<f32>,
    /// Key of its origin: radiosities with the same key are the same while neither lights nor surfaces move. 0 where it has
    /// none.
    key: u32,
}

struct PointRadiosities {
    radiosities: array<PointRadiosity>,
}
