//! A pass type without Rust of its own.

use super::{Reflected, UserShader};
use crate::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Request, Setting,
    Settings, Use, UseContext,
};
use shader_library::Stage;

/// A pass type whose uses name a WGSL file that says all the rest: the entry points of one stage, in the order of the
/// text.
#[derive(Debug)]
pub struct ShaderPass {
    /// What the documentation says of it.
    pub info: Info,
    /// The stage of the entry points.
    pub stage: Stage,
    /// Returns the shader that is run for a user's file: the file itself, or one that imports it.
    pub request: fn(&str) -> Request,
    /// A use as an example, for those that name no file.
    pub example: &'static str,
}

impl ShaderPass {
    fn user<'a>(&self, use_: &Use<'a>) -> Result<UserShader<'a>, PassTypeError> {
        let path = use_.shader.ok_or_else(|| {
            PassTypeError::new("the use names no shader").help(format!("say which: {}", self.example))
        })?;
        Ok(UserShader { path, request: (self.request)(path), stage: self.stage })
    }
}

impl Pass for ShaderPass {
    fn info(&self) -> Info {
        self.info
    }

    fn takes_shader(&self) -> bool {
        true
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        super::settings(cx, &self.user(&cx.use_)?)
    }

    fn ports(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        Reflected::new(cx, &self.user(&cx.use_)?, settings)?.ports(cx, settings)
    }

    fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        Reflected::new(cx, &self.user(&cx.use_)?, outputs.settings)?.outputs(cx, outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (user, use_cx) = (self.user(&cx.use_)?, cx.use_context());
        Reflected::new(&use_cx, &user, cx.settings)?.record(cx, &user)
    }
}
