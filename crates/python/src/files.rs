//! Pipelines, shaders and scenes: those on disk and built in, and texts that Python lays over them.

use crate::error::raise;
use crate::session::{self, catalog};
use crate::value::{Given, overrides};
use anyhow::Result;
use frame_graph::{Difference, LinkContext};
use pyo3::prelude::*;
use renderer::{Compiled, Named, compile_options, load_scene};
use std::path::PathBuf;

/// Lays a text over the file at a path, which need not be there; `None` takes it away again.
#[pyfunction]
pub(crate) fn lay_over(path: PathBuf, text: Option<&str>) {
    let catalog = catalog();
    catalog.assets().set_open(&path, text);
    if let Some(name) = path.to_str() {
        catalog.shaders().invalidate(&[name]);
    }
}

/// Returns the folder whose files come before those that are built in.
#[pyfunction]
pub(crate) fn root() -> Option<PathBuf> {
    catalog().assets().root().map(Into::into)
}

/// Takes files from a folder first, and then those that are built in.
#[pyfunction]
pub(crate) fn set_root(folder: Option<PathBuf>) {
    session::set_root(folder);
}

/// Returns a pipeline with its inheritance resolved: as RON, or as JSON.
#[pyfunction]
pub(crate) fn resolve(
    py: Python<'_>,
    pipeline: &str,
    settings: Vec<(String, Given)>,
    as_json: bool,
) -> PyResult<String> {
    let catalog = catalog();
    let settings = overrides(settings);
    let resolved = py.detach(|| frame_graph::resolve(pipeline, catalog.pipelines(), &settings));
    match resolved {
        Ok(resolved) if as_json => Ok(resolved.to_json(&*catalog).to_string()),
        Ok(resolved) => Ok(resolved.to_ron(&*catalog, false)),
        Err(error) => Err(raise(py, &error.into())),
    }
}

/// Returns the differences between two pipelines: as text, and as JSON.
#[pyfunction]
pub(crate) fn diff(py: Python<'_>, a: &str, b: &str) -> PyResult<(String, String)> {
    let catalog = catalog();
    let of = |name: &str| frame_graph::resolve(name, catalog.pipelines(), &Default::default());
    let found = py.detach(|| Ok(frame_graph::resolve::diff(&of(a)?, &of(b)?, &*catalog)));
    let found: Vec<Difference> = found.map_err(|error: anyhow::Error| raise(py, &error))?;
    let text = found.iter().map(|difference| format!("{difference}\n")).collect();
    let json: serde_json::Value = found.iter().map(Difference::to_json).collect();
    Ok((text, json.to_string()))
}

/// Compiles a pipeline for a scene without a device: the plan as text, JSON, SVG and DOT, and the warnings as JSON.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    pipeline: &str,
    scene: &str,
    size: (u32, u32),
    settings: Vec<(String, Given)>,
) -> PyResult<Drawn> {
    let catalog = catalog();
    let settings = overrides(settings);
    let drawn = py.detach(|| -> Result<Drawn> {
        let traits = load_scene(&catalog, scene)?.traits();
        let context = LinkContext { frame: size, traits };
        let compiled = Compiled::new(&catalog, pipeline, &settings, &context, &compile_options())?;
        let warnings = compiled.warnings(&catalog, pipeline, &settings, &context, &compile_options());
        Ok(drawn(&compiled.plan, &warnings))
    });
    drawn.map_err(|error| raise(py, &error))
}

/// A plan as text, JSON, SVG and DOT, and warnings as JSON.
pub(crate) type Drawn = (String, String, String, String, String);

/// Returns a plan in all forms that Python shows.
pub(crate) fn drawn(plan: &frame_graph::Plan, warnings: &frame_graph::Diagnostics) -> Drawn {
    let warnings = warnings.to_json().to_string();
    (plan.to_text(), plan.to_json().to_string(), plan.to_svg(), plan.to_dot(), warnings)
}

/// Returns the name of each pipeline, and what it renders.
#[pyfunction]
pub(crate) fn pipelines(py: Python<'_>) -> Vec<(String, Option<String>)> {
    named(py.detach(|| catalog().list_pipelines()))
}

/// Returns the name of each scene, and what it shows.
#[pyfunction]
pub(crate) fn scenes(py: Python<'_>) -> Vec<(String, Option<String>)> {
    named(py.detach(|| catalog().list_scenes()))
}

fn named(all: Vec<Named>) -> Vec<(String, Option<String>)> {
    all.into_iter().map(|named| (named.name, named.about)).collect()
}
