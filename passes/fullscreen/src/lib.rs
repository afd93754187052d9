//! A fragment shader of the user's over the whole frame. Needs no Rust: the ports are read from the shader.

use pass::reflected::{Form, Reflected, Written};
use pass::{
    Draw, Info, KindError, OutputContext, OutputDesc, Pass, Ports, Raster, RecordContext, Recording, Request,
    Setting, Settings, Step, Target, UseContext,
};
use shader_library::Stage;

/// The pass.
pub const PASS: &dyn Pass = &Fullscreen;

/// Draws one triangle over the outputs.
#[derive(Debug)]
pub struct Fullscreen;

/// The user's shader with the vertex stage.
const EFFECT: &str = "passes/fullscreen/effect.wgsl";

/// What a fragment shader with one result writes, as a port.
const RESULT: &str = "result";

/// Joins the user's file to the vertex stage.
fn with_vertex_stage(mut request: Request, path: &str) -> Request {
    request.modules.insert("effect".into(), path.into());
    request
}

fn reflect(cx: &UseContext<'_>) -> Result<Reflected, KindError> {
    let path = cx.use_.shader.ok_or_else(|| {
        KindError::new("the use names no shader")
            .help("say which: Pass(kind: \"fullscreen\", shader: \"my-effect.wgsl\", …)")
    })?;
    let reflected =
        Reflected::new(cx, &with_vertex_stage(pass::request(EFFECT, &[]), path), path, Stage::Fragment)?;
    let name = &reflected.entry.name;
    if let Some(input) = reflected.entry.inputs.first() {
        let message =
            format!("`{name}` takes `{}` from the vertex stage, which hands nothing on", input.name);
        return Err(KindError::new(message).help("the pixel is @builtin(position)"));
    }
    if reflected.entry.outputs.is_empty() {
        return Err(
            KindError::new(format!("`{name}` has no result to draw")).help("let it return a @location(0)")
        );
    }
    Ok(reflected)
}

/// What the fragment shader writes: its results, in the order of their locations, then storage.
fn written(cx: &UseContext<'_>, reflected: &Reflected) -> Result<Vec<Written>, KindError> {
    let mut outputs = reflected.entry.outputs.clone();
    outputs.sort_by_key(|output| output.location);
    let gap = outputs.iter().enumerate().find(|(i, output)| output.location as usize != *i);
    if let Some((expected, output)) = gap {
        let (name, location) = (&reflected.entry.name, output.location);
        let message = format!("`{name}` writes @location({location}) but not @location({expected})");
        return Err(KindError::new(message).help("locations count from 0 without gaps"));
    }
    let name = |name: String| if name.is_empty() { RESULT.to_owned() } else { name };
    let results = outputs.into_iter().map(|o| Written { name: name(o.name), form: Form::Target(o.ty) });
    Ok(results.chain(reflected.written_globals(cx.use_.inputs)).collect())
}

impl Pass for Fullscreen {
    fn info(&self) -> Info {
        Info {
            kind: "fullscreen",
            about: "A fragment shader over the frame, from WGSL alone: `shader:` names the file.",
            paper: "",
            shaders: &[EFFECT],
        }
    }

    fn takes_shader(&self) -> bool {
        true
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, KindError> {
        reflect(cx)?.settings()
    }

    fn ports(&self, cx: &UseContext<'_>, _: &Settings) -> Result<Ports, KindError> {
        let reflected = reflect(cx)?;
        reflected.ports(cx, &written(cx, &reflected)?)
    }

    fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, KindError> {
        let reflected = reflect(cx)?;
        reflected.outputs(cx, outputs, &written(cx, &reflected)?)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let used = UseContext { use_: cx.use_, shaders: cx.shaders };
        let reflected = reflect(&used)?;
        let targets = reflected.targets(&used, &written(&used, &reflected)?)?;
        let shader = with_vertex_stage(cx.shader(EFFECT, &[]), cx.use_.shader.unwrap_or_default());
        let draw = Raster {
            shader: reflected.variant(shader, cx),
            vertex: "fullscreen".into(),
            fragment: Some(reflected.entry.name.clone()),
            targets: targets.iter().map(|resource| Target::clear(resource)).collect(),
            depth: None,
            draw: Draw::Fullscreen,
            values: Vec::new(),
            bind: Vec::new(),
        };
        Ok(Recording { steps: vec![Step::Raster(draw)] })
    }
}
