//! The parameters of a directive: `"type name" value` or `"type name" [ values ]`.

use std::cell::Cell;
use std::collections::BTreeMap;

use data_file::{Diagnostic, Span};
use glam::{DVec3, Mat3, Vec3};

use super::tokens::{Token, Tokens, number};
use crate::codes;
use crate::error::SceneError;
use crate::offline::paint::Paint;
use crate::offline::report::{Report, error, located, shortened, unknown};
use crate::offline::spectrum::{self, Spectrum};

/// Bytes that a value takes while it is read.
const BYTES_A_VALUE: usize = 16;

/// The types of parameters, and how many numbers make one value.
const TYPES: [(&str, usize); 15] = [
    ("integer", 1),
    ("float", 1),
    ("point2", 2),
    ("vector2", 2),
    ("point3", 3),
    ("point", 3),
    ("vector3", 3),
    ("vector", 3),
    ("normal3", 3),
    ("normal", 3),
    ("rgb", 3),
    ("color", 3),
    ("blackbody", 1),
    ("spectrum", 0),
    ("texture", 0),
];

/// A parameter.
pub(super) struct Parameter {
    kind: String,
    name: String,
    numbers: Vec<f64>,
    texts: Vec<String>,
    span: Span,
    used: Cell<bool>,
}

/// The parameters of a directive.
pub(super) struct Parameters {
    list: Vec<Parameter>,
    /// The directive, such as `Shape "sphere"`.
    pub(super) of: String,
    /// The place of the directive.
    pub(super) span: Span,
    /// The color space of the colors.
    pub(super) space: Space,
}

/// Textures by their names: those of colors, and those of numbers.
#[derive(Default)]
pub(super) struct Textures {
    pub(super) colors: BTreeMap<String, Paint>,
    pub(super) numbers: BTreeMap<String, Paint>,
}

/// The color space of `rgb` parameters.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Space {
    Srgb,
    DciP3,
    Rec2020,
}

impl Space {
    /// Returns a color of the space in linear Rec. 709. All have the white D65.
    fn rec709(self, color: Vec3) -> Vec3 {
        let rows = match self {
            Space::Srgb => return color,
            Space::DciP3 => [
                [1.224_940_2, -0.224_940_2, 0.0],
                [-0.042_057, 1.042_057, 0.0],
                [-0.019_637_6, -0.078_636_1, 1.098_273_6],
            ],
            Space::Rec2020 => [
                [1.660_491, -0.587_641_1, -0.072_849_9],
                [-0.124_550_5, 1.132_899_9, -0.008_349_4],
                [-0.018_150_8, -0.100_578_9, 1.118_729_7],
            ],
        };
        Mat3::from_cols_array_2d(&rows).transpose() * color
    }
}

/// The use of a spectrum.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Usage {
    /// Reflectance of a surface.
    Reflectance,
    /// Light. Spectra of it that are no `rgb` are scaled to a luminance of 1, as pbrt scales them.
    Light,
    /// An index of refraction.
    Index,
}

impl Parameters {
    /// Reads the parameters behind a directive.
    pub(super) fn read(
        tokens: &mut Tokens,
        of: String,
        span: Span,
        space: Space,
        report: &Report<'_>,
    ) -> Result<Parameters, SceneError> {
        let mut list: Vec<Parameter> = Vec::new();
        while let Some((Token::Quoted(_), _)) = tokens.peek()? {
            let Some((Token::Quoted(declared), place)) = tokens.take()? else { break };
            let parameter = parameter(tokens, &declared, place, report)?;
            if let Some(first) = list.iter().find(|other| other.name == parameter.name) {
                let message = format!("the parameter `{}` is given twice", shortened(&parameter.name));
                let twice = Diagnostic::new(&codes::VALUE, message).label(parameter.span, "again");
                return Err(located(twice.label(first.span.clone(), "first")));
            }
            list.push(parameter);
        }
        Ok(Parameters { list, of, span, space })
    }

    fn find(&self, name: &str) -> Option<&Parameter> {
        let found = self.list.iter().find(|parameter| parameter.name == name);
        found.inspect(|parameter| parameter.used.set(true))
    }

    /// Returns whether a parameter is there, without taking it as used.
    pub(super) fn has(&self, name: &str) -> bool {
        self.list.iter().any(|parameter| parameter.name == name)
    }

    /// Returns the place of a parameter, or of the directive.
    pub(super) fn place(&self, name: &str) -> &Span {
        self.list.iter().find(|parameter| parameter.name == name).map_or(&self.span, |found| &found.span)
    }

    /// Marks parameters as used that change nothing here.
    pub(super) fn ignore(&self, names: &[&str]) {
        for name in names {
            self.find(name);
        }
    }

    /// Notes the parameters that nothing asked for.
    pub(super) fn note_unused(&self, report: &mut Report<'_>) {
        for parameter in self.list.iter().filter(|parameter| !parameter.used.get()) {
            let (of, name) = (&self.of, shortened(&parameter.name));
            report.note(
                &parameter.span,
                format!("{of}: the parameter `{name}` is not supported: it is left out"),
            );
        }
    }

    /// Returns the numbers of a parameter of one of these types, a multiple of what makes one value.
    fn of_types(&self, name: &str, types: &[&str]) -> Result<Option<&[f64]>, SceneError> {
        let Some(found) = self.find(name) else { return Ok(None) };
        if !types.contains(&found.kind.as_str()) {
            let expected: Vec<String> = types.iter().map(|kind| format!("`{kind} {name}`")).collect();
            let message = format!("expected {}, found `{} {name}`", expected.join(" or "), found.kind);
            return Err(error(&codes::VALUE, &found.span, message, "of another type"));
        }
        Ok(Some(&found.numbers))
    }

    /// Returns a list of numbers.
    pub(super) fn numbers(&self, name: &str, kind: &str) -> Result<Option<&[f64]>, SceneError> {
        self.of_types(name, &[kind])
    }

    /// Returns a list of vectors of two or three numbers.
    pub(super) fn vectors<const N: usize>(
        &self,
        name: &str,
        types: &[&str],
    ) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let numbers = self.of_types(name, types)?;
        let vector = |numbers: &[f64]| std::array::from_fn(|i| numbers[i] as f32);
        Ok(numbers.map(|numbers| numbers.chunks_exact(N).map(vector).collect()))
    }

    /// Returns a point or a vector.
    pub(super) fn vector(&self, name: &str, types: &[&str]) -> Result<Option<DVec3>, SceneError> {
        let Some(numbers) = self.of_types(name, types)? else { return Ok(None) };
        match numbers {
            [x, y, z] => Ok(Some(DVec3::new(*x, *y, *z))),
            _ => Err(self.count(name, 3, numbers.len())),
        }
    }

    /// Returns a number.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, SceneError> {
        match self.of_types(name, &["float", "integer"])? {
            None => Ok(None),
            Some([number]) => Ok(Some(*number)),
            Some(numbers) => Err(self.count(name, 1, numbers.len())),
        }
    }

    fn count(&self, name: &str, expected: usize, found: usize) -> SceneError {
        let values = if expected == 1 { "value" } else { "values" };
        let message = format!("`{name}` must have {expected} {values}; found {found}");
        error(&codes::VALUE, self.place(name), message, "another number of values")
    }

    /// Returns a number, or another one if it is not there.
    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, SceneError> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    /// Returns the text of a `string`.
    pub(super) fn text(&self, name: &str) -> Result<Option<&str>, SceneError> {
        self.of_types(name, &["string"])?;
        let Some(found) = self.find(name) else { return Ok(None) };
        match &found.texts[..] {
            [text] => Ok(Some(text)),
            texts => Err(self.count(name, 1, texts.len())),
        }
    }

    /// Returns a `bool`.
    pub(super) fn flag(&self, name: &str) -> Result<bool, SceneError> {
        self.of_types(name, &["bool"])?;
        let Some(found) = self.find(name) else { return Ok(false) };
        match &found.texts[..] {
            [text] if text == "true" || text == "false" => Ok(text == "true"),
            _ => Err(error(&codes::VALUE, &found.span, format!("`{name}` is `true` or `false`"), "neither")),
        }
    }

    /// Returns a color.
    pub(super) fn color(
        &self,
        name: &str,
        usage: Usage,
        report: &mut Report<'_>,
    ) -> Result<Option<Vec3>, SceneError> {
        let Some(found) = self.find(name) else { return Ok(None) };
        let Parameter { kind, numbers, span, .. } = found;
        match (kind.as_str(), &numbers[..]) {
            ("rgb" | "color", [r, g, b]) => {
                let color = self.space.rec709(DVec3::new(*r, *g, *b).as_vec3());
                Ok(Some(if self.space == Space::Srgb { color } else { color.max(Vec3::ZERO) }))
            }
            ("rgb" | "color", _) => Err(self.count(name, 3, numbers.len())),
            ("float", [value]) if usage != Usage::Light => Ok(Some(Vec3::splat(*value as f32))),
            ("blackbody", [kelvin]) if *kelvin > 0.0 => Ok(Some(spectrum::blackbody(*kelvin))),
            ("blackbody", _) => {
                Err(error(&codes::VALUE, span, "expected one temperature above 0 K", "no temperature"))
            }
            ("spectrum", _) => self.spectrum(found, usage, report).map(Some),
            _ => {
                let message = format!(
                    "expected `rgb {name}`, `spectrum {name}` or `blackbody {name}`, found `{kind} {name}`"
                );
                Err(error(&codes::VALUE, span, message, "of another type"))
            }
        }
    }

    fn spectrum(
        &self,
        Parameter { name, numbers, texts, span, .. }: &Parameter,
        usage: Usage,
        report: &mut Report<'_>,
    ) -> Result<Vec3, SceneError> {
        let pairs = match (&texts[..], numbers.is_empty()) {
            ([], false) => numbers.clone(),
            ([file], _) if file.ends_with(".spd") => {
                let source = report.text(file, span)?;
                let mut tokens = Tokens::new(source);
                let mut numbers = Vec::new();
                while let Some((token, place)) = tokens.take()? {
                    match token {
                        Token::Word(word) => numbers.push(number(&word, &place)?),
                        _ => {
                            return Err(error(
                                &codes::FORMAT,
                                &place,
                                "expected pairs of numbers",
                                "no number",
                            ));
                        }
                    }
                }
                numbers
            }
            ([known], _) => {
                // The white of Rec. 709 is D65, and light of other white lamps is taken to be that.
                if known != "stdillum-D65" {
                    report.note(
                        span,
                        format!("the spectrum `{}` is not known: it is taken as white", shortened(known)),
                    );
                }
                return Ok(Vec3::ONE);
            }
            _ => Vec::new(),
        };
        let spectrum = match pairs.as_chunks::<2>() {
            (pairs, []) => Spectrum::new(pairs.to_vec()),
            _ => None,
        };
        let Some(spectrum) = spectrum else {
            let message = format!("`{name}` has pairs of a wavelength in nm, rising, and a value");
            return Err(error(&codes::VALUE, span, message, "no spectrum"));
        };
        Ok(match usage {
            Usage::Light => spectrum.chromaticity(),
            Usage::Reflectance | Usage::Index => spectrum.reflectance(),
        })
    }

    /// Returns the name of the metal whose index of refraction a parameter names, as `metal-Cu-eta` does.
    pub(super) fn metal(&self, name: &str) -> Option<&str> {
        let found =
            self.list.iter().find(|parameter| parameter.name == name && parameter.kind == "spectrum")?;
        let metal = found.texts.first()?.strip_prefix("metal-")?;
        found.used.set(true);
        metal.strip_suffix("-eta").or_else(|| metal.strip_suffix("-k"))
    }

    /// Returns a color or a texture of colors.
    pub(super) fn paint(
        &self,
        name: &str,
        usage: Usage,
        textures: &Textures,
        report: &mut Report<'_>,
    ) -> Result<Option<Paint>, SceneError> {
        match self.texture(name, &textures.colors)? {
            Some(paint) => Ok(Some(paint)),
            None => Ok(self.color(name, usage, report)?.map(Paint::Plain)),
        }
    }

    /// Returns a number or a texture of numbers.
    pub(super) fn shade(&self, name: &str, textures: &Textures) -> Result<Option<Paint>, SceneError> {
        match self.texture(name, &textures.numbers)? {
            Some(paint) => Ok(Some(paint)),
            None => Ok(self.number(name)?.map(|number| Paint::number(number as f32))),
        }
    }

    fn texture(&self, name: &str, known: &BTreeMap<String, Paint>) -> Result<Option<Paint>, SceneError> {
        let found = self.list.iter().find(|parameter| parameter.name == name && parameter.kind == "texture");
        let Some(found) = found else { return Ok(None) };
        found.used.set(true);
        let [texture] = &found.texts[..] else { return Err(self.count(name, 1, found.texts.len())) };
        match known.get(texture) {
            Some(paint) => Ok(Some(paint.clone())),
            None => {
                Err(unknown(&found.span, ("texture", "textures"), texture, known.keys().map(String::as_str)))
            }
        }
    }
}

/// Reads one parameter, whose declaration was taken.
fn parameter(
    tokens: &mut Tokens,
    declared: &str,
    place: Span,
    report: &Report<'_>,
) -> Result<Parameter, SceneError> {
    let mut words = declared.split_ascii_whitespace();
    let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let message = format!(
            "expected a type and a name, such as \"float radius\"; found \"{}\"",
            shortened(declared)
        );
        return Err(error(&codes::FORMAT, &place, message, "no parameter"));
    };
    let is_text = matches!(kind, "string" | "bool");
    let numbers_a_value = TYPES.iter().find(|(known, _)| *known == kind).map(|(_, count)| *count);
    let Some(numbers_a_value) = numbers_a_value.or(is_text.then_some(0)) else {
        let known = TYPES.iter().map(|(known, _)| *known).chain(["string", "bool"]);
        let message = format!("there is no type `{}` of parameters", shortened(kind));
        let unknown = Diagnostic::new(&codes::VALUE, message).label(place, "this type");
        return Err(located(unknown.suggest("types", kind, known)));
    };
    let (mut numbers, mut texts) = (Vec::new(), Vec::new());
    let mut value = |token: Token, span: &Span| -> Result<(), SceneError> {
        report.take(1, BYTES_A_VALUE, span)?;
        match token {
            Token::Quoted(text) if numbers_a_value == 0 => texts.push(text),
            Token::Word(word) if kind == "bool" => texts.push(word),
            Token::Word(word) if !is_text && kind != "texture" => numbers.push(number(&word, span)?),
            _ => {
                let message = format!("expected the value of `{kind} {}`", shortened(name));
                return Err(error(&codes::FORMAT, span, message, "no such value"));
            }
        }
        Ok(())
    };
    let behind =
        |span: &Span| error(&codes::FORMAT, span, "expected a value, and the file ends", "behind this");
    match tokens.take()?.ok_or_else(|| behind(&place))? {
        (Token::Open, open) => loop {
            match tokens
                .take()?
                .ok_or_else(|| error(&codes::FORMAT, &open, "the `[` has no `]`", "begins here"))?
            {
                (Token::Close, _) => break,
                (token, span) => value(token, &span)?,
            }
        },
        (token, span) => value(token, &span)?,
    }
    if numbers_a_value > 1 && numbers.len() % numbers_a_value != 0 {
        let message = format!(
            "`{kind} {}` has {numbers_a_value} numbers for each value; found {}",
            shortened(name),
            numbers.len()
        );
        return Err(error(&codes::VALUE, &place, message, "another number of values"));
    }
    Ok(Parameter {
        kind: kind.to_owned(),
        name: name.to_owned(),
        numbers,
        texts,
        span: place,
        used: Cell::new(false),
    })
}
