//! A value is exchanged without linking what does not read it, and the result is that of linking.

use crate::{counted, renderer};
use frame_graph::port::{OutputContext, OutputDesc, PassTypes, Use};
use frame_graph::{
    Files as _, Interface, LinkContext, Overrides, PassTypeError, Plan, Ports, Resolved, Settable, Setting,
    Settings, Value, compile, link, resolve,
};
use renderer::{Assets, Catalog, Compiled, compile_options};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Another value that the setting may have; `None` where it has one alone.
fn another(settable: &Settable) -> Option<Value> {
    let Settable { setting, value, .. } = settable;
    if !setting.one_of.is_empty() {
        return setting.one_of.iter().find(|other| *other != value).cloned();
    }
    let steps = [1.0, -1.0, 0.125, -0.125];
    let candidates: Vec<Value> = match value {
        Value::Bool(is) => vec![Value::Bool(!is)],
        Value::U32(n) => steps.iter().map(|step| Value::U32((f64::from(*n) + step) as u32)).collect(),
        Value::I32(n) => steps.iter().map(|step| Value::I32((f64::from(*n) + step) as i32)).collect(),
        Value::F32(x) => steps.iter().map(|step| Value::F32(x + *step as f32)).collect(),
        Value::Vector(v) => vec![Value::Vector(v.iter().map(|x| x + 0.125).collect())],
        Value::Text(_) => Vec::new(),
    };
    candidates.into_iter().find(|other| other != value && setting.check(other.clone()).is_ok())
}

fn linked(catalog: &Catalog, resolved: &Resolved, context: &LinkContext) -> Option<Plan> {
    compile(&link(resolved, catalog, context).ok()?, &compile_options()).ok()
}

/// Every setting and parameter of every built-in pipeline: where a plan takes another value, it is the plan that
/// linking gives.
#[test]
fn a_plan_with_another_value_is_the_one_that_linking_gives() {
    let catalog = Catalog::new(Assets::new(None));
    let traits = renderer::load_scene(&catalog, "cornell-box").unwrap().traits();
    let context = LinkContext { frame: (64, 48), traits };
    let (mut taken, mut refused) = (0, 0);
    for path in catalog.pipelines().list() {
        let old = resolve(&path, catalog.pipelines(), &Overrides::default()).unwrap();
        if old.is_part() {
            continue;
        }
        let before = linked(&catalog, &old, &context).unwrap();
        for settable in old.settable(&catalog) {
            let Some(value) = another(&settable) else { continue };
            let name = format!("{path}: {} = {value}", settable.path);
            let owner = settable.path.rsplit_once('.').map(|(pass, _)| pass.to_owned());
            let pass = owner.as_deref().and_then(|pass| before.pass(pass));
            // What does not run has no values in the plan.
            let is_idle = pass.is_none()
                && before.fates.iter().any(|(known, _)| owner.as_deref() == Some(known.as_str()));
            let new = resolve(&path, catalog.pipelines(), &Overrides(vec![(settable.path, value)]));
            let Ok(new) = new else { continue };
            let after = linked(&catalog, &new, &context);
            match before.with_values(&old, &new, &catalog, &context) {
                Some(plan) => {
                    let after = after.unwrap_or_else(|| panic!("{name} links to nothing"));
                    assert_eq!(plan.structure, after.structure, "{name}");
                    assert_eq!(plan.id, after.id, "{name}");
                    assert_eq!(format!("{plan:?}"), format!("{after:?}"), "{name}");
                    taken += 1;
                }
                None => {
                    let other = after.is_none_or(|after| after.structure != before.structure);
                    assert!(other || pass.is_none(), "{name}: the plan stays the same but for values");
                    refused += u32::from(!is_idle);
                }
            }
        }
    }
    assert!(taken > refused, "most values change no size: {taken} are taken, {refused} are linked");
}

/// Pass types that note which of them are asked.
struct Asked<'a> {
    catalog: &'a Catalog,
    asked: RefCell<BTreeSet<String>>,
}

impl Asked<'_> {
    fn note(&self, kind: &str) {
        self.asked.borrow_mut().insert(kind.to_owned());
    }
}

impl PassTypes for Asked<'_> {
    fn names(&self) -> Vec<String> {
        self.catalog.names()
    }

    fn interfaces(&self) -> &[Interface] {
        PassTypes::interfaces(self.catalog)
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        self.catalog.takes_shader(kind)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        self.note(use_.kind);
        self.catalog.settings(use_)
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.note(use_.kind);
        self.catalog.ports(use_, settings)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        self.note(context.use_.kind);
        self.catalog.outputs(context)
    }
}

fn given(values: &[(&str, Value)]) -> Overrides {
    Overrides(values.iter().map(|(path, value)| ((*path).to_owned(), value.clone())).collect())
}

/// Only the pass type that reads the value is asked, and only its steps are linked again.
#[test]
fn a_value_concerns_the_passes_that_read_it() {
    let catalog = Catalog::new(Assets::new(None));
    let traits = renderer::load_scene(&catalog, "cornell-box").unwrap().traits();
    let context = LinkContext { frame: (64, 48), traits };
    let (options, name) = (compile_options(), "ism-invtm");
    let before = Compiled::new(&catalog, name, &Overrides::default(), &context, &options).unwrap();
    let exposure = given(&[("image.exposure", Value::F32(2.0))]);
    let new = resolve(name, catalog.pipelines(), &exposure).unwrap();
    let asked = Asked { catalog: &catalog, asked: RefCell::default() };
    before.plan.with_values(&before.resolved, &new, &asked, &context).expect("it changes no size");
    assert_eq!(asked.asked.into_inner(), BTreeSet::from(["composite".to_owned()]));

    let after = before.with_overrides(&catalog, name, &exposure, &context, &options).unwrap();
    let whole = Compiled::new(&catalog, name, &exposure, &context, &options).unwrap();
    assert_eq!(after.plan.id, whole.plan.id);
    for ((pass, before), after) in after.plan.passes.iter().zip(&before.steps).zip(&after.steps) {
        let kept = before.len() == after.len() && before.iter().zip(after).all(|(a, b)| Arc::ptr_eq(a, b));
        assert_eq!(kept, pass.kind != *"composite", "{}", pass.name);
    }
    // Sizes follow from the number of lights: all is linked, and the steps are for them.
    let lights = given(&[("lights", Value::U32(64))]);
    let after = after.with_overrides(&catalog, name, &lights, &context, &options).unwrap();
    let whole = Compiled::new(&catalog, name, &lights, &context, &options).unwrap();
    assert_eq!((after.plan.id, after.steps.len()), (whole.plan.id, whole.steps.len()));
    assert_ne!(after.plan.structure, before.plan.structure);
}

/// A value that is refused replaces nothing; one that is taken is seen in the next frame.
#[test]
fn a_value_is_seen_and_one_out_of_range_is_not() {
    let Some((mut renderer, _folder)) = renderer() else { return };
    assert_eq!(counted(&mut renderer), [1.0, 0.0]);
    let error = renderer.set_value("count.step", Value::F32(10.0)).unwrap_err().to_string();
    assert!(error.contains("`step` is from 0 to 9"), "{error}");
    assert!(renderer.set_value("count.stop", Value::F32(1.0)).is_err(), "there is no such setting");
    assert_eq!(counted(&mut renderer), [2.0, 1.0], "the past goes on");
    let report = renderer.set_value("count.step", Value::F32(5.0)).unwrap();
    assert_eq!((report.kept, report.pipelines, report.steps), (true, 0, 0));
    assert_eq!(counted(&mut renderer)[0], 7.0);
}
