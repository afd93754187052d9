//! A compute shader of the user's. Needs no Rust: settings, ports and steps are read from the shader.

use pass::reflected::{self, Reflected, UserShader};
use pass::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Setting, Settings,
    Use, UseContext,
};
use shader_library::Stage;

/// The pass.
pub const PASS: &dyn Pass = &Compute;

/// Dispatches the compute entry points of a WGSL file, in the order of the text.
#[derive(Debug)]
pub struct Compute;

fn user<'a>(use_: &Use<'a>) -> Result<UserShader<'a>, PassTypeError> {
    let path = use_.shader.ok_or_else(|| {
        PassTypeError::new("the use names no shader")
            .help("say which: Pass(kind: \"compute\", shader: \"my-pass.wgsl\", …)")
    })?;
    Ok(UserShader { path, request: pass::request(path, &[]), stage: Stage::Compute })
}

impl Pass for Compute {
    fn info(&self) -> Info {
        Info {
            kind: "compute",
            about: "Compute shaders, from WGSL alone: `shader:` names the file, whose entry points are run in order.",
            paper: "",
            shaders: &[],
        }
    }

    fn takes_shader(&self) -> bool {
        true
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        reflected::settings(cx, &user(&cx.use_)?)
    }

    fn ports(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        Reflected::new(cx, &user(&cx.use_)?, settings)?.ports(cx, settings)
    }

    fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        Reflected::new(cx, &user(&cx.use_)?, outputs.settings)?.outputs(cx, outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (user, use_cx) = (user(&cx.use_)?, UseContext { use_: cx.use_, shaders: cx.shaders });
        Reflected::new(&use_cx, &user, cx.settings)?.record(cx, &user)
    }
}
