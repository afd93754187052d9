#![doc = include_str!("../README.md")]

use pass::{OutputContext, OutputDesc, Pass, PassTypeError, UseContext, Value};

/// The pass type `share-visibility`.
pub const PASS: &dyn Pass = &ShareVisibility;

struct ShareVisibility;

/// The option of modules whose lookups can be those of another light's map: shaders/visibility-shared.wgsl declares it.
const SHARED: &str = "SHARED";

impl Pass for ShareVisibility {
    fn kind(&self) -> &'static str {
        "share-visibility"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
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
}
