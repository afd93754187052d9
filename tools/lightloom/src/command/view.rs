//! `lightloom view`: the window.

use crate::context::{Context, Sort, Values};
use anyhow::{Result, bail};
use frame_graph::resolve::Files as _;
use renderer::{ExecutorError, Gpu};
use scene::SceneError;
use std::path::{Path, PathBuf};

/// Open a window.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom view
  lightloom view ism-invtm atrium
  lightloom view my.ron model.glb --set lights=256
  lightloom view my.ron --editor \"code -g {file}:{line}:{column}\"

F1 shows the keys. Files of the pipeline, its shaders and the scene are read again whenever they are saved.")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file [default: that of the last time]
    pipeline: Option<String>,
    /// A scene by name, or a .ron, .glb, .gltf, .pbrt or .xml file [default: that of the last time]
    scene: Option<String>,
    #[command(flatten)]
    values: Values,
    /// Seed of all random numbers; 0 gives plain sequences, as the papers use them
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Command that opens the place of an error that is clicked on; {file}, {line} and {column} are put in
    #[arg(long, value_name = "COMMAND")]
    editor: Option<String>,
    /// File in which the state of the window is kept [default: in the user's data folder]
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    args.pipeline.iter().try_for_each(|name| context.expect(Sort::Pipeline, name))?;
    args.scene.iter().try_for_each(|name| context.expect(Sort::Scene, name))?;
    // A name without a file is an error here; an error inside a file is shown in the window until it is corrected.
    if let Some(pipeline) = &args.pipeline
        && context.catalog.pipelines().read(pipeline).is_none()
    {
        frame_graph::resolve(pipeline, context.catalog.pipelines(), &args.values.overrides())?;
    }
    if let Some(scene) = &args.scene {
        let files = catalog::SceneAssets(context.catalog.assets().clone());
        let is_geometry = scene::is_geometry(scene);
        match scene::about(scene, &files) {
            Err(error @ SceneError::NotFound { .. }) if !is_geometry => return Err(error.into()),
            _ if is_geometry && !Path::new(scene).exists() => bail!("there is no file {scene}"),
            _ => {}
        }
    }
    if Gpu::adapters().is_empty() {
        return Err(ExecutorError::NoAdapter.into());
    }
    viewer::run(viewer::Options {
        catalog: context.catalog.clone(),
        pipeline: args.pipeline.clone(),
        scene: args.scene.clone(),
        overrides: args.values.overrides(),
        seed: args.seed,
        editor: args.editor.clone(),
        state: args.state.clone(),
    })?;
    Ok(())
}
