// The values of a texel that are stored until the greatest of the map are known.

struct ReflectanceValues {
    /// ρ_f of ACRSM Eq. 4.1, in any unit.
    reflected: f32,
    /// ρ_v of Eq. 4.2, in [0, 1].
    seen: f32,
}

/// The greatest values of all texels.
struct GreatestValues {
    reflected: f32,
    importance: f32,
}

/// Part of the greatest; 0 where that is 0.
fn part_of(value: f32, greatest: f32) -> f32 {
    return select(0.0, min(value / greatest, 1.0), value > 0.0 && greatest > 0.0);
}

/// ρ of Eq. 4.3, in [0, 1].
fn importance_by_reflectance(value: ReflectanceValues, greatest_reflected: f32, view_weight: f32) -> f32 {
    return mix(part_of(value.reflected, greatest_reflected), value.seen, view_weight);
}
