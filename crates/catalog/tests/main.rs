//! Pages about passes and scenes agree with their declarations.

mod brought;
mod tables;
mod variants;

use catalog::{Assets, Catalog, PASSES, SceneAssets};
use frame_graph::port::PassTypes;
use frame_graph::{PassChange, Setting, Settings, Use, Value};
use pass::ExactBy;
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

/// What passes declare as exact can be put there: it is made of settings, inputs and pass types that there are.
#[test]
fn what_is_exact_is_there() {
    let catalog = Catalog::new(assets());
    let of = |kind: &str, values: &[(String, Value)]| {
        let settings = catalog.settings(use_of(kind)).unwrap_or_else(|error| panic!("{kind}: {error:?}"));
        for (name, value) in values {
            let setting = settings.iter().find(|setting| setting.name == *name);
            let setting = setting.unwrap_or_else(|| panic!("{kind} has no setting `{name}`"));
            let value = value.clone().convert(setting.ty).unwrap_or_else(|| panic!("{kind}.{name}: {value}"));
            assert_eq!(setting.check(value.clone()), Ok(value), "{kind}.{name}");
        }
    };
    let mut names = Vec::new();
    for (kind, settings) in passes(&catalog) {
        let defaults = settings.iter().map(|setting| (setting.name.clone(), setting.default.clone()));
        let settings = Settings(defaults.collect());
        let ports =
            catalog.ports(use_of(kind), &settings).unwrap_or_else(|error| panic!("{kind}: {error:?}"));
        let exact =
            catalog.exact(use_of(kind), &settings).unwrap_or_else(|error| panic!("{kind}: {error:?}"));
        for exact in exact {
            assert!(exact.doc.ends_with('.'), "{kind}: {:?}", exact.doc);
            match &exact.by {
                ExactBy::Change(PassChange::Set(values)) => of(kind, values),
                ExactBy::Change(PassChange::Replace { kind, set })
                | ExactBy::Instead(PassChange::Replace { kind, set }) => {
                    of(kind, set);
                }
                ExactBy::Change(PassChange::LeaveOut { input }) => {
                    assert!(ports.inputs.iter().any(|port| port.name == *input), "{kind}: {input}");
                }
                ExactBy::Reference(values) => of("path-tracer", values),
                ExactBy::Instead(other) => panic!("{kind}: {other:?}"),
            }
            names.push(exact.name);
        }
    }
    for expected in ["maps", "interleaving", "bound", "filter", "points", "pixels", "lights"] {
        assert!(names.iter().any(|name| name == expected), "nothing declares `{expected}`: {names:?}");
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

/// In a folder that is no tree, the program has the files that it has in one; those of tests apart.
#[test]
fn the_program_carries_the_files_of_the_tree() {
    let catalogs = [Assets::new(None), assets()].map(Catalog::new);
    let folders = [
        ("shaders", "wgsl"),
        ("crates/interfaces", "wgsl"),
        ("passes", "wgsl"),
        ("pipelines", "ron"),
        ("scenes", "ron"),
        ("studies", "ron"),
    ];
    for (folder, extension) in folders {
        let [carried, in_tree] = [0, 1].map(|i| {
            let mut files = catalogs[i].assets().list(folder, extension);
            files.retain(|file| !file.contains("/tests/"));
            files
        });
        assert!(!carried.is_empty());
        assert_eq!(carried, in_tree);
        for file in carried {
            let [carried, in_tree] = [0, 1].map(|i| catalogs[i].assets().text(&file));
            assert!(carried == in_tree, "{file}");
        }
    }
}

/// The README shows a picture of each pipeline.
#[test]
fn the_gallery_is_whole() {
    let assets = assets();
    let [study, readme] = ["studies/gallery.ron", "README.md"].map(|file| assets.text(file).unwrap());
    for name in Catalog::new(assets).list_pipelines().into_iter().map(|named| named.name) {
        assert!(
            name == "reference" || study.contains(&format!("\"{name}\",\n")),
            "studies/gallery.ron lacks {name}"
        );
        assert!(readme.contains(&format!("<code>{name}</code>")), "README.md lacks {name}: {COMMAND}");
    }
}

const COMMAND: &str = "lightloom study gallery -o out/gallery; lightloom study pictures out/gallery";
