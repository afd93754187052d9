#![doc = include_str!("../README.md")]

use pass::{
    Draw, Extent, Format, Load, OutputDesc, Outputs, PassTypeError, Raster, ReadSettings, RecordContext,
    Recording, ResourceDesc, Settings, Step, Target, Usage, Value,
};

pass::from_wgsl!(outputs, record);

fn has_full_normals(settings: &Settings) -> Result<bool, PassTypeError> {
    Ok(settings.text("normals")? == "full")
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let size = Extent::Frame { num: cx.settings.u32("supersampling")?, den: 1 };
    let texture = |format| ResourceDesc::texture_2d(format, size.clone());
    if has_full_normals(cx.settings)? {
        let members = outputs.iter_mut().flat_map(|output| &mut output.members);
        for (_, normal, _) in members.filter(|(member, ..)| member == "normal") {
            *normal = texture(Format::Rgba32Float);
        }
    }
    let is_sky_seen = cx.traits.values.get("environment") == Some(&Value::Bool(true));
    let view = &mut outputs[0].members;
    if is_sky_seen && !view.iter().any(|(member, ..)| member == "emission") {
        view.push(("emission".into(), texture(Format::Rgba32Float), Usage::Overwrites));
    }
    if cx.settings.bool("motion")? {
        view.push(("motion".into(), texture(Format::Rg32Float), Usage::Overwrites));
    }
    outputs.push(OutputDesc::scratch("nearest", texture(Format::Depth32Float)));
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let shader = cx.file("gbuffer.wgsl");
    let draw = |fragment: &str, members: &[&str]| {
        let targets = members.iter().map(|member| Target::clear(&format!("view.{member}"))).collect();
        Raster::new(shader.clone(), "project", fragment, targets, Draw::Scene).depth("nearest")
    };
    let has = |member| cx.has_member("view", member);
    let (specular, full) = (has("specular"), has_full_normals(cx.settings)?);
    let mut of_geometry = vec!["depth", "normal", "albedo"];
    of_geometry.extend(has("geometric").then_some("geometric"));
    of_geometry.extend((specular && !full).then_some("specular"));
    let mut draws = vec![draw("geometry", &of_geometry)];
    if specular && full {
        draws.push(draw("view_specular", &["specular"]));
    }
    let (emissive, environment) = (cx.trait_bool("emissive"), cx.trait_bool("environment"));
    if emissive && has("emission") {
        draws.push(draw("view_emission", &["emission"]));
    }
    if environment && has("emission") {
        let load = if emissive { Load::Keep } else { Load::Clear([0.0; 4]) };
        let target = Target { load, ..Target::clear("view.emission") };
        draws.push(Raster::new(
            cx.file("sky.wgsl"),
            "fullscreen",
            "view_sky",
            vec![target],
            Draw::Fullscreen,
        ));
    }
    if has("motion") {
        let targets = vec![Target::clear("view.motion")];
        let shader = cx.file("motion.wgsl");
        draws.push(if cx.trait_bool("moving_geometry") {
            Raster::new(shader, "project_moved", "view_motion", targets, Draw::Scene).depth("nearest")
        } else {
            Raster::new(shader, "fullscreen", "view_motion", targets, Draw::Fullscreen)
        });
    }
    Ok(Recording { steps: draws.into_iter().map(Step::Raster).collect() })
}
