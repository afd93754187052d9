//! The catalog's pipelines and scenes.

use data_file::paths::beside;
use frame_graph::resolve::{Files as _, diff};
use frame_graph::{Overrides, Resolved, Value, resolve};
use renderer::{Catalog, load_scene};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use study::{AxisValue, Failure, PipelineFacts, Registry, SceneFacts, SceneRecord, Values};

/// The share of a scene's extent by which a virtual light may be displaced and still counts as unmoved.
const SMALL: f32 = 1e-5;

pub(crate) struct CatalogRegistry {
    catalog: Arc<Catalog>,
}

impl CatalogRegistry {
    pub(crate) fn new(catalog: Arc<Catalog>) -> CatalogRegistry {
        CatalogRegistry { catalog }
    }
}

/// Converts values to those of the frame graph.
pub(crate) fn overrides(values: &Values) -> Overrides {
    // An axis has its values in place of those of the study.
    let is_last =
        |(i, given): &(usize, &(String, AxisValue))| values[i + 1..].iter().all(|(path, _)| *path != given.0);
    let last = values.iter().enumerate().filter(is_last);
    Overrides(last.map(|(_, (path, value))| (path.clone(), value.to_value())).collect())
}

impl Registry for CatalogRegistry {
    fn scenes(&self) -> Vec<String> {
        let paths = self.catalog.assets().list("scenes", "ron");
        paths
            .iter()
            .map(|path| path.trim_start_matches("scenes/").trim_end_matches(".ron").to_owned())
            .collect()
    }

    fn scene(&self, name: &str) -> Result<SceneFacts, Failure> {
        let scene = load_scene(&self.catalog, name).map_err(Failure::render)?;
        let traits: BTreeMap<String, Value> = scene.traits().values;
        let moves = ["moving_camera", "moving_lights", "moving_geometry"];
        Ok(SceneFacts {
            moves: moves.iter().any(|name| traits.get(*name) == Some(&Value::Bool(true))),
            seconds_per_frame: f64::from(scene.frame_time(1)),
            small_length: scene.extent() * SMALL,
            record: SceneRecord {
                name: name.to_owned(),
                about: scene.about.clone(),
                hash: format!("{:032x}", scene.hash),
                triangles: scene.triangles(),
            },
        })
    }

    fn beside(&self, by: &str, name: &str) -> Option<String> {
        let own = beside(by, name)?;
        let with_ending = format!("{own}.ron");
        [own, with_ending].into_iter().find(|path| self.catalog.assets().has(path))
    }

    fn shadowed(&self, folder: &str, name: &str, own: &str) -> Option<String> {
        let assets = self.catalog.assets();
        let paths = ["", ".ron"].map(|ending| format!("{folder}/{name}{ending}"));
        let other = paths.into_iter().find(|path| path != own && assets.has(path))?;
        // One file has several paths: from the root, and from the working folder.
        (assets.text(&other) != assets.text(own)).then_some(other)
    }

    fn roots(&self) -> Vec<PathBuf> {
        self.catalog.pipelines().roots()
    }

    fn pipelines(&self) -> Vec<String> {
        let whole = self.catalog.list_pipelines().into_iter().filter(|named| named.about.is_some());
        whole.map(|named| named.name).collect()
    }

    fn pipeline(&self, name: &str) -> Result<PipelineFacts, Failure> {
        let resolved: Resolved =
            resolve(name, self.catalog.pipelines(), &Overrides::default()).map_err(Failure::render)?;
        if resolved.is_part() {
            return Err(Failure::render("it is a sub-graph, to be used within pipelines"));
        }
        Ok(PipelineFacts {
            about: resolved.about().unwrap_or_default().to_owned(),
            paper: resolved.paper().unwrap_or_default().to_owned(),
            outputs: resolved.outputs().map(ToString::to_string).collect(),
            passes: resolved.passes().map(|(name, _)| name.to_string()).collect(),
            figures: resolved.figures(&*self.catalog),
            settings: resolved.settable(&*self.catalog),
        })
    }

    fn differences(&self, first: (&str, &Values), second: (&str, &Values)) -> Vec<String> {
        let resolved =
            |(name, set): (&str, &Values)| resolve(name, self.catalog.pipelines(), &overrides(set));
        match (resolved(first), resolved(second)) {
            (Ok(first), Ok(second)) => {
                diff(&first, &second, &*self.catalog).iter().map(ToString::to_string).collect()
            }
            // Errors of either are reported when it runs.
            _ => Vec::new(),
        }
    }
}
