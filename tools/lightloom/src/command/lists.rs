//! `lightloom pipelines`, `scenes`, `adapters`: what there is.

use crate::context::Context;
use crate::output::{self, say};
use anyhow::{Result, bail};
use frame_graph::resolve::Files;
use frame_graph::{Overrides, resolve};
use renderer::Gpu;
use serde_json::{Value, json};

/// Takes nothing but the options of all commands.
#[derive(clap::Args)]
pub(crate) struct Args {}

/// Names with a line about each.
fn print(context: &Context, rows: &[(String, String)]) {
    if context.json {
        let rows: Vec<Value> =
            rows.iter().map(|(name, about)| json!({ "name": name, "about": about })).collect();
        output::json(&Value::Array(rows));
    } else {
        rows.iter().for_each(|(name, about)| say!("{name:<26} {about}"));
    }
}

pub(crate) fn pipelines(context: &Context) -> Result<()> {
    let files = context.catalog.pipelines();
    let rows: Vec<(String, String)> = files
        .list()
        .into_iter()
        .filter_map(|path| {
            let name = path.trim_end_matches(".ron").to_owned();
            match resolve(&path, files, &Overrides::default()) {
                Ok(resolved) if resolved.is_part() => None,
                Ok(resolved) => Some((name, resolved.about().unwrap_or_default().to_owned())),
                Err(_) => Some((name, "broken: `lightloom check` says why".to_owned())),
            }
        })
        .collect();
    print(context, &rows);
    Ok(())
}

pub(crate) fn scenes(context: &Context) -> Result<()> {
    let files = catalog::SceneAssets(context.catalog.assets().clone());
    let names = context.catalog.assets().list("scenes", "ron");
    let rows: Vec<(String, String)> = names
        .iter()
        .map(|path| {
            let name = path.trim_start_matches("scenes/").trim_end_matches(".ron");
            (
                name.to_owned(),
                scene::about(name, &files)
                    .unwrap_or_else(|_| "broken: `lightloom check` says why".to_owned()),
            )
        })
        .collect();
    print(context, &rows);
    Ok(())
}

pub(crate) fn adapters(context: &Context) -> Result<()> {
    let adapters = Gpu::adapters();
    if adapters.is_empty() {
        bail!(
            "no graphics adapter was found; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` gives one that runs on the CPU"
        );
    }
    let rows: Vec<(String, String)> = adapters
        .iter()
        .map(|info| {
            (
                info.name.clone(),
                format!("{:?}, {:?}, {} {}", info.device_type, info.backend, info.driver, info.driver_info),
            )
        })
        .collect();
    print(context, &rows);
    Ok(())
}
