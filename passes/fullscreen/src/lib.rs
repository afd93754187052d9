//! A fragment shader of the user's over the whole frame. Needs no Rust: settings, ports and steps are read from the
//! shader.

use pass::Pass;
use pass::reflected::ShaderPass;
use shader_library::Stage;

/// The user's shader with the vertex stage.
const EFFECT: &str = "passes/fullscreen/effect.wgsl";

/// Draws one triangle over the outputs, for each fragment entry point of a WGSL file in the order of the text.
pub const PASS: &dyn Pass = &ShaderPass {
    kind: "fullscreen",
    about: "Runs fragment shaders over the frame, in WGSL alone: `shader:` names the file.",
    files: pass::files!(),
    stage: Stage::Fragment,
    request: |path| {
        let mut request = pass::request(EFFECT, &[]);
        request.modules.insert("effect".into(), path.into());
        request
    },
    example: "Pass(kind: \"fullscreen\", shader: \"my-effect.wgsl\", …)",
};
