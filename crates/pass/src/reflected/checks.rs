//! Checks of what is linked to the inputs of a pass, and of what its shaders write, against directives and interfaces.

use super::outputs::COUNT;
use super::written::Written;
use super::{instead, list};
use crate::{Interface, OutputContext, PassTypeError};
use shader_library::DeclaredPort;

/// The error that a directive gives something that is neither a size nor a fact.
pub(super) fn unknown_fact(
    declared: &DeclaredPort,
    name: &str,
    interface: Option<&Interface>,
) -> PassTypeError {
    let argument = declared.arguments.iter().find(|argument| argument.name == name);
    let place = argument.map_or(&declared.place, |argument| &argument.place);
    let interface_name = &declared.interface;
    let message = format!("{place}: `{name}` is no fact of the interface `{interface_name}`, and no size");
    let facts = interface.map_or(&[][..], |interface| interface.facts);
    let known = facts.iter().map(|fact| fact.name).chain(["count", "size", "layers"]);
    PassTypeError::new(message).help(instead(name, "there are", known))
}

/// Checks that what is linked to an input has the members and facts that it is declared `with`, and not the members that
/// it is declared `without`.
pub(super) fn check_members_of_input(
    declared: &DeclaredPort,
    interfaces: &[Interface],
    outputs: &OutputContext<'_>,
) -> Result<(), PassTypeError> {
    let name = &declared.name;
    let Some(input) = outputs.input(name) else { return Ok(()) };
    let interface = interfaces.iter().find(|known| known.name == declared.interface);
    let is_fact = |name: &str| interface.is_some_and(|interface| interface.fact(name).is_some());
    let (facts, members): (Vec<&String>, Vec<&String>) = declared.with.iter().partition(|name| is_fact(name));
    if let Some(fact) = facts.into_iter().find(|fact| input.facts.get(fact).is_none()) {
        return Err(PassTypeError::no_fact(name, fact).help(&*declared.doc));
    }
    let refused = |message, help| Err(PassTypeError::input(name, message).help(help));
    if let Some(member) = members.into_iter().find(|member| input.member(member).is_none()) {
        let message = format!("what is linked to `{name}` lacks the member `{member}`");
        return refused(message, format!("link a pass that gives `{member}`, or take this pass out"));
    }
    if let Some(member) = declared.without.iter().find(|member| input.member(member).is_some()) {
        let message = format!("what is linked to `{name}` has the member `{member}` already");
        return refused(
            message,
            "let one such pass stand between what makes it and what reads it".to_owned(),
        );
    }
    Ok(())
}

/// Checks that an input that is declared `like` another has its size, or as many elements.
pub(super) fn check_like(declared: &DeclaredPort, outputs: &OutputContext<'_>) -> Result<(), PassTypeError> {
    let Some(other) = &declared.like else { return Ok(()) };
    let (Some(input), Some(like)) = (outputs.input(&declared.name), outputs.input(other)) else {
        return Ok(());
    };
    let shape = |input: &frame_graph::port::InputDesc| {
        let textures = input.members.iter().filter_map(|(_, desc)| desc.texture());
        // Some members have a texel for a block of those of others.
        let texture = textures.max_by_key(|texture| texture.size).map(|texture| {
            let layers = if texture.array { format!("×{}", texture.layers) } else { String::new() };
            format!("{}×{}{layers}", texture.size.0, texture.size.1)
        });
        texture.or_else(|| COUNT.of(&input.facts).map(|count| format!("{count} elements")))
    };
    match (shape(input), shape(like)) {
        (Some(found), Some(expected)) if found != expected => {
            let (name, verb) = (&declared.name, if found.ends_with("elements") { "has" } else { "is" });
            let error = PassTypeError::input(
                name,
                format!("`{name}` {verb} {found}, but `{other}` {verb} {expected}"),
            );
            // The user may have given no size: `check` takes one of its own.
            let (width, height) = outputs.frame;
            Err(error.help(format!("the sizes are those of a frame of {width}×{height} px")))
        }
        _ => Ok(()),
    }
}

/// Checks that what is written as a port is what its interface wants.
pub(super) fn check_members(
    interfaces: &[Interface],
    port: &str,
    interface: &str,
    members: &[(&str, &Written)],
) -> Result<(), PassTypeError> {
    let Some(known) = interfaces.iter().find(|known| known.name == interface) else {
        if interface == "Texture" || interface == "Buffer" {
            return match members {
                [("", _)] => Ok(()),
                _ => Err(PassTypeError::new(format!(
                    "the output `{port}` has several members, so `out:` must name its interface"
                ))),
            };
        }
        let all = list(interfaces.iter().map(|known| known.name));
        return Err(PassTypeError::new(format!(
            "`out:` offers `{port}` as `{interface}`, which is no interface"
        ))
        .help(format!("there are {all}")));
    };
    let global = |member: &str| if member.is_empty() { port.to_owned() } else { format!("{port}_{member}") };
    for (member, written) in members {
        if !known.members.iter().any(|m| m.name == *member) {
            let names = list(known.members.iter().map(|m| global(m.name)));
            return Err(PassTypeError::new(format!("`{}` is no member of a `{interface}`", written.name))
                .help(format!("its members would be written as {names}")));
        }
    }
    for member in known.members.iter().filter(|m| !m.optional) {
        if !members.iter().any(|(name, _)| *name == member.name) {
            return Err(PassTypeError::new(format!(
                "`{port}` lacks a member of a `{interface}`: the shader does not write `{}`",
                global(member.name)
            )));
        }
    }
    Ok(())
}
