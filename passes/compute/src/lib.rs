//! A compute shader of the user's. Needs no Rust: settings, ports and steps are read from the shader.

use pass::Pass;
use pass::reflected::ShaderPass;
use shader_library::Stage;

/// Dispatches the compute entry points of a WGSL file, in the order of the text.
pub const PASS: &dyn Pass = &ShaderPass {
    kind: "compute",
    about: "Runs compute shaders, in WGSL alone: `shader:` names the file, whose entry points run in order.",
    files: &[],
    stage: Stage::Compute,
    request: |path| pass::request(path, &[]),
    example: "Pass(kind: \"compute\", shader: \"my-pass.wgsl\", …)",
};
