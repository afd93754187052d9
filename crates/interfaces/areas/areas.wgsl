// The interface Areas: the parts of surfaces that points stand for, averaged from frame to frame.

/// The part of the surfaces that a point stands for.
struct PointArea {
    /// The seed of the point: a point with another is another point.
    seed: u32,
    /// Frames that the area is the mean of; 0 where there is no point.
    frames: u32,
    /// Area [m²].
    area: f32,
    pad: u32,
}

struct PointAreas {
    areas: array<PointArea>,
}
