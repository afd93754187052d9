//! The values within a plugin of Mitsuba.

use data_file::{Diagnostic, Span};
use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};
use metrics::linear_from_srgb;

use super::tree::Element;
use crate::codes;
use crate::error::SceneError;
use crate::offline::report::{Report, error, located, shortened};
use crate::offline::spectrum::Spectrum;
use crate::offline::view::look_at;

/// The use of a spectrum.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Usage {
    Reflectance,
    Light,
}

impl Element {
    /// Returns the value of this name, which must have one of these tags.
    pub(super) fn value(&self, name: &str, tags: &[&str]) -> Result<Option<&Element>, SceneError> {
        let mut named = self.children.iter().filter(|child| child.attribute("name") == Some(name));
        let Some(found) = named.next() else { return Ok(None) };
        if let Some(again) = named.next() {
            let twice = Diagnostic::new(&codes::VALUE, format!("`{}` is given twice", shortened(name)));
            return Err(located(twice.label(again.span.clone(), "again").label(found.span.clone(), "first")));
        }
        found.used.set(true);
        if !tags.contains(&found.tag.as_str()) {
            let expected: Vec<String> = tags.iter().map(|tag| format!("`<{tag}>`")).collect();
            let message = format!(
                "expected {} for `{name}`, found `<{}>`",
                expected.join(" or "),
                shortened(&found.tag)
            );
            return Err(error(&codes::VALUE, &found.span, message, "of another type"));
        }
        Ok(Some(found))
    }

    /// Marks values as used that change nothing here.
    pub(super) fn ignore(&self, names: &[&str]) {
        let is_one = |child: &&Element| child.attribute("name").is_some_and(|name| names.contains(&name));
        self.children.iter().filter(is_one).for_each(|child| child.used.set(true));
    }

    /// Notes the values that nothing asked for.
    pub(super) fn note_unused(&self, report: &mut Report<'_>) {
        let (tag, kind) = (shortened(&self.tag), shortened(self.attribute("type").unwrap_or_default()));
        for child in self.children.iter().filter(|child| !child.used.get()) {
            let inner = match (child.attribute("name"), child.attribute("type")) {
                (Some(name), _) => format!("`{}`", shortened(name)),
                (None, Some(kind)) => format!("`<{} type=\"{}\">`", shortened(&child.tag), shortened(kind)),
                (None, None) => format!("`<{}>`", shortened(&child.tag)),
            };
            report.note(&child.span, format!("{tag} `{kind}`: {inner} is not supported: it is left out"));
        }
    }

    /// Returns the numbers of an attribute, which are between spaces or commas.
    fn list(&self, name: &str) -> Result<Vec<f64>, SceneError> {
        let (text, place) = (self.required(name)?, self.place(name));
        let words = text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|word| !word.is_empty());
        words.map(|word| number(word, place)).collect()
    }

    fn number_of(&self, name: &str) -> Result<Option<f64>, SceneError> {
        self.attribute(name).map(|text| number(text.trim(), self.place(name))).transpose()
    }

    /// Returns a `<float>` or `<integer>`.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, SceneError> {
        match self.value(name, &["float", "integer"])? {
            None => Ok(None),
            Some(found) => number(found.required("value")?.trim(), found.place("value")).map(Some),
        }
    }

    /// Returns a number, or another one if it is not there.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, SceneError> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    /// Returns a `<string>`.
    pub(super) fn text(&self, name: &str) -> Result<Option<(&str, &Span)>, SceneError> {
        match self.value(name, &["string"])? {
            None => Ok(None),
            Some(found) => Ok(Some((found.required("value")?, found.place("value")))),
        }
    }

    /// Returns the name of a file, which must be there.
    pub(super) fn file(&self) -> Result<(&str, &Span), SceneError> {
        self.text("filename")?.ok_or_else(|| {
            let message = format!("`<{}>` has no `<string name=\"filename\">`", shortened(&self.tag));
            error(&codes::VALUE, &self.span, message, "this element")
        })
    }

    /// Returns a `<boolean>`, or another one if it is not there.
    pub(super) fn flag(&self, name: &str, default: bool) -> Result<bool, SceneError> {
        let Some(found) = self.value(name, &["boolean"])? else { return Ok(default) };
        match found.required("value")?.to_ascii_lowercase().as_str() {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(error(&codes::VALUE, found.place("value"), "expected `true` or `false`", "neither")),
        }
    }

    /// Returns a `<point>` or a `<vector>`.
    pub(super) fn vector(&self, name: &str) -> Result<Option<DVec3>, SceneError> {
        self.value(name, &["point", "vector"])?.map(|found| found.three(0.0)).transpose()
    }

    /// Returns three numbers, as `value` or as `x`, `y` and `z`.
    fn three(&self, default: f64) -> Result<DVec3, SceneError> {
        if self.attribute("value").is_some() {
            return match self.list("value")?[..] {
                [x, y, z] => Ok(DVec3::new(x, y, z)),
                [all] => Ok(DVec3::splat(all)),
                ref list => Err(count(self, "value", "3", list.len())),
            };
        }
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.number_of(axis));
        Ok(DVec3::new(x?.unwrap_or(default), y?.unwrap_or(default), z?.unwrap_or(default)))
    }

    /// Returns a color: `<rgb>`, `<spectrum>` or `<float>`.
    pub(super) fn color(
        &self,
        name: &str,
        usage: Usage,
        report: &mut Report<'_>,
    ) -> Result<Option<Vec3>, SceneError> {
        match self.value(name, &["rgb", "spectrum", "float"])? {
            None => Ok(None),
            Some(found) => found.as_color(usage, report).map(Some),
        }
    }

    /// Returns the color that this element is.
    pub(super) fn as_color(&self, usage: Usage, report: &mut Report<'_>) -> Result<Vec3, SceneError> {
        match self.tag.as_str() {
            "rgb" => self.as_rgb(),
            "float" => {
                Ok(DVec3::splat(number(self.required("value")?.trim(), self.place("value"))?).as_vec3())
            }
            _ => self.as_spectrum(usage, report),
        }
    }

    fn as_rgb(&self) -> Result<Vec3, SceneError> {
        let text = self.required("value")?.trim();
        if let Some(hex) = text.strip_prefix('#') {
            let byte =
                |i: usize| hex.get(2 * i..2 * i + 2).and_then(|byte| u8::from_str_radix(byte, 16).ok());
            return match (hex.len(), byte(0), byte(1), byte(2)) {
                (6, Some(r), Some(g), Some(b)) => {
                    Ok(Vec3::from([r, g, b].map(|byte| linear_from_srgb(f32::from(byte) / 255.0))))
                }
                _ => Err(error(
                    &codes::VALUE,
                    self.place("value"),
                    "expected a color such as #a0b1c2",
                    "no color",
                )),
            };
        }
        match self.list("value")?[..] {
            [r, g, b] => Ok(DVec3::new(r, g, b).as_vec3()),
            [all] => Ok(DVec3::splat(all).as_vec3()),
            ref list => Err(count(self, "value", "1 or 3", list.len())),
        }
    }

    fn as_spectrum(&self, usage: Usage, report: &mut Report<'_>) -> Result<Vec3, SceneError> {
        let mut pairs = Vec::new();
        if self.attribute("filename").is_some() {
            let source = report.text(self.required("filename")?, self.place("filename"))?;
            for line in source.text.lines() {
                let line = line.split('#').next().unwrap_or_default();
                let mut words = line.split_ascii_whitespace();
                match (words.next(), words.next()) {
                    (Some(wavelength), Some(value)) => {
                        let place = self.place("filename");
                        pairs.push([number(wavelength, place)?, number(value, place)?]);
                    }
                    (None, _) => {}
                    _ => {
                        let message = "each line of a spectrum has a wavelength and a value";
                        return Err(error(&codes::VALUE, self.place("filename"), message, "this file"));
                    }
                }
            }
        } else {
            let (text, place) = (self.required("value")?, self.place("value"));
            if !text.contains(':') {
                let value = number(text.trim(), place)?;
                return Ok(match usage {
                    Usage::Reflectance => DVec3::splat(value).as_vec3(),
                    // Its color is not that of D65, the white of Rec. 709.
                    Usage::Light => Spectrum::uniform(value).emission(),
                });
            }
            for word in
                text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|word| !word.is_empty())
            {
                let Some((wavelength, value)) = word.split_once(':') else {
                    let message = format!("expected `wavelength:value`, found `{}`", shortened(word));
                    return Err(error(&codes::VALUE, place, message, "no spectrum"));
                };
                pairs.push([number(wavelength, place)?, number(value, place)?]);
            }
        }
        let Some(spectrum) = Spectrum::new(pairs) else {
            let message = "a spectrum has pairs of a wavelength in nm, rising, and a value";
            return Err(error(&codes::VALUE, &self.span, message, "no spectrum"));
        };
        Ok(match usage {
            Usage::Reflectance => spectrum.reflectance(),
            Usage::Light => spectrum.emission(),
        })
    }

    /// Returns a `<transform>`; the identity if it is not there.
    pub(super) fn transform(&self, name: &str) -> Result<DMat4, SceneError> {
        let Some(found) = self.value(name, &["transform"])? else { return Ok(DMat4::IDENTITY) };
        let mut transform = DMat4::IDENTITY;
        // What stands first comes first.
        for step in &found.children {
            transform = step.as_step()? * transform;
        }
        Ok(transform)
    }

    fn as_step(&self) -> Result<DMat4, SceneError> {
        match self.tag.to_ascii_lowercase().as_str() {
            "translate" => Ok(DMat4::from_translation(self.three(0.0)?)),
            "scale" => Ok(DMat4::from_scale(self.three(1.0)?)),
            "rotate" => {
                let degrees = number(self.required("angle")?.trim(), self.place("angle"))?;
                let Some(axis) = self.three(0.0)?.try_normalize() else {
                    return Err(error(
                        &codes::VALUE,
                        &self.span,
                        "the axis of a rotation has a length above 0",
                        "no axis",
                    ));
                };
                Ok(DMat4::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians())))
            }
            "matrix" => match self.list("value")?[..] {
                [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] => {
                    let rows = [[a, b, c, d], [e, f, g, h], [i, j, k, l], [m, n, o, p]];
                    Ok(DMat4::from_cols_array_2d(&rows).transpose())
                }
                [a, b, c, d, e, f, g, h, i] => {
                    let columns =
                        [[a, d, g], [b, e, h], [c, f, i]].map(|column| DVec3::from(column).extend(0.0));
                    Ok(DMat4::from_cols(columns[0], columns[1], columns[2], DVec4::W))
                }
                ref list => Err(count(self, "value", "16 or 9", list.len())),
            },
            "lookat" => {
                let point = |name: &str| -> Result<Option<DVec3>, SceneError> {
                    if self.attribute(name).is_none() {
                        return Ok(None);
                    }
                    match self.list(name)?[..] {
                        [x, y, z] => Ok(Some(DVec3::new(x, y, z))),
                        ref list => Err(count(self, name, "3", list.len())),
                    }
                };
                let missing = |name: &str| {
                    error(
                        &codes::FORMAT,
                        &self.span,
                        format!("`<lookat>` has no attribute `{name}`"),
                        "this element",
                    )
                };
                let origin = point("origin")?.ok_or_else(|| missing("origin"))?;
                let target = point("target")?.ok_or_else(|| missing("target"))?;
                look_at(origin, target, point("up")?).ok_or_else(|| {
                    let message = "it looks at its own position, or along its `up`";
                    error(&codes::CONFLICT, &self.span, message, "this view")
                })
            }
            tag => {
                let message = format!("there is no step `<{}>` of transforms", shortened(tag));
                let unknown = Diagnostic::new(&codes::FORMAT, message).label(self.span.clone(), "not known");
                let steps = ["translate", "scale", "rotate", "matrix", "lookat"];
                Err(located(unknown.suggest("steps", tag, steps)))
            }
        }
    }
}

fn count(element: &Element, name: &str, expected: &str, found: usize) -> SceneError {
    let message = format!("expected {expected} numbers, found {found}");
    error(&codes::VALUE, element.place(name), message, "another number of values")
}

/// Returns the number that a text stands for.
fn number(text: &str, place: &Span) -> Result<f64, SceneError> {
    let number: Option<f64> = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        let message = format!("expected a finite number, found `{}`", shortened(text));
        error(&codes::VALUE, place, message, "no number")
    })
}
