//! Transforms of pbrt.

use data_file::{Diagnostic, Span};
use glam::{DMat4, DQuat, DVec3};

use super::tokens::{Found, Token, Tokens, number};
use super::{DIRECTIVES, Scene, quoted};
use crate::codes;
use crate::error::SceneError;
use crate::offline::report::{error, located, shortened, unknown};
use crate::offline::view::look_at;

impl Scene<'_> {
    /// Changes the transform of what follows.
    pub(super) fn transform(
        &mut self,
        directive: &str,
        span: &Span,
        tokens: &mut Tokens,
    ) -> Result<(), SceneError> {
        let before = self.state.transform;
        let made = match directive {
            "Identity" => DMat4::IDENTITY,
            "Translate" => before * DMat4::from_translation(numbers::<3>(tokens, span)?.into()),
            "Scale" => before * DMat4::from_scale(numbers::<3>(tokens, span)?.into()),
            "Rotate" => {
                let [degrees, x, y, z] = numbers::<4>(tokens, span)?;
                let Some(axis) = DVec3::new(x, y, z).try_normalize() else {
                    return Err(error(
                        &codes::VALUE,
                        span,
                        "the axis of a rotation has a length above 0",
                        "this axis",
                    ));
                };
                before * DMat4::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
            }
            "LookAt" => {
                let [ex, ey, ez, lx, ly, lz, ux, uy, uz] = numbers::<9>(tokens, span)?;
                let [eye, at, up] = [[ex, ey, ez], [lx, ly, lz], [ux, uy, uz]].map(DVec3::from);
                let camera = look_at(eye, at, Some(up)).ok_or_else(|| {
                    let message = "the camera looks at its own position, or along its `up`";
                    error(&codes::CONFLICT, span, message, "this view")
                })?;
                before * camera.inverse()
            }
            "Transform" => DMat4::from_cols_array(&numbers::<16>(tokens, span)?),
            "ConcatTransform" => before * DMat4::from_cols_array(&numbers::<16>(tokens, span)?),
            "CoordinateSystem" => {
                let (name, _) = quoted(tokens, span)?;
                self.systems.insert(name, before);
                before
            }
            "CoordSysTransform" => {
                let (name, place) = quoted(tokens, span)?;
                let known = self.systems.keys().map(String::as_str);
                let system = self.systems.get(&name);
                *system.ok_or_else(|| {
                    unknown(&place, ("coordinate system", "coordinate systems"), &name, known)
                })?
            }
            "ActiveTransform" => {
                let which = tokens.take()?;
                let at_start = match &which {
                    Some((Token::Word(word), _)) if word == "All" || word == "StartTime" => true,
                    Some((Token::Word(word), _)) if word == "EndTime" => false,
                    _ => {
                        let message = "expected `All`, `StartTime` or `EndTime`";
                        return Err(error(&codes::FORMAT, span, message, "behind this"));
                    }
                };
                if !at_start {
                    self.collector.report.note(span, "movement during the exposure is left out");
                }
                self.state.at_start = at_start;
                before
            }
            "TransformTimes" => {
                numbers::<2>(tokens, span)?;
                before
            }
            _ => {
                let message = format!("there is no directive `{}`", shortened(directive));
                let unknown = Diagnostic::new(&codes::FORMAT, message).label(span.clone(), "not known");
                return Err(located(unknown.suggest("directives", directive, DIRECTIVES)));
            }
        };
        if self.state.at_start {
            self.state.transform = made;
        }
        Ok(())
    }
}

/// Takes numbers, with or without brackets around them.
fn numbers<const N: usize>(tokens: &mut Tokens, behind: &Span) -> Result<[f64; N], SceneError> {
    let bracketed = matches!(tokens.peek()?, Some((Token::Open, _)));
    if bracketed {
        tokens.take()?;
    }
    let wrong = |found: Option<Found>| {
        let span = found.map_or_else(|| behind.clone(), |(_, span)| span);
        error(&codes::VALUE, &span, format!("expected {N} numbers"), "another number of values")
    };
    let mut numbers = [0.0; N];
    for slot in &mut numbers {
        match tokens.take()? {
            Some((Token::Word(word), span)) => *slot = number(&word, &span)?,
            other => return Err(wrong(other)),
        }
    }
    match bracketed.then(|| tokens.take()).transpose()?.flatten() {
        Some((Token::Close, _)) => Ok(numbers),
        other if bracketed => Err(wrong(other)),
        _ => Ok(numbers),
    }
}
