//! `lightloom rerun`: renders a picture again from the record in its file.

use crate::context::Context;
use crate::output::{self, stderr, stdout};
use anyhow::{Context as _, Result, bail};
use frame_graph::{Overrides, Source, diff, parse, resolve_description};
use metrics::{Display, Image, Pair, read_provenance};
use renderer::{Assets, Gpu, Provenance, Renderer, is_path_from};
use serde_json::json;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf, absolute};

/// Render a picture again from its own record, and print the differences.
///
/// A pipeline or scene that was given as the path of a file is looked for from the working folder, then from the folder
/// that the picture was rendered from, then from that of the picture. The first folder from which both are found is used.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom rerun box.exr -o again.exr")]
pub(crate) struct Args {
    /// An .exr or .png that Lightloom made
    file: PathBuf,
    /// The file of the new picture; none by default
    #[arg(short, long = "out", value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let file = args.file.display();
    let Some(text) = read_provenance(&args.file)? else {
        bail!("{file} contains no record of Lightloom: another program wrote it, or saved it again");
    };
    let written: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    if let Some(by) = written["external"].as_str() {
        bail!("{file} was rendered by another program, and cannot be rendered again here: `{by}`");
    }
    let record =
        Provenance::from_json(&text).with_context(|| format!("the record in {file} cannot be read"))?;
    // Found from any folder.
    let (picture_file, out) = (absolute(&args.file)?, args.out.as_ref().map(absolute).transpose()?);
    go_to_files(context.catalog.assets(), &record, &picture_file)?;
    let scene = renderer::load_scene(&context.catalog, &record.scene)?;
    let mut renderer = Renderer::new(Gpu::open()?, context.catalog.clone(), scene, record.size)?;
    renderer.set_seed(record.seed);
    renderer.set_frame_index(record.first_frame);
    renderer.set_pipeline(&record.pipeline, &record.overrides())?;
    record.apply_view(&mut renderer)?;
    renderer.keep(&record.output)?;
    for _ in record.first_frame..=record.frame {
        renderer.frame_until_done(|_, _| ControlFlow::Continue(()))?;
    }
    let picture = renderer.picture(&record.output, record.layer)?;
    let now = Provenance::new(&renderer, &record.scene, (&record.output, record.layer), record.first_frame);
    let mut differences = record.differences(&now);
    differences.extend(pipeline_differences(context, &record.resolved, &now.resolved));
    let display = record.display.unwrap_or(Display::of_output(&record.output, Display::default()));
    let (largest, same) = if metrics::FileFormat::of(&args.file).is_some_and(|f| f.is_display_referred()) {
        // Compared as files have it: in 8 bits.
        let again = tempfile::Builder::new().suffix(".png").tempfile()?;
        picture.write(again.path(), display, None)?;
        (
            Pair::new(&Image::read(again.path())?, &Image::read(&picture_file)?)?.max_abs_difference(),
            "the same picture, in 8 bits",
        )
    } else {
        (Pair::new(&picture, &Image::read(&picture_file)?)?.max_abs_difference(), "the same, bit for bit")
    };
    if largest > 0.0 {
        differences.push(format!("picture: the largest difference of a channel is {largest:e}"));
    }
    if let Some(out) = &out {
        picture.write(out, display, Some(&now.written_to(out, display).to_json()))?;
    }
    if context.json {
        output::json(&json!({ "differences": differences, "largest_difference": largest }));
    } else if differences.is_empty() {
        stdout!("{same}");
    } else {
        differences.iter().for_each(|line| stdout!("{line}"));
    }
    Ok(())
}

/// Changes to the first folder from which the pipeline and the scene of a record are found, if they are paths and not in
/// the tree. Files that they name in turn are then found as before.
fn go_to_files(assets: &Assets, record: &Provenance, picture: &Path) -> Result<()> {
    let is_path = |folder: &str, name: &str| {
        let known = ["", ".ron"].iter().any(|ending| assets.has(&format!("{folder}/{name}{ending}")));
        Path::new(name).is_relative() && !known && !assets.root().is_some_and(|root| is_path_from(root, name))
    };
    let mut paths = vec![("pipeline", "pipelines", &record.pipeline), ("scene", "scenes", &record.scene)];
    paths.retain(|(_, folder, name)| is_path(folder, name));
    let folders = record.folders(picture);
    let missing = |folder: &Path| paths.iter().find(|(_, _, name)| !is_path_from(folder, name));
    match folders.iter().position(|folder| missing(folder).is_none()) {
        Some(0) => Ok(()),
        Some(index) => {
            let folder = folders[index].display();
            stderr!("note: made again from {folder}, where the files of the record are");
            std::env::set_current_dir(&folders[index]).with_context(|| format!("{folder} cannot be entered"))
        }
        None => {
            let lacking = folders.first().and_then(|folder| missing(folder)).or(paths.first());
            let Some((what, _, name)) = lacking else { return Ok(()) };
            let folders: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
            bail!(
                "the {what} `{name}` of the record is not there: looked in the tree, and from {}",
                folders.join(", then ")
            )
        }
    }
}

/// Returns the differences between the flattened pipeline of the record and that of now.
fn pipeline_differences(context: &Context, before: &str, now: &str) -> Vec<String> {
    let flat = |name: &str, text: &str| {
        let description = parse(Source::new(name, text)).ok()?;
        resolve_description(name, &description, context.catalog.pipelines(), &Overrides::default()).ok()
    };
    match (flat("record", before), flat("now", now)) {
        (Some(before), Some(now)) => {
            diff(&before, &now, &*context.catalog).iter().map(|line| format!("pipeline: {line}")).collect()
        }
        // For a record of a version with another grammar, the plan's id still differs.
        _ => Vec::new(),
    }
}
