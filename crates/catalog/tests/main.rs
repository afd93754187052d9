//! Pages about passes and scenes agree with their declarations.

mod brought;
mod tables;
mod variants;

use catalog::{Assets, Catalog, PASSES, SceneAssets};
use frame_graph::port::PassTypes;
use frame_graph::{Setting, Use};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

fn assets() -> Assets {
    Assets::new(Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")))
}

/// A use of a pass type, as far as its settings and ports do not depend on it.
fn use_of(kind: &str) -> Use<'_> {
    static OUTPUTS: BTreeMap<String, frame_graph::port::OutputOverride> = BTreeMap::new();
    Use { kind, shader: None, inputs: &[], outputs: &OUTPUTS }
}

/// The passes whose settings do not depend on a user's file, with those.
fn passes(catalog: &Catalog) -> impl Iterator<Item = (&'static str, Arc<[Setting]>)> {
    let kinds = PASSES.iter().filter(|pass| !pass.takes_shader()).map(|pass| pass.kind());
    kinds.map(|kind| {
        (kind, catalog.settings(use_of(kind)).unwrap_or_else(|error| panic!("{kind}: {error:?}")))
    })
}

#[test]
fn every_setting_says_what_it_does_and_takes_its_default() {
    for (kind, settings) in passes(&Catalog::new(assets())) {
        for (i, setting) in settings.iter().enumerate() {
            assert!(setting.doc.ends_with('.'), "{kind}.{}: {:?}", setting.name, setting.doc);
            assert_eq!(setting.check(setting.default.clone()), Ok(setting.default.clone()), "{kind}");
            let twice = settings[..i].iter().any(|other| other.name == setting.name);
            assert!(!twice, "{kind} declares `{}` twice", setting.name);
        }
    }
}

/// Users' shaders have options of these names set by the scene.
#[test]
fn traits_of_scenes_are_known_to_passes() {
    let scene = scene::load("empty", &SceneAssets(assets())).unwrap();
    let mut known = pass::scene_bindings::TRAITS.map(str::to_owned);
    known.sort();
    assert_eq!(scene.traits().values.into_keys().collect::<Vec<_>>(), known);
}
