//! The lights of the scene that a pass takes alone: the setting `lights` of shaders with the line `#lights`.

use crate::{PassTypeError, Setting, Settings, Traits, Value, ValueType};
use std::sync::Arc;

const NAME: &str = "lights";

/// The scene bindings that hold the chosen lights of a pass in place of all.
pub(crate) const GLOBALS: [&str; 2] = ["scene_lights", "scene_emitters"];

/// Returns the setting; `place` is that of the line.
pub(crate) fn setting(place: &str) -> Setting {
    Setting {
        name: NAME.to_owned(),
        ty: ValueType::Text,
        default: Value::Text(String::new()),
        min: None,
        max: None,
        one_of: Vec::new(),
        unit: String::new(),
        doc: "Names of the lights of the scene, and of its materials that emit, that the pass takes; the others are dark to it. \
              Names are separated by commas; without any it takes all."
            .to_owned(),
        declared: place.to_owned(),
    }
}

/// Whether a setting is that of `#lights`: no other text is free.
pub(crate) fn is_setting(setting: &Setting) -> bool {
    setting.name == NAME && setting.ty == ValueType::Text && setting.one_of.is_empty()
}

/// Returns the names of the lights that a pass with these settings takes; `None` where it takes all.
pub fn chosen(settings: &Settings) -> Option<Arc<[String]>> {
    let listed = settings.0.get(NAME)?.as_text()?;
    let names = listed.split(',').map(str::trim).filter(|name| !name.is_empty());
    let names: Arc<[String]> = names.map(str::to_owned).collect();
    (!names.is_empty()).then_some(names)
}

/// Refuses names that the scene does not have.
pub(crate) fn check(settings: &Settings, traits: &Traits) -> Result<(), PassTypeError> {
    let Some(names) = chosen(settings) else { return Ok(()) };
    let known: Vec<&str> = traits.sources.iter().map(|source| source.name.as_str()).collect();
    for name in names.iter() {
        if !known.contains(&name.as_str()) {
            let message = format!("the scene has no light `{name}`");
            let help = match frame_graph::nearest(name, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None if known.is_empty() => "it has no lights, and no material that emits".to_owned(),
                None => format!("it has {}", known.join(", ")),
            };
            return Err(PassTypeError::setting(NAME, message).help(help));
        }
    }
    Ok(())
}
