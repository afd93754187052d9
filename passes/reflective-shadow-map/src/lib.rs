#![doc = include_str!("../README.md")]

use pass::{
    Clear, Compute, Draw, Extent, Format, LightSource, OutputDesc, Outputs, PassTypeError, Raster,
    ReadSettings, RecordContext, Recording, ResourceDesc, Settings, Step, Target, Threads, Traits, Usage,
    Value, lights,
};
use std::iter::repeat_n;

pass::from_wgsl!(outputs, record);

/// The most layers of an array on any device.
const MOST_LAYERS: u32 = 4096;

/// Returns the number of layers of the scene's lights: one for a spot or directional light, six for a point light.
fn light_layers(traits: &Traits) -> u32 {
    traits.values.get("light_layers").and_then(Value::as_u32).unwrap_or(0)
}

/// Returns the side of each of so many layers \[px\]: that of the settings, or what remains of it where they share texels.
fn side(settings: &Settings, layers: u32) -> Result<u32, PassTypeError> {
    let (size, full_layers) = (settings.u32("size")?, settings.u32("full_layers")?);
    if layers <= full_layers {
        return Ok(size);
    }
    let texels = u64::from(size).pow(2) * u64::from(full_layers);
    let side = (texels / u64::from(layers)).isqrt() as u32;
    // Workgroups of the passes that read a layer have 8² threads.
    Ok(if side > 8 { side - side % 8 } else { side.max(1) })
}

/// Returns for each layer whether the pass takes its light.
fn taken(settings: &Settings, traits: &Traits) -> Vec<bool> {
    let chosen = lights::chosen(settings);
    let takes = |source: &LightSource| chosen.as_ref().is_none_or(|names| names.contains(&source.name));
    let layers = light_layers(traits);
    let of_light = |source: &LightSource| repeat_n(takes(source), source.layers as usize);
    let mut taken: Vec<bool> = traits.sources.iter().flat_map(of_light).collect();
    // Scenes whose lights have no names.
    taken.resize(layers as usize, chosen.is_none());
    taken
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let layers = light_layers(cx.traits);
    if layers > MOST_LAYERS {
        let message = format!(
            "the lights of the scene need {layers} layers, of which a point light has six; there are at most {MOST_LAYERS}"
        );
        return Err(PassTypeError::new(message).help("render the scene with fewer lights"));
    }
    let side = side(cx.settings, layers)?;
    let mut outputs = cx.declared_with(&[("side", side.into())])?;
    let taken = taken(cx.settings, cx.traits);
    if !taken.iter().all(|taken| *taken) || layers == 0 {
        // Layers that are not rendered see nothing; where there is no light, there is one of these.
        for (_, _, usage) in &mut outputs[0].members {
            *usage = Usage::ClearFirst(Clear::Zero);
        }
    }
    if layers == 0 {
        return Ok(outputs);
    }
    let nearest = ResourceDesc::texture_2d(Format::Depth32Float, Extent::Fixed(side, side));
    outputs.push(OutputDesc::scratch("nearest", nearest));
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let layers = light_layers(cx.traits);
    let shader = cx.file("reflective-shadow-map.wgsl");
    let draw = |layer: u32, fragment: &str, members: &[&str]| {
        let target = |member: &&str| Target { layer, ..Target::clear(&format!("rsm.{member}")) };
        let targets = members.iter().map(target).collect();
        let draw = Raster::new(shader.clone(), "project", fragment, targets, Draw::Scene);
        Step::Raster(draw.depth("nearest").value("layer", layer))
    };
    let mut recording = Recording::default();
    let taken = taken(cx.settings, cx.traits);
    for layer in (0..layers).filter(|layer| taken[*layer as usize]) {
        recording.steps.push(draw(layer, "surfaces", &["position", "normal", "albedo"]));
        if cx.has_member("rsm", "specular") {
            recording.steps.push(draw(layer, "rsm_specular", &["specular"]));
        }
    }
    if layers > 0 {
        let (width, height) = cx.size("rsm");
        recording = recording.then(Compute::new(shader, "flux", Threads::Grid([width, height, layers])));
    }
    Ok(recording)
}
