//! What a shader declares of itself: ports, what is exact in their place, and options, which its conditions read.

use super::{Composer, given};
use crate::codes;
use crate::composed::ShaderOption;
use crate::directive::{Condition, Define, Fault, OptionValues, Placed};
use crate::exact::DeclaredExact;
use crate::line_map::span;
use crate::port::DeclaredPort;
use data_file::{Source, nearest};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// The most options of a shader, and the most values that one lists; sixty-four variants are more than can be checked.
const MAX_CHOICES: usize = 256;

impl Composer<'_> {
    /// Declares a port.
    pub(super) fn port(
        &mut self,
        input: bool,
        port: DeclaredPort,
        name: Range<usize>,
        line: Range<usize>,
    ) -> Result<(), Fault> {
        let others = self.outline.inputs.iter().chain(&self.outline.outputs);
        if let Some(other) = others.into_iter().find(|other| other.name == port.name) {
            let message = format!("the port `{}` is declared twice", port.name);
            let fault = Fault::new(&codes::DIRECTIVE, name, message);
            return Err(fault.note(format!("first declared at {}", other.place)));
        }
        let all = if input { &mut self.outline.inputs } else { &mut self.outline.outputs };
        if all.len() >= MAX_CHOICES {
            let message = format!("there are more than {MAX_CHOICES} ports");
            return Err(Fault::new(&codes::EXTENT, line, message));
        }
        all.push(port);
        Ok(())
    }

    /// Declares what is exact.
    pub(super) fn exact(
        &mut self,
        Placed { value, range }: Placed<DeclaredExact>,
        line: Range<usize>,
    ) -> Result<(), Fault> {
        let all = &mut self.outline.exact;
        if let Some(other) = all.iter().find(|other| other.name == value.name) {
            let message = format!("what is exact in place of `{}` is declared twice", value.name);
            return Err(Fault::new(&codes::DIRECTIVE, range, message)
                .note(format!("first declared at {}", other.place)));
        }
        if all.len() >= MAX_CHOICES {
            let message = format!("there are more than {MAX_CHOICES} approximations");
            return Err(Fault::new(&codes::EXTENT, line, message));
        }
        all.push(value);
        Ok(())
    }

    /// Declares an option.
    pub(super) fn option(
        &mut self,
        name: Placed<String>,
        OptionValues { default, one_of, auto }: OptionValues,
        (internal, doc): (bool, String),
        source: &Arc<Source>,
        line: Range<usize>,
    ) -> Result<(), Fault> {
        if let Some(odd) = one_of.iter().find(|value| !value.value.same_type(&default.value)) {
            let message = format!(
                "`{}` is {}; the default is {}",
                odd.value,
                odd.value.type_name(),
                default.value.type_name()
            );
            return Err(Fault::new(&codes::OPTION, odd.range.clone(), message));
        }
        let one_of: Vec<Define> = one_of.into_iter().map(|value| value.value).collect();
        let listed = |value: &Define| one_of.is_empty() || one_of.contains(value);
        let list = || one_of.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        if !listed(&default.value) {
            let message = format!("the default `{}` is not one of {}", default.value, list());
            return Err(Fault::new(&codes::OPTION, default.range, message));
        }
        if let Some((odd, _)) = auto.iter().find(|(value, _)| !one_of.contains(&value.value)) {
            let message = format!("`auto` means one of {}, and `{}` is none", list(), odd.value);
            return Err(Fault::new(&codes::OPTION, odd.range.clone(), message));
        }
        let auto = auto.map(|(value, name)| (value.value, name));
        if let Some(other) = self.outline.options.iter_mut().find(|other| other.name == name.value) {
            if other.default == default.value && other.one_of == one_of && other.auto == auto {
                other.internal |= internal;
                return Ok(());
            }
            return Err(Fault::new(
                &codes::OPTION,
                line,
                format!("the option `{}` is declared twice, and differently", name.value),
            )
            .note(format!("first declared at {}", other.place)));
        }
        if self.outline.options.len() >= MAX_CHOICES || one_of.len() > MAX_CHOICES {
            let what = if one_of.len() > MAX_CHOICES { "values of an option" } else { "options" };
            return Err(Fault::new(
                &codes::EXTENT,
                line,
                format!("there are more than {MAX_CHOICES} {what}"),
            ));
        }
        let place = span(source, line.clone());
        let compared = BTreeSet::new();
        let given = self.request.defines.get(&name.value);
        let wrong = match given {
            Some(value) if !value.same_type(&default.value) => Some(format!(
                "the option `{}` is {}; `{value}` was given",
                name.value,
                default.value.type_name()
            )),
            Some(value) if !listed(value) => {
                Some(format!("the option `{}` is one of {}; `{value}` was given", name.value, list()))
            }
            _ => None,
        };
        self.outline.options.push(ShaderOption {
            name: name.value,
            default: default.value,
            one_of,
            internal,
            auto,
            doc,
            place,
            compared,
        });
        wrong.map_or(Ok(()), |message| Err(Fault::new(&codes::OPTION, line, message)))
    }

    /// Returns whether the condition of an `#if` holds.
    pub(super) fn condition(&mut self, condition: &Condition) -> Result<bool, Fault> {
        let request = self.request;
        let options = &mut self.outline.options;
        condition.holds(&mut |name, compared| {
            let Some(index) = options.iter().position(|option| option.name == name.value) else {
                let fault = Fault::new(
                    &codes::CONDITION,
                    name.range.clone(),
                    format!("no option `{}` is declared", name.value),
                );
                return Err(match nearest(&name.value, options.iter().map(|option| option.name.as_str())) {
                    Some(near) => fault.note(format!("did you mean `{near}`?")),
                    None => {
                        fault.note(format!("declare it before this line: `#option {} false`", name.value))
                    }
                });
            };
            let option = &mut options[index];
            if let Some(value) = compared {
                if !value.value.same_type(&option.default) {
                    let message = format!(
                        "`{}` is {}; `{}` is {}",
                        name.value,
                        option.default.type_name(),
                        value.value,
                        value.value.type_name()
                    );
                    return Err(Fault::new(&codes::CONDITION, value.range.clone(), message));
                }
                if !option.one_of.is_empty() && !option.one_of.contains(&value.value) {
                    let message = format!("`{}` is never `{}`", name.value, value.value);
                    let list: Vec<String> = option.one_of.iter().map(ToString::to_string).collect();
                    return Err(Fault::new(&codes::CONDITION, value.range.clone(), message)
                        .note(format!("it is one of {}", list.join(", "))));
                }
                option.compared.insert(value.value.clone());
            }
            Ok(given(request, option).clone())
        })
    }
}
