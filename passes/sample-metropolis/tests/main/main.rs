//! Independent Metropolis-Hastings: proposals, distribution, weights, the shader against its CPU reference, extremes.

mod chains;
mod cpu_reference;
mod expectation;
mod gpu;
mod proposals;

use pass::{Use, UseContext, Value};
use sample_metropolis::PASS;
use std::collections::BTreeMap;

pass_test::shaders_are_valid!(PASS);

#[test]
fn chains_of_no_step_are_refused() {
    let shaders = pass_test::shaders();
    let use_ = Use { kind: "sample-metropolis", shader: None, inputs: &[], outputs: &BTreeMap::new() };
    let settings =
        PASS.settings(&UseContext { use_, shaders: &shaders, interfaces: interfaces::INTERFACES }).unwrap();
    let check = |name: &str, value: u32| {
        let setting = settings.iter().find(|setting| setting.name == name).unwrap();
        setting.check(Value::U32(value)).map_err(|misfit| format!("{misfit:?}"))
    };
    assert_eq!(check("steps", 0).unwrap_err(), "Range(\"`steps` is from 1 to 1024, and 0 is not\")");
    assert!(check("count", 0).is_err() && check("steps", 1025).is_err());
    // The numbers of elements stay within 32 bits at the most of both.
    assert!(check("count", 1 << 21).is_ok() && check("steps", 1 << 10).is_ok());
    assert_eq!(settings[1].default, Value::U32(5), "TCAS: more than 4");
}
