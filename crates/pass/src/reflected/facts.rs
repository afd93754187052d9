//! The facts of the outputs of a user's shader: what the use says of them, else what its inputs hand on.

use super::outputs::COUNT;
use crate::{Interface, OutputContext, PassTypeError, Value};
use frame_graph::port::{Facts, InputDesc, OutputOverride};

/// Returns the facts of an output but for those that its directive gives. Of one that no directive declares and that is offered as an interface, each fact is that which the use says with
/// `out:`; else that of the linked inputs of the same interface, which must agree on it. `count` is that of the buffers
/// of the output, where it is known.
///
/// # Errors
/// Facts that the interface does not declare, and inputs that disagree.
pub(super) fn of_output(
    interface: Option<&Interface>,
    port: &str,
    said: Option<&OutputOverride>,
    is_declared: bool,
    count: Option<u32>,
    cx: &OutputContext<'_>,
) -> Result<Facts, PassTypeError> {
    let counted = |name: &str| count.filter(|_| name == COUNT.name).map(Value::U32);
    let Some(interface) = interface else {
        if said.is_some_and(|said| !said.facts.is_empty()) {
            let message = format!("`out:` gives facts to `{port}`, which is no interface");
            return Err(PassTypeError::output(port, message).help("name one: Out(interface: \"…\", …)"));
        }
        return Ok(counted(COUNT.name).map(|count| (COUNT.name, count)).into_iter().collect());
    };
    if let Some(said) = said {
        check_said(interface, port, said)?;
    }
    let of_interface = cx.inputs.iter().filter(|input| input.interface == interface.name);
    let inputs: Vec<&InputDesc> = of_interface.collect();
    let mut facts = Facts::default();
    for fact in interface.facts {
        let stated = said.and_then(|said| said.facts.get(fact.name));
        let value = match (stated, counted(fact.name)) {
            (Some(stated), _) => stated.clone().and_then(|value| value.convert(fact.ty)),
            (None, Some(count)) => Some(count),
            (None, None) if is_declared => None,
            (None, None) => handed_on(port, interface.name, fact.name, &inputs)?.cloned(),
        };
        if let Some(value) = value {
            facts.insert(fact.name, value);
        }
    }
    Ok(facts)
}

/// Checks that an output has every fact that its interface promises.
pub(super) fn check_required(
    interface: Option<&Interface>,
    port: &str,
    facts: &Facts,
) -> Result<(), PassTypeError> {
    let Some(interface) = interface else { return Ok(()) };
    let missing = interface.facts.iter().find(|fact| !fact.optional && facts.get(fact.name).is_none());
    let Some(fact) = missing else { return Ok(()) };
    let (name, fact, doc) = (interface.name, fact.name, fact.doc);
    let message = format!("`{port}` is offered as `{name}`, but nothing gives its fact `{fact}`, {doc}");
    Err(PassTypeError::output(port, message).help(format!(
        "link an input that is a `{name}`, or say it: out: {{ \"{port}\": Out(facts: {{ \"{fact}\": … }}) }}"
    )))
}

/// Checks what `out:` says of facts against what the interface declares.
fn check_said(interface: &Interface, port: &str, said: &OutputOverride) -> Result<(), PassTypeError> {
    for (name, value) in &said.facts {
        let Some(declared) = interface.fact(name) else {
            let message = format!(
                "`out:` gives `{port}` the fact `{name}`, which the interface `{}` does not declare",
                interface.name
            );
            let names = interface.facts.iter().map(|fact| fact.name);
            return Err(PassTypeError::output(port, message).help(super::instead(
                name,
                "it declares",
                names,
            )));
        };
        if said.count.is_some() && *name == COUNT.name {
            let message = format!("`out:` says the count of `{port}` twice, as `count` and as a fact");
            return Err(PassTypeError::output(port, message).help("leave the fact out: it is the `count`"));
        }
        if let Some(value) = value
            && value.clone().convert(declared.ty).is_none()
        {
            let message = format!(
                "`out:` gives `{port}` the fact `{name}` as {value}; the interface `{}` declares it as {}",
                interface.name,
                declared.ty.with_article()
            );
            return Err(PassTypeError::output(port, message));
        }
    }
    Ok(())
}

/// The fact that the inputs agree on; `None` where none has it.
fn handed_on<'a>(
    port: &str,
    interface: &str,
    fact: &str,
    inputs: &[&'a InputDesc],
) -> Result<Option<&'a Value>, PassTypeError> {
    let Some((first, others)) = inputs.split_first() else { return Ok(None) };
    let value = first.facts.get(fact);
    let Some(other) = others.iter().find(|other| other.facts.get(fact) != value) else { return Ok(value) };
    let shown = |value: Option<&Value>| value.map_or("none".to_owned(), ToString::to_string);
    let message = format!(
        "`{port}` is a `{interface}` as its inputs `{}` and `{}` are, which differ in the fact `{fact}`: {} and {}",
        first.name,
        other.name,
        shown(value),
        shown(other.facts.get(fact))
    );
    let example = value.or(other.facts.get(fact)).map_or("None".to_owned(), ToString::to_string);
    Err(PassTypeError::output(port, message).help(format!(
        "say which the output has, or `None`: out: {{ \"{port}\": Out(facts: {{ \"{fact}\": {example} }}) }}"
    )))
}
