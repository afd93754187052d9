//! A compute shader of the user's. Needs no Rust: the ports are read from the shader.

use pass::reflected::Reflected;
use pass::{
    Compute as Dispatch, Info, KindError, OutputContext, OutputDesc, Pass, Ports, RecordContext, Recording,
    Setting, Settings, Threads, UseContext, Value,
};
use shader_library::Stage;

/// The pass.
pub const PASS: &dyn Pass = &Compute;

/// Dispatches a thread for each texel of the first output texture, or else each element of the first buffer.
#[derive(Debug)]
pub struct Compute;

fn reflect(cx: &UseContext<'_>) -> Result<Reflected, KindError> {
    let path = cx.use_.shader.ok_or_else(|| {
        KindError::new("the use names no shader")
            .help("say which: Pass(kind: \"compute\", shader: \"my-pass.wgsl\", …)")
    })?;
    Reflected::new(cx, &pass::request(path, &[]), path, Stage::Compute)
}

impl Pass for Compute {
    fn info(&self) -> Info {
        Info {
            kind: "compute",
            about: "A compute shader, from WGSL alone: `shader:` names the file. A thread an output texel.",
            paper: "",
            shaders: &[],
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
        reflected.ports(cx, &reflected.written_globals(cx.use_.inputs))
    }

    fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, KindError> {
        let reflected = reflect(cx)?;
        reflected.outputs(cx, outputs, &reflected.written_globals(cx.use_.inputs))
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let reflected = reflect(&UseContext { use_: cx.use_, shaders: cx.shaders })?;
        let shader = reflected.variant(cx.shader(cx.use_.shader.unwrap_or_default(), &[]), cx);
        Ok(Recording::one(Dispatch::new(shader, &reflected.entry.name, threads(cx))))
    }
}

fn threads(cx: &RecordContext<'_>) -> Threads {
    let textures = cx.outputs.iter().flat_map(|port| &port.members).find_map(|(_, desc)| desc.texture());
    if let Some(texture) = textures {
        return Threads::Grid([texture.size.0, texture.size.1, texture.layers]);
    }
    let count = cx.outputs.iter().find_map(|port| port.facts.get("count").and_then(Value::as_u32));
    Threads::Row(count.unwrap_or(1))
}
