#![doc = include_str!("../README.md")]

use pass::{
    DepthTarget, Draw, Extent, Format, OutputContext, OutputDesc, Pass, PassTypeError, Raster, ReadSettings,
    RecordContext, Recording, ResourceDesc, Settings, Step, Target, UseContext, reflected,
};

/// The pass type `gbuffer`.
pub const PASS: &dyn Pass = &Gbuffer;

struct Gbuffer;

fn has_full_normals(settings: &Settings) -> Result<bool, PassTypeError> {
    Ok(settings.text("normals")? == "full")
}

impl Pass for Gbuffer {
    fn kind(&self) -> &'static str {
        "gbuffer"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        let texture = |format| ResourceDesc::texture_2d(format, Extent::FRAME);
        if has_full_normals(cx.settings)? {
            let members = outputs.iter_mut().flat_map(|output| &mut output.members);
            for (_, normal, _) in members.filter(|(member, ..)| member == "normal") {
                *normal = texture(Format::Rgba32Float);
            }
        }
        outputs.push(OutputDesc::scratch("nearest", texture(Format::Depth32Float)));
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.file("gbuffer.wgsl");
        let draw = |fragment: &str, members: &[&str]| Raster {
            shader: shader.clone(),
            vertex: "project".into(),
            fragment: Some(fragment.into()),
            targets: members.iter().map(|member| Target::clear(&format!("view.{member}"))).collect(),
            depth: Some(DepthTarget { resource: "nearest".into(), layer: 0, clear: 0.0 }),
            draw: Draw::Scene,
            values: Vec::new(),
            bind: Vec::new(),
            windows: Vec::new(),
        };
        let has = |member| cx.has_member("view", member);
        let (specular, full) = (has("specular"), has_full_normals(cx.settings)?);
        let members = ["depth", "normal", "albedo", "specular"];
        let of_geometry = if specular && !full { &members[..] } else { &members[..3] };
        let mut draws = vec![draw("geometry", of_geometry)];
        if specular && full {
            draws.push(draw("view_specular", &["specular"]));
        }
        if has("emission") {
            draws.push(draw("view_emission", &["emission"]));
        }
        if has("motion") {
            let motion = draw("view_motion", &["motion"]);
            draws.push(Raster { vertex: "fullscreen".into(), draw: Draw::Fullscreen, depth: None, ..motion });
        }
        Ok(Recording { steps: draws.into_iter().map(Step::Raster).collect() })
    }
}
