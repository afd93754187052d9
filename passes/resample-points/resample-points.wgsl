// Chooses some of many surface points by weight, none of them twice. [SMC-IR §3.2.1]
//
// This file weighs the points, and moves those that are taken to where they follow each other; in between, the other files take
// them, each by a method of its own.

#input points: SurfacePoints // The points to choose from. Empty ones are not chosen.
#input origins: SurfacePoints like points // The points from which these were traced.
#input density: Density optional like points // Density of each: its weight is divided by that.
#input radiosity: Radiosity optional like points // Radiosity of each: its weight is multiplied by the luminance.
#output resampled: SurfacePoints(count: settings.count) // Those chosen, in their order; the rest is empty.
#output resampled_origins: SurfacePoints(count: settings.count) // The points from which those were traced.
#output resampled_density: Density(count: settings.count) cleared // Density of those chosen, for the method `systematic`; it
    // wants `density`.
#output counters: Counters // The numbers of points requested and chosen.

#option DENSITY false // whether points have a density
#option RADIOSITY false // whether points have a radiosity
#option METHOD systematic one_of [systematic, race, retries] // The method of the choice. systematic: the probability of a point is
    // exactly in proportion to its weight, up to 1, and the number that falls on each run of points varies least. race: as by one
    // draw after the other. retries: as the paper does; some of the points may stay empty.
#option BY_AREA true // Whether weights are divided by the density of the points, where that is linked. true: what is chosen is
    // uniform by area, or in proportion to radiosity. false: it keeps the density of the points, times radiosity.

#import "algorithms/compact.wgsl"
#import "color.wgsl"
#import "counters.wgsl"
#import "point-radiosity.wgsl"
#import "surface-points.wgsl"
#import "weights.wgsl"

struct Settings {
    points_count: u32,
    /// Number I of points to choose. [default: 2048, min: 1, max: 2097152]
    count: u32,
    /// How often draws that find a point which is taken try again (method `retries`). More: fewer points stay empty. [default:
    /// 8, min: 0, max: 64]
    retries: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> origins: SurfacePoints;
#if DENSITY
var<storage, read> density: array<f32>;
#endif
#if RADIOSITY
var<storage, read> radiosity: PointRadiosities;
#endif
/// The weight of each point. [scratch, count: points.count]
var<storage, read_write> weights: array<Scaled>;
/// 1 for points that are taken, 2 for those that come behind all of these, and 0 for others.
var<storage, read> taken: array<u32>;
var<storage, read_write> resampled: SurfacePoints;
var<storage, read_write> resampled_origins: SurfacePoints;
var<storage, read_write> resampled_density: array<f32>;
var<storage, read_write> counters: Counters;
#if DENSITY && METHOD == systematic
/// The number of points. [scratch, cleared]
var<storage, read_write> present: atomic<u32>;
/// The chosen points. [scratch, count: settings.count]
var<storage, read_write> indices: array<u32>;
var<storage, read> threshold: Scaled;
#endif

/// The weight of a point: its radiosity over its density, as far as these are given.
fn weight(index: u32) -> Scaled {
    if index >= points.header.count || points.points[index].triangle == NO_TRIANGLE {
        return Scaled(0.0, 0);
    }
    var weight = Scaled(1.0, 0);
#if RADIOSITY
    weight = scaled_weight(luminance(radiosity.radiosities[index].radiosity));
#endif
#if DENSITY && BY_AREA
    weight = quotient(weight, scaled_weight(density[index]));
#endif
    return weight;
}

/// Weighs the points.
@compute @workgroup_size(64)
fn weigh(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    weights[index] = weight(index);
#if DENSITY && METHOD == systematic
    if index < points.header.count && points.points[index].triangle != NO_TRIANGLE {
        atomicAdd(&present, 1u);
    }
#endif
}

/// Makes all points of the output empty.
@compute @workgroup_size(GROUP_SIZE)
fn clear_points(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= settings.count {
        return;
    }
    resampled.points[i] = no_point();
    resampled_origins.points[i] = no_point();
    if i == 0u {
        resampled.header = SurfacePointsHeader(settings.count, points.header.iteration, 0u, 0u);
        resampled_origins.header = SurfacePointsHeader(settings.count, origins.header.iteration, 0u, 0u);
    }
}

fn scan_length() -> u32 {
#if METHOD == race
    // Points that arrive together come behind those that arrive before.
    return 2u * settings.points_count;
#else
    return settings.points_count;
#endif
}

fn compact_keeps(i: u32) -> bool {
    return taken[i % settings.points_count] == 1u + i / settings.points_count;
}

fn compact_move(i: u32, place: u32) {
    if place < settings.count {
        resampled.points[place] = points.points[i % settings.points_count];
        resampled_origins.points[place] = origins.points[i % settings.points_count];
#if DENSITY && METHOD == systematic
        indices[place] = i;
#endif
    }
}

fn compact_count(count: u32) {
    counters = Counters(settings.count, min(count, settings.count));
}

#if DENSITY && METHOD == systematic
/// Gives the density of the points that are chosen: that of all points, times how much more likely a point is chosen than
/// another.
@compute @workgroup_size(64)
fn weigh_chosen(row: Row) {
    let place = index_in(row, 64u);
    if place >= settings.count {
        return;
    }
    var chosen_density = 0.0;
    if place < counters.produced {
        let weight = weights[indices[place]];
        var probability = 1.0;
        if !is_certain(weight, threshold) {
            let unit = magnitude(threshold);
            probability = in_units(weight, unit) / in_units(threshold, unit);
        }
        let ratio = f32(atomicLoad(&present)) / f32(counters.produced);
        chosen_density = weight_of(density[indices[place]] * probability * ratio);
    }
    resampled_density[place] = chosen_density;
}
#endif
