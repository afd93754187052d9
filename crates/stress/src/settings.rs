//! Cases from the declarations of settings: both ends of their ranges, and pairs of them.

use crate::case::{Case, Expect};
use frame_graph::resolve::Settable;
use frame_graph::{Value, ValueType};

/// Returns the extreme values of a setting other than its own: the least and greatest number, the other boolean, the other
/// choices.
fn ends(settable: &Settable) -> Vec<Value> {
    let setting = &settable.setting;
    let number = |end: f64| match setting.ty {
        ValueType::U32 => Some(Value::U32(end as u32)),
        ValueType::F32 => Some(Value::F32(end as f32)),
        _ => None,
    };
    let mut all: Vec<Value> = if !setting.one_of.is_empty() {
        setting.one_of.clone()
    } else if setting.ty == ValueType::Bool {
        vec![Value::Bool(false), Value::Bool(true)]
    } else {
        [setting.min, setting.max].into_iter().flatten().filter_map(number).collect()
    };
    all.retain(|value| *value != settable.value);
    all.dedup();
    all
}

/// Returns a case for each end of the range of each setting of a pipeline. The picture must be finite and not negative;
/// nothing else is known.
pub fn of_settings(settable: &[Settable]) -> Vec<Case> {
    let of = |settable: &Settable| {
        let path = settable.path.clone();
        ends(settable).into_iter().map(move |value| one(&[(path.clone(), value)]))
    };
    settable.iter().flat_map(of).collect()
}

/// Returns cases of two settings at an end of each, drawn at random.
pub fn of_pairs(settable: &[Settable], count: usize, seed: u64) -> Vec<Case> {
    let all: Vec<(usize, String, Value)> = settable
        .iter()
        .enumerate()
        .flat_map(|(i, settable)| {
            ends(settable).into_iter().map(move |value| (i, settable.path.clone(), value))
        })
        .collect();
    let mut random = fastrand::Rng::with_seed(seed);
    let mut cases: Vec<Case> = Vec::new();
    // Few settings have few pairs.
    for _ in 0..count * 8 {
        if cases.len() == count || all.is_empty() {
            break;
        }
        let [a, b] = [(); 2].map(|()| &all[random.usize(..all.len())]);
        if a.0 < b.0 {
            let case = one(&[(a.1.clone(), a.2.clone()), (b.1.clone(), b.2.clone())]);
            if !cases.contains(&case) {
                cases.push(case);
            }
        }
    }
    cases
}

fn one(values: &[(String, Value)]) -> Case {
    let texts: Vec<String> =
        values.iter().map(|(path, value)| format!("{path}={}", value.to_argument())).collect();
    let group = if values.len() > 1 { "pairs of settings" } else { "settings" };
    let set = values.iter().map(|(path, value)| (path.clone(), value.to_argument())).collect();
    let about = format!("`{}`.", texts.join("`, `"));
    Case { set, ..Case::new(group, &texts.join(","), about, Expect::Finite) }
}
