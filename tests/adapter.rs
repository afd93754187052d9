//! Shared by the tests: one device a process, and renderers on small frames.

use frame_graph::Overrides;
use metrics::{Epsilon, Image, Pair};
use renderer::{Assets, Catalog, Gpu, Renderer, parse_value};
use std::cell::OnceCell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The root of the tree.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// The names of the RON files in a folder of the tree.
pub(crate) fn names_in(folder: &str) -> Vec<String> {
    let files = std::fs::read_dir(root().join(folder)).unwrap().flatten().map(|entry| entry.path());
    files
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect()
}

/// The device of a test; `None`, said on stderr, where there is no adapter.
pub(crate) fn gpu() -> Option<Gpu> {
    thread_local!(static OWN: OnceCell<Option<Arc<Gpu>>> = const { OnceCell::new() });
    OWN.with(|own| own.get_or_init(device).as_deref().cloned())
}

/// The most devices of a process: tests that share a queue wait for each other, and each device compiles its pipelines anew.
const MOST_DEVICES: usize = 2;

/// Returns a device that no other thread holds, or, where there are as many as there may be, that which fewest hold.
fn device() -> Option<Arc<Gpu>> {
    static DEVICES: Mutex<Vec<Arc<Gpu>>> = Mutex::new(Vec::new());
    let mut devices = DEVICES.lock().unwrap_or_else(PoisonError::into_inner);
    match devices.iter().min_by_key(|device| Arc::strong_count(device)) {
        Some(device) if Arc::strong_count(device) == 1 || devices.len() == MOST_DEVICES => {
            Some(device.clone())
        }
        _ => {
            let gpu = Gpu::open().inspect_err(|error| eprintln!("skipped: {error}")).ok()?;
            // What the tests render differs in values more often than in shaders.
            let device = Arc::new(gpu.with_shared_pipelines());
            devices.push(device.clone());
            Some(device)
        }
    }
}

/// What the tree holds, read once.
fn tree() -> Arc<Catalog> {
    static TREE: LazyLock<Arc<Catalog>> = LazyLock::new(|| Arc::new(Catalog::new(Assets::new(Some(root())))));
    Arc::clone(&TREE)
}

/// `name=value` pairs.
pub(crate) fn set(values: &[&str]) -> Overrides {
    let pair = |text: &&str| text.split_once('=').map(|(name, value)| (name.to_owned(), parse_value(value)));
    Overrides(values.iter().filter_map(pair).collect())
}

/// A renderer on the files of a folder.
pub(crate) fn renderer_in(
    root: &Path,
    pipeline: &str,
    scene: &str,
    size: (u32, u32),
    values: &[&str],
) -> Option<Renderer> {
    renderer_of(Arc::new(Catalog::new(Assets::new(Some(root.to_owned())))), pipeline, scene, size, values)
}

fn renderer_of(
    catalog: Arc<Catalog>,
    pipeline: &str,
    scene: &str,
    size: (u32, u32),
    values: &[&str],
) -> Option<Renderer> {
    let gpu = gpu()?;
    let scene = renderer::load_scene(&catalog, scene).unwrap_or_else(|error| panic!("{error}"));
    let mut renderer = Renderer::new(gpu, catalog, scene, size).unwrap_or_else(|error| panic!("{error}"));
    renderer.set_pipeline(pipeline, &set(values)).unwrap_or_else(|error| panic!("{error}"));
    Some(renderer)
}

/// A renderer on the files of the tree.
pub(crate) fn renderer(pipeline: &str, scene: &str, size: (u32, u32), values: &[&str]) -> Option<Renderer> {
    renderer_of(tree(), pipeline, scene, size, values)
}

/// Runs frames until the pipeline says that it is done, and returns their number.
pub(crate) fn done(renderer: &mut Renderer) -> u32 {
    let mut frames = 0;
    renderer
        .frame_until_done(|_, _| {
            frames += 1;
            ControlFlow::Continue(())
        })
        .unwrap();
    frames
}

/// Settings that make imperfect shadow maps cheap.
pub(crate) const SMALL: &[&str] = &["lights=64", "map=32", "rsm.size=64"];

/// The bits of a picture.
pub(crate) fn bits(image: &Image) -> Vec<[u32; 4]> {
    image.pixels().iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// The squared error of a picture, relative to a reference.
pub(crate) fn rel_mse(image: &Image, reference: &Image) -> f64 {
    Pair::new(image, reference).unwrap().rel_mse(Epsilon::default()).unwrap()
}

/// The mean of the red, green and blue of a picture.
pub(crate) fn mean(image: &Image) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for pixel in image.pixels() {
        (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
    }
    sum.map(|s| s / image.pixels().len() as f64)
}

/// Renders a frame and returns an output.
#[track_caller]
pub(crate) fn shown(renderer: &mut Renderer, output: &str) -> Image {
    renderer.frame().unwrap();
    renderer.output(output).unwrap()
}

/// Returns the sum of the mean red, green and blue of a picture, all of whose pixels are finite.
#[track_caller]
pub(crate) fn energy(image: &Image) -> f64 {
    assert!(image.pixels().iter().flatten().all(|value| value.is_finite()));
    mean(image).iter().sum()
}

/// Returns the folder of real scenes beside the tree, where there is one.
pub(crate) fn references() -> Option<PathBuf> {
    let folder = root().join("../shared/scenes/references");
    if !folder.is_dir() {
        eprintln!("skipped: the references are not here");
        return None;
    }
    Some(folder)
}
