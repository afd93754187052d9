//! The facade as an application sees it: what it keeps after a refusal, what resets history buffers, and what it reports.

mod facade;
mod outputs;
mod values;

use frame_graph::{Overrides, Value};
use renderer::{Assets, Catalog, Gpu, Renderer};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// A pass that sees the scene, one that counts its own frames, and one that no output needs.
const PIPELINE: &str = r#"Pipeline(
    passes: {
        "view": Pass(kind: "gbuffer"),
        "other": Pass(kind: "gbuffer"),
        "count": Pass(
            kind: "compute", shader: "shaders/count.wgsl",
            in: { "before": "prev count.after" },
            history: (reset: [Resize, Cut, Scene]),
            out: { "after": Out(size: (1, 1)) },
        ),
    },
    outputs: { "count": "count.after", "depth": "view.depth" },
)"#;

const COUNT: &str = "struct Settings {
    /// What is added in a frame. [default: 1.0, min: 0.0, max: 9.0]
    step: f32,
    before_age: u32,
}
var<uniform> settings: Settings;
var before: texture_2d<f32>;
var after: texture_storage_2d<rgba32float, write>;
@compute @workgroup_size(1)
fn count() {
    let sum = textureLoad(before, vec2(0u), 0).x + settings.step;
    textureStore(after, vec2(0u), vec4(sum, f32(settings.before_age), 0.0, 1.0));
}\n";

/// The device of the process; `None`, said on stderr, where there is no adapter.
fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open().inspect_err(|error| eprintln!("skipped: {error}")).ok()).clone()
}

/// A folder with the pipeline `own` and its shader.
fn tree() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["pipelines", "shaders"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
    }
    std::fs::write(folder.path().join("pipelines/own.ron"), PIPELINE).unwrap();
    std::fs::write(folder.path().join("shaders/count.wgsl"), COUNT).unwrap();
    folder
}

fn without_pipeline(gpu: Gpu, root: &Path, scene: &str) -> Renderer {
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root.to_owned()))));
    let scene = renderer::load_scene(&catalog, scene).unwrap_or_else(|error| panic!("{error}"));
    Renderer::new(gpu, catalog, scene, (8, 6)).unwrap_or_else(|error| panic!("{error}"))
}

/// A renderer of the pipeline `own`; the folder has to outlive it.
fn renderer() -> Option<(Renderer, tempfile::TempDir)> {
    let gpu = gpu()?;
    let folder = tree();
    let mut renderer = without_pipeline(gpu, folder.path(), "plane");
    renderer.set_pipeline("own", &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
    Some((renderer, folder))
}

fn step(value: f32) -> Overrides {
    Overrides(vec![("count.step".to_owned(), Value::F32(value))])
}

/// Runs a frame. Returns the sum so far, and the age of the past.
fn counted(renderer: &mut Renderer) -> [f32; 2] {
    renderer.frame().unwrap_or_else(|error| panic!("{error}"));
    let [sum, age, ..] = renderer.output("count").unwrap().pixels()[0];
    [sum, age]
}
