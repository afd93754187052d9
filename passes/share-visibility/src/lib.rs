//! Gives many virtual lights the shadow maps of a few clusters.

use interfaces::visibility::SHARED;
use pass::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, SceneBindings,
    Setting, Settings, UseContext, Value,
};

/// The pass type `share-visibility`.
pub const PASS: &dyn Pass = &ShareVisibility;

/// Clustered visibility: a light is as visible as the area light of its cluster.
pub struct ShareVisibility;

impl Pass for ShareVisibility {
    fn info(&self) -> Info {
        Info {
            kind: "share-visibility",
            about: "Makes each virtual light as visible as the cluster that it belongs to.",
            paper: "Dong et al. 2009; ACRSM §3.2.5",
            shaders: &[],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("maps", "Visibility", "Maps of a few lights."),
                pass::input("lights", "VirtualLights", "The lights of the maps."),
                pass::input("owners", "Owners", "Which of these each light of a reader belongs to."),
            ],
            outputs: vec![pass::output("visibility", "Visibility", "The same maps, for all lights.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut visibility = OutputDesc::hand_on("visibility", "maps")
            .handed("owners", "owners", "")
            .handed("sources", "lights", "");
        let Some(maps) = cx.input("maps") else { return Ok(vec![visibility]) };
        if maps.member("owners").is_some() {
            return Err(PassTypeError::input("maps", "these maps are shared already")
                .help("let one `share-visibility` stand between the maps and what gathers light"));
        }
        visibility.facts = (*maps.facts).clone();
        let module = maps.facts.module().cloned().ok_or_else(|| {
            PassTypeError::input("maps", "what is linked to `maps` has no module that looks lights up")
        })?;
        let outline = use_cx.shaders.outline(&pass::request_of_module(&module));
        let outline = outline.map_err(|errors| PassTypeError::new(errors.to_string()))?;
        if !outline.options.iter().any(|option| option.name == SHARED) {
            return Err(PassTypeError::input("maps", format!("lookups of {} cannot be shared", module.path))
                .help("link what looks up maps: its module imports visibility-shared.wgsl"));
        }
        Ok(vec![visibility.module(module.option(SHARED, Value::Bool(true)))])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}
