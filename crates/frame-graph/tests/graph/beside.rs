//! Names in files mean the files beside them, or else those of the roots.

use frame_graph::resolve::Files;
use frame_graph::{Overrides, Resolved, Source, resolve};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Files of which those in `pipelines/` can be named without that folder, as in the tree.
struct Tree(BTreeMap<&'static str, &'static str>);

impl Files for Tree {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.at(&format!("pipelines/{path}")).or_else(|| self.at(path))
    }

    fn at(&self, path: &str) -> Option<Arc<Source>> {
        let (name, text) = self.0.get_key_value(path)?;
        Some(Source::new(*name, *text))
    }

    fn list(&self) -> Vec<String> {
        self.0.keys().map(|path| (*path).to_owned()).collect()
    }
}

const BASE: &str =
    "Pipeline(about: \"built in\", passes: { \"a\": Pass(kind: \"noise\") }, outputs: { \"a\": \"a\" })";
const PART: &str = "Pipeline(passes: { \"own\": Pass(kind: \"x\", shader: \"own.wgsl\"), \"far\": Pass(kind: \"x\", shader: \"far.wgsl\") }, outputs: { \"b\": \"own\" })";

fn resolved(
    path: &str,
    text: &'static str,
    more: &[(&'static str, &'static str)],
) -> Result<Resolved, String> {
    let path_of: &'static str = String::leak(path.to_owned());
    let mut files = BTreeMap::from([
        ("pipelines/base.ron", BASE),
        ("mine/part.ron", PART),
        ("mine/own.wgsl", ""),
        ("far.wgsl", ""),
        (path_of, text),
    ]);
    files.extend(more.iter().copied());
    resolve(path, &Tree(files), &Overrides::default()).map_err(|errors| errors.to_string())
}

#[test]
fn a_folder_can_be_handed_on() {
    for (file, extends) in
        [("part.ron", "base.ron"), ("./part.ron", "base.ron"), ("part.ron", "../pipelines/base.ron")]
    {
        let text = format!(
            "Pipeline(extends: \"{extends}\", passes: {{ \"b\": Sub(file: \"{file}\") }}, outputs: {{ \"b\": \"b\" }})"
        );
        let found = resolved("mine/x.ron", String::leak(text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let shaders: Vec<&str> = found.shaders().map(|(_, path)| path.as_str()).collect();
        assert_eq!(shaders, ["mine/own.wgsl", "far.wgsl"]);
        assert!(found.warnings().0.is_empty(), "{}", found.warnings());
    }
}

#[test]
fn what_is_beside_comes_first_and_that_is_reported() {
    let mine =
        "Pipeline(about: \"mine\", passes: { \"a\": Pass(kind: \"noise\") }, outputs: { \"a\": \"a\" })";
    let text = "Pipeline(extends: \"base.ron\")";
    let found = resolved("mine/x.ron", text, &[("mine/base.ron", mine)]).unwrap();
    assert_eq!(found.about(), Some("mine"));
    let reported = found.warnings().to_string();
    assert!(reported.starts_with("note[W002]: `base.ron` means `mine/base.ron`"), "{reported}");
    assert!(
        reported.contains("there is `pipelines/base.ron` too") && reported.contains("mine/x.ron:1:"),
        "{reported}"
    );
    // By its own name, a file means the one of the roots that it extends.
    let named_alike =
        resolved("mine/base.ron", "Pipeline(extends: \"base.ron\", about: \"mine\")", &[]).unwrap();
    assert_eq!(named_alike.passes().count(), 1);
    assert!(named_alike.warnings().0.is_empty());
}

#[test]
fn a_path_from_the_own_folder_means_nothing_else() {
    let reported = resolved("mine/x.ron", "Pipeline(extends: \"./base.ron\")", &[]).unwrap_err();
    assert!(reported.contains("there is no pipeline file `./base.ron`"), "{reported}");
    let itself = resolved("mine/x.ron", "Pipeline(extends: \"./x.ron\")", &[]).unwrap_err();
    assert!(itself.contains("E011"), "{itself}");
}

#[test]
fn a_name_from_outside_has_no_place_and_the_nearest_is_reported() {
    let tree = Tree(BTreeMap::from([("ism.ron", BASE), ("acrsm.ron", BASE), ("parts/isn.ron", BASE)]));
    for name in ["ims", "imsl", "ims.ron"] {
        let errors = resolve(name, &tree, &Overrides::default()).unwrap_err();
        let text = errors.to_string();
        assert!(text.starts_with(&format!("error[E010]: there is no pipeline `{name}`")), "{text}");
        assert!(text.contains("did you mean `ism`?") && !text.contains("parts/"), "{text}");
        assert!(errors.0[0].labels.is_empty());
    }
}

#[test]
fn a_paper_is_that_of_the_file_that_says_it() {
    let tree = |variant| {
        let base = "Pipeline(paper: \"ISM §3\", passes: { \"a\": Pass(kind: \"noise\") }, outputs: { \"a\": \"a\" })";
        let tree = Tree(BTreeMap::from([("base.ron", base), ("x.ron", variant)]));
        let found = resolve("x.ron", &tree, &Overrides::default()).unwrap();
        found.paper().map(str::to_owned)
    };
    assert_eq!(tree("Pipeline(extends: \"base.ron\")"), None);
    assert_eq!(tree("Pipeline(extends: \"base.ron\", paper: \"TCAS\")").as_deref(), Some("TCAS"));
}
