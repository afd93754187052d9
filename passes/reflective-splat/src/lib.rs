#![doc = include_str!("../README.md")]

use gpu_algorithms::segmented_scan;
use interfaces::points::SurfaceSamples;
use interfaces::virtual_lights;
use pass::{
    Compute, LARGEST_WINDOW, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording,
    ResourceDesc, Threads,
};
use std::f64::consts::PI;

pass::from_wgsl!(outputs, record);

/// The most maps: each is a workgroup of a dispatch along one dimension (WebGPU's default limit).
const MAX_MAPS: u64 = 65_535;

/// Words of a texel in each of the buffers.
const TEXEL: u64 = 4;

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let (maps, tile) = (cx.fact("lights", virtual_lights::COUNT)?, cx.settings.u32("map")?);
    let texels = u64::from(tile).pow(2);
    let most = (LARGEST_WINDOW / (TEXEL * texels)).min(MAX_MAPS);
    if u64::from(maps) > most {
        let message = format!("{maps} maps of {tile}² are more than the {most} that a buffer holds");
        return Err(PassTypeError::setting("map", message).help("take smaller maps").limit(
            "lights",
            virtual_lights::COUNT,
            most,
            "virtual lights",
        ));
    }
    let mut outputs = cx.declared()?;
    let maps = maps.max(1);
    outputs.extend([
        OutputDesc::scratch_u32("texel_cdf", maps * tile * tile),
        OutputDesc::scratch("map_totals", ResourceDesc::buffer(8 * u64::from(maps))),
        OutputDesc::scratch_u32("map_cdf", maps),
        OutputDesc::scratch("total", ResourceDesc::buffer(8)),
    ]);
    Ok(outputs)
}

/// Returns the sum over a map of cosine times solid angle of the texels whose centres are above the horizon, over π.
fn whole(tile: u32) -> f64 {
    let side = 2.0 / f64::from(tile);
    let centre = |i: u32| (f64::from(i) + 0.5) * side - 1.0;
    let squares = (0..tile * tile).map(|i| centre(i % tile).powi(2) + centre(i / tile).powi(2));
    squares.filter(|r2| *r2 < 1.0).map(|r2| 4.0 * (1.0 - r2) / (1.0 + r2).powi(3) * side * side / PI).sum()
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (maps, tile) = (cx.fact("lights", virtual_lights::COUNT)?, cx.settings.u32("map")?);
    let (candidates, budget) = (cx.settings.u32("candidates")?, cx.settings.u32("budget")?);
    let wanted = cx.settings.u32("points_per_map")?;
    let (samples, candidates) = SurfaceSamples::of_splats(cx, maps, wanted, candidates, budget)?;
    let splats = samples.of_maps(&(0..maps)).end / candidates;
    let shader = cx.file("reflective-splat.wgsl");
    let dispatch = |entry: &str, threads: u32, stores_samples: u32| {
        samples
            .fill(Compute::new(shader.clone(), entry, Threads::Row(threads)), "samples")
            .value("candidates", candidates)
            .value("maps", maps)
            .value("end", splats)
            .value("whole", whole(tile) as f32)
            .value("stores_samples", stores_samples)
    };
    let texels = maps * tile * tile;
    let sums = |texels, [cdf, totals]: [&str; 2], segments, length: u32| {
        segmented_scan(&cx.file("cumulate.wgsl").define("TEXELS", texels), segments, 1)
            .value("segment_length", length)
            .bind("cdf", cdf)
            .bind("totals", totals)
    };
    let mut recording = Recording::of([dispatch("clear", texels, 0)]);
    if splats > 0 {
        recording = recording.then(dispatch("splat", splats, 0)).then(dispatch("splat", splats, 1));
    }
    if maps > 0 {
        let of_texels = sums(true, ["texel_cdf", "map_totals"], maps, tile * tile);
        let of_maps = sums(false, ["map_cdf", "total"], 1, maps);
        recording = recording
            .then(dispatch("weigh", texels, 0).bind("weights", "distances"))
            .then(of_texels.bind("weights", "distances"))
            .then(of_maps.bind("parts", "map_totals"));
    }
    Ok(recording.then(dispatch("draw", cx.settings.u32("count")?, 0)))
}
