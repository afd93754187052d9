//! Pages about passes and scenes agree with their declarations.

mod brought;
mod variants;

use catalog::{Assets, Catalog, PASSES, SceneAssets};
use frame_graph::port::PassTypes;
use frame_graph::{Setting, Use, Value};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

fn assets() -> Assets {
    Assets::new(Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")))
}

/// The passes whose settings do not depend on a user's file, with those.
fn passes() -> Vec<(&'static str, Arc<[Setting]>)> {
    let catalog = Catalog::new(assets());
    let (inputs, outputs) = (Vec::new(), BTreeMap::new());
    let kinds = PASSES.iter().filter(|pass| !pass.takes_shader()).map(|pass| pass.kind());
    kinds
        .map(|kind| {
            let use_ = Use { kind, shader: None, inputs: &inputs, outputs: &outputs };
            (kind, catalog.settings(use_).unwrap_or_else(|error| panic!("{kind}: {error:?}")))
        })
        .collect()
}

/// Returns the settings in the table of a README, with the default of each.
fn stated(readme: &str) -> Vec<(String, String)> {
    let cells = |line: &str| -> Vec<String> { line.split('|').map(|cell| cell.trim().to_owned()).collect() };
    let table = readme.lines().skip_while(|line| !line.starts_with("| setting |")).skip(2);
    let stated = |row: Vec<String>| {
        let names: Vec<String> = row[1].split(", ").map(|name| name.trim_matches('`').to_owned()).collect();
        let defaults: Vec<String> = row[2].split(", ").map(|default| default.replace('`', "")).collect();
        // One default of several settings is the default of each.
        let default = move |i: usize| defaults.get(i).or(defaults.last()).cloned().unwrap_or_default();
        names.into_iter().enumerate().map(move |(i, name)| (name, default(i))).collect::<Vec<_>>()
    };
    table.take_while(|line| line.starts_with('|')).map(cells).flat_map(stated).collect()
}

/// Returns the default as a README states it: `64 px`.
fn default(setting: &Setting) -> String {
    let value = match &setting.default {
        Value::Text(word) => word.clone(),
        Value::F32(number) => number.to_string(),
        other => other.to_string(),
    };
    format!("{value} {}", setting.unit).trim_end().to_owned()
}

#[test]
fn readmes_tell_the_settings_that_passes_declare() {
    let mut wrong = Vec::new();
    for (kind, settings) in passes() {
        let path = format!("passes/{kind}/README.md");
        let readme = assets().text(&path).unwrap();
        let stated = stated(&readme);
        for setting in settings.iter() {
            let expected = default(setting);
            match stated.iter().find(|(name, _)| *name == setting.name) {
                Some((_, default)) if *default == expected => {}
                Some((name, default)) => {
                    wrong
                        .push(format!("{path}: the default of `{name}` must be {expected}; found {default}"));
                }
                None => wrong.push(format!("{path}: add a row | `{}` | {expected} | … |", setting.name)),
            }
            let words = setting.one_of.iter().filter_map(Value::as_text);
            let unstated = words.filter(|word| !readme.contains(*word));
            wrong.extend(
                unstated.map(|word| format!("{path}: `{}` can be `{word}`, which is missing", setting.name)),
            );
        }
        let unknown = stated.iter().filter(|(name, _)| !settings.iter().any(|setting| setting.name == *name));
        wrong.extend(unknown.map(|(name, _)| format!("{path}: there is no setting `{name}`")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_setting_says_what_it_does_and_takes_its_default() {
    for (kind, settings) in passes() {
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
    assert_eq!(scene.traits().0.into_keys().collect::<Vec<_>>(), known);
}
