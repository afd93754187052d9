//! Overrides of pipelines, saved as files that extend them.

use super::assets;
use catalog::{Catalog, PipelineFiles};
use frame_graph::resolve::Files;
use frame_graph::{Overrides, Resolved, Settable, Source, Value, ValueType, resolve, template, variant};
use proptest::prelude::*;
use proptest::sample::Index;
use std::sync::{Arc, LazyLock};

static CATALOG: LazyLock<Catalog> = LazyLock::new(|| Catalog::new(assets()));

/// The pipelines, with what they resolve to and what can be set of them.
static PIPELINES: LazyLock<Vec<(String, Resolved, Vec<Settable>)>> = LazyLock::new(|| {
    let names = CATALOG.pipelines().list().into_iter();
    let whole = names.filter(|name| !name.starts_with("parts/")).map(|name| {
        let resolved = resolve(&name, CATALOG.pipelines(), &Overrides::default());
        let resolved = resolved.unwrap_or_else(|errors| panic!("{errors}"));
        let settable = resolved.settable(&*CATALOG);
        (name, resolved, settable)
    });
    whole.collect()
});

/// The pipelines, and a file beside them.
struct WithSaved(String);

impl Files for WithSaved {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        if path == "saved.ron" { Some(Source::new(path, self.0.as_str())) } else { pipelines().read(path) }
    }

    fn list(&self) -> Vec<String> {
        pipelines().list()
    }
}

fn pipelines() -> &'static PipelineFiles {
    CATALOG.pipelines()
}

/// A value that may be given to it; perhaps the one that it has.
fn other(settable: &Settable, choice: Index) -> Value {
    let Settable { setting, value, .. } = settable;
    if choice.index(5) == 0 {
        return value.clone();
    }
    if !setting.one_of.is_empty() {
        return choice.get(&setting.one_of).clone();
    }
    let within = |x: f64| x.max(setting.min.unwrap_or(f64::MIN)).min(setting.max.unwrap_or(f64::MAX));
    let step = choice.index(16) as f64 - 8.0;
    let value = value.clone().convert(setting.ty).expect("a value is of its type");
    match value {
        Value::Bool(on) => Value::Bool(!on),
        Value::U32(n) => Value::U32(within((f64::from(n) + step).max(0.0)) as u32),
        Value::I32(n) => Value::I32(within(f64::from(n) + step) as i32),
        Value::F32(x) => Value::F32(within(f64::from(x) * (1.0 + step / 16.0) + step / 8.0) as f32),
        Value::Text(text) => Value::Text(text),
        Value::Vector(v) => Value::Vector(v.iter().map(|x| within(f64::from(*x) + step) as f32).collect()),
    }
}

/// Whether the setting takes the value: rounding may lead out of its range.
fn fits(settable: &Settable, value: &Value) -> bool {
    settable.setting.check(value.clone()).is_ok()
}

fn values(resolved: &Resolved) -> Vec<(String, Option<Value>)> {
    let all = resolved.settable(&*CATALOG).into_iter();
    all.map(|settable| (settable.path, settable.value.convert(settable.setting.ty))).collect()
}

/// The pipeline as one file, without the paper: a variant is not its base's.
fn flattened(resolved: &Resolved) -> String {
    let text = resolved.to_ron(&*CATALOG, false);
    text.lines().filter(|line| !line.starts_with("    paper: ")).collect::<Vec<_>>().join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_saved_variant_resolves_as_the_base_with_overrides(
        pipeline: Index,
        chosen in prop::collection::vec((any::<Index>(), any::<Index>()), 0..8),
    ) {
        let (base, resolved, settable) = pipeline.get(&PIPELINES);
        let chosen = chosen.iter().map(|(which, choice)| {
            let settable = which.get(settable);
            (settable, other(settable, *choice))
        });
        let chosen: Vec<_> = chosen.filter(|(settable, value)| fits(settable, value)).collect();
        let given = chosen.iter().map(|(settable, value)| (settable.path.clone(), value.clone()));
        let overrides = Overrides(given.collect());
        let Ok(expected) = resolve(base, pipelines(), &overrides) else { return Ok(()) };

        let text = variant(base, "", resolved, &*CATALOG, &overrides);
        let saved = resolve("saved.ron", &WithSaved(text.clone()), &Overrides::default());
        let saved = saved.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
        prop_assert_eq!(values(&saved), values(&expected), "{}", text);
        // Where each override changes another value, even the flattened files are equal.
        let mut paths: Vec<&str> = overrides.0.iter().map(|(path, _)| path.as_str()).collect();
        paths.sort_unstable();
        let distinct = paths.windows(2).all(|pair| pair[0] != pair[1]);
        let same = |settable: &Settable, value: &Value| {
            let of_type = |value: &Value| value.clone().convert(settable.setting.ty);
            of_type(value) == of_type(&settable.value)
        };
        if distinct && chosen.iter().all(|(settable, value)| !same(settable, value)) {
            prop_assert_eq!(flattened(&saved), flattened(&expected));
            prop_assert_eq!(text.matches("Set(").count(), overrides.0.len());
        }
    }
}

#[test]
fn there_are_values_of_every_type_to_save() {
    let all = || PIPELINES.iter().flat_map(|(_, _, settable)| settable);
    for ty in [ValueType::Bool, ValueType::U32, ValueType::F32, ValueType::Text] {
        assert!(all().any(|settable| settable.setting.ty == ty), "{ty}");
    }
}

#[test]
fn a_template_changes_nothing_and_each_of_its_comments_is_right() {
    let about = |text: &str| text.lines().filter(|line| !line.starts_with("    about: ")).collect::<String>();
    for (base, resolved, _) in PIPELINES.iter() {
        let text = template(base, resolved, &*CATALOG);
        let read = |text: &str| resolve("saved.ron", &WithSaved(text.to_owned()), &Overrides::default());
        let same = read(&text).unwrap_or_else(|errors| panic!("{errors}\n{text}"));
        assert_eq!(about(&flattened(&same)), about(&flattened(resolved)), "{base}");
        let is_form = |line: &&str| {
            let comment = line.strip_prefix("        // ");
            comment.is_some_and(|text| ["Set(", "Replace(", "\""].iter().any(|form| text.starts_with(form)))
        };
        let forms: Vec<&str> = text.lines().filter(is_form).collect();
        assert!(forms.len() >= resolved.passes().count(), "{text}");
        for line in forms {
            let with = text.replacen(line, &line.replacen("// ", "", 1), 1);
            read(&with).unwrap_or_else(|errors| panic!("{base}, {line}: {errors}"));
        }
    }
}
