//! Writes an EXR sequence as an engine does: each frame is blended with those before it, which hides noise and lags behind
//! changes of the light. `study.ron` beside it makes it a row of a study; `lightloom judge` measures what it has written.

use anyhow::{Context as _, Result};
use clap::Parser;
use metrics::{Display, Image};
use renderer::{Assets, Catalog, Gpu, Renderer, load_scene, parse_value};
use scene::Camera;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Render frames of a scene, each blended with those before it.
#[derive(Parser)]
struct Args {
    /// The scene of the first frame: scene-0004.glb stands for those of later frames, too, where they are there
    scene: PathBuf,
    /// Its camera, likewise
    camera: PathBuf,
    /// The picture of the first frame; others have their own numbers
    out: PathBuf,
    #[arg(long, default_value_t = 1)]
    frames: u32,
    /// The share of a frame in the picture; the rest is of the pictures before
    #[arg(long, default_value_t = 0.2)]
    blend: f32,
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Virtual lights of each frame
    #[arg(long, default_value_t = 64)]
    lights: u32,
}

/// Returns the path of a frame: that of the first one, with another number.
fn numbered(first: &Path, offset: u32) -> Result<PathBuf> {
    let name = first.file_name().unwrap_or_default().to_string_lossy();
    let split = name.rsplit_once('.').and_then(|(stem, ending)| Some((stem.rsplit_once('-')?, ending)));
    let ((stem, number), ending) =
        split.with_context(|| format!("{name}: expected a name such as out-0004.exr"))?;
    let number: u32 = number.parse().with_context(|| format!("{name}: expected a number"))?;
    Ok(first.with_file_name(format!("{stem}-{:04}.{ending}", number + offset)))
}

/// Reads a camera and the size of its pictures.
fn camera(path: &Path) -> Result<(Camera, (u32, u32))> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut json: serde_json::Value = serde_json::from_str(&text)?;
    let members = json.as_object_mut().context("expected a JSON object")?;
    let mut side =
        |name: &str| members.remove(name).and_then(|side| side.as_u64()).context("expected a size");
    let size = (side("width")? as u32, side("height")? as u32);
    members.remove("environment");
    Ok((serde_json::from_value(json)?, size))
}

fn main() -> Result<()> {
    let args = Args::parse();
    let catalog = Arc::new(Catalog::new(Assets::new(None)));
    let load = |path: &Path| load_scene(&catalog, &path.display().to_string());
    let (first, size) = camera(&args.camera)?;
    let mut renderer = Renderer::new(Gpu::open()?, Arc::clone(&catalog), load(&args.scene)?, size)?;
    let values =
        [("lights", args.lights.to_string()), ("rsm.size", "64".to_owned()), ("map", "64".to_owned())];
    let values = values.map(|(name, value)| (name.to_owned(), parse_value(&value)));
    renderer.set_camera(Some(first), false);
    renderer.set_pipeline("ism-uniform", &frame_graph::Overrides(values.into()))?;
    let mut picture: Option<Image> = None;
    for frame in 0..args.frames {
        let begun = Instant::now();
        let (scene, view) = (numbered(&args.scene, frame)?, numbered(&args.camera, frame)?);
        if frame > 0 && scene.is_file() {
            renderer.set_scene(load(&scene)?)?;
        }
        if frame > 0 && view.is_file() {
            renderer.set_camera(Some(camera(&view)?.0), false);
        }
        renderer.set_seed(args.seed * args.frames + frame + 1);
        renderer.frame()?;
        let mut next = renderer.output("indirect")?;
        if let Some(before) = &picture {
            for (pixel, old) in next.pixels_mut().iter_mut().zip(before.pixels()) {
                (0..3).for_each(|c| pixel[c] = old[c] + args.blend * (pixel[c] - old[c]));
            }
        }
        println!("lightloom: ms {:.3}", begun.elapsed().as_secs_f64() * 1e3);
        next.write(numbered(&args.out, frame)?, Display::AS_IS, None)?;
        picture = Some(next);
    }
    Ok(())
}
