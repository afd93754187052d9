//! A fragment shader of the user's over the whole frame. Needs no Rust: settings, ports and steps are read from the
//! shader.

use pass::reflected::{self, Reflected, UserShader};
use pass::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Setting, Settings,
    Use, UseContext,
};
use shader_library::Stage;

/// The pass.
pub const PASS: &dyn Pass = &Fullscreen;

/// Draws one triangle over the outputs, for each fragment entry point of a WGSL file in the order of the text.
#[derive(Debug)]
pub struct Fullscreen;

/// The user's shader with the vertex stage.
const EFFECT: &str = "passes/fullscreen/effect.wgsl";

fn user<'a>(use_: &Use<'a>) -> Result<UserShader<'a>, PassTypeError> {
    let path = use_.shader.ok_or_else(|| {
        PassTypeError::new("the use names no shader")
            .help("say which: Pass(kind: \"fullscreen\", shader: \"my-effect.wgsl\", …)")
    })?;
    let mut request = pass::request(EFFECT, &[]);
    request.modules.insert("effect".into(), path.into());
    Ok(UserShader { path, request, stage: Stage::Fragment })
}

impl Pass for Fullscreen {
    fn info(&self) -> Info {
        Info {
            kind: "fullscreen",
            about: "Fragment shaders over the frame, from WGSL alone: `shader:` names the file.",
            paper: "",
            shaders: &[EFFECT],
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
