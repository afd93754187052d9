//! The WGSL of the pass and `shaders/points-on-the-fly.wgsl`, in double precision up to the same integers.

pub(crate) use gpu_algorithms::reference::triangle_samples::{
    normal_and_area, scramble, triangle_at, triangle_from_square,
};

use glam::DVec3;
use gpu_algorithms::reference::triangle_samples::edges;

/// The most maps that take turns: `BLOCK` of points-on-the-fly.wgsl.
pub(crate) const BLOCK: u32 = 32;
/// The sum of all shares.
pub(crate) const WHOLE: u32 = 0x8000_0000;
/// Stands for as many points as are requested.
pub(crate) const ANY_NUMBER: u32 = u32::MAX;

/// Returns the level of a tessellator for an edge \[m\] or an area \[m²\], given the least and the greatest
/// value of the scene (ACRSM Eq. 5.3 and 5.4) and the range `factors`.
pub(crate) fn level(bounds: [f64; 2], value: f64, factors: [u32; 2]) -> u32 {
    let x = if bounds[1] > bounds[0] { (value - bounds[0]) / (bounds[1] - bounds[0]) } else { 1.0 };
    let x = x.clamp(0.0, 1.0);
    ((x * x * (3.0 - 2.0 * x) * f64::from(factors[1])).ceil() as u32).max(factors[0])
}

/// Returns the number of vertices of a triangle with these levels of its edges and inside.
pub(crate) fn tessellated_points(edges: [u32; 3], inside: u32) -> u32 {
    let around: u32 = edges.iter().sum();
    if inside == 1 && around == 3 {
        return 3;
    }
    // Rings around the middle: each side has two segments fewer than that of the ring around it.
    let rings = (1..).map(|ring| inside.max(2).saturating_sub(2 * ring)).take_while(|side| *side > 0);
    around + rings.map(|side| 3 * side).sum::<u32>() + u32::from(inside.max(2).is_multiple_of(2))
}

/// Returns the weight of each triangle: its area \[m²\]; if `factors` are given, the number of points of a
/// tessellator.
pub(crate) fn weights(triangles: &[[DVec3; 3]], factors: Option<[u32; 2]>) -> Vec<f64> {
    let measured: Vec<(f64, [f64; 3])> = triangles
        .iter()
        .map(|corners| {
            let (_, a, b) = edges(0, |_, k| corners[k as usize]);
            (normal_and_area(a, b).1, [a.length(), b.length(), a.distance(b)])
        })
        .collect();
    let Some(factors) = factors else { return measured.iter().map(|(area, _)| *area).collect() };
    let real = || measured.iter().filter(|(area, _)| *area > 0.0);
    let bounds = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], x| [least.min(x), most.max(x)])
    };
    let areas = bounds(&mut real().map(|(area, _)| *area));
    let lengths = bounds(&mut real().flat_map(|(_, lengths)| *lengths));
    measured
        .iter()
        .map(|(area, sides)| {
            if *area == 0.0 {
                return 0.0;
            }
            let outer = sides.map(|side| level(lengths, side, factors));
            f64::from(tessellated_points(outer, level(areas, *area, factors)))
        })
        .collect()
}

/// Returns where the intervals of triangles with these weights begin, and where the last ends; `dither` in
/// \[0, 1) decides the rounding.
pub(crate) fn starts(weights: &[f64], dither: impl Fn(u32) -> f64) -> Vec<u32> {
    let whole: f64 = weights.iter().sum();
    let mut sum = 0_u32;
    let mut starts = vec![0];
    for (i, weight) in (0..).zip(weights) {
        if *weight > 0.0 {
            sum += (weight / whole * f64::from(WHOLE) + dither(i)) as u32;
        }
        starts.push(sum.min(WHOLE));
    }
    if let Some(last) = starts.last_mut().filter(|_| !weights.is_empty()) {
        *last = WHOLE;
    }
    starts
}

/// The samples that a consumer requests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Number of maps.
    pub(crate) maps: u32,
    /// Samples per map.
    pub(crate) per_map: u32,
    /// Number that the triangles ask for, or [`ANY_NUMBER`].
    pub(crate) requested: u32,
    /// Binary logarithm of the number of maps that take turns.
    pub(crate) block_bits: u32,
}

impl Wanted {
    /// Creates a request whose blocks are as large as they may be without being much larger than all maps.
    pub(crate) fn new(maps: u32, per_map: u32, requested: u32) -> Wanted {
        Wanted { maps, per_map, requested, block_bits: BLOCK.min(maps.next_power_of_two()).ilog2() }
    }

    /// Returns the samples of all maps, with their number padded to whole blocks.
    pub(crate) fn threads(&self) -> u32 {
        self.maps.next_multiple_of(1 << self.block_bits) * self.per_map
    }
}

/// The place of a sample in the sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The map that it belongs to.
    pub(crate) map: u32,
    /// Its number among the samples of the map, in the order of the triangles.
    pub(crate) stratum: u32,
    /// Its coordinate along the cumulated shares, in 0..2³¹.
    pub(crate) number: u32,
    /// Number of samples that are produced, for all maps together.
    pub(crate) made: u32,
}

/// Returns the place of sample `index`; `None` if there is no such sample.
pub(crate) fn place(index: u32, wanted: &Wanted) -> Option<Place> {
    let turns = 1 << wanted.block_bits;
    let (row, turn) = (index / turns, index % turns);
    let (block, stratum) = (row / wanted.per_map, row % wanted.per_map);
    let map = block * turns + turn;
    if map >= wanted.maps {
        return None;
    }
    let place = stratum * wanted.maps + map;
    let made = wanted.requested.min(wanted.maps * wanted.per_map);
    if place >= made {
        return None;
    }
    let step = (1_u64 << 63) / u64::from(made);
    let number = ((u128::from(step) * u128::from(place)) >> 32) as u32 + ((step >> 32) as u32) / 2;
    Some(Place { map, stratum, number, made })
}

/// A sample of the surface: struct SurfaceSample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// World space \[m\].
    pub(crate) position: DVec3,
    /// Index of the triangle.
    pub(crate) triangle: u32,
    /// Unit.
    pub(crate) normal: DVec3,
    /// The area that it stands for among the samples of its map \[m²\].
    pub(crate) area: f64,
}

/// Returns the sample at a place; `second` in \[0, 1) is its other coordinate in the square.
pub(crate) fn sample(
    place: &Place,
    maps: u32,
    second: f64,
    starts: &[u32],
    corner: impl Fn(u32, u32) -> DVec3,
) -> Sample {
    let triangle = triangle_at(starts, place.number);
    let start = starts[triangle as usize];
    let width = f64::from(starts[triangle as usize + 1] - start);
    let along = ((f64::from(place.number - start) + 0.5) / width).min(1.0);
    let at = triangle_from_square([along, second]);
    let (origin, a, b) = edges(triangle, corner);
    let (normal, area) = normal_and_area(a, b);
    let share = f64::from(WHOLE) / f64::from(place.made) / width;
    let position = origin + at[0] * a + at[1] * b;
    Sample { position, triangle, normal, area: area * share * f64::from(maps) }
}
