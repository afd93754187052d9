//! Scene files in RON: what may stand in them, and errors that point at the text.

use std::collections::BTreeMap;
use std::sync::Arc;

use frame_graph::{Diagnostic, Diagnostics, Label, Source, Span};
use glam::{EulerRot, Quat, Vec3};
use ron::error::{Error as RonError, Position, SpannedError};
use ron::extensions::Extensions;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::model;

/// A scene file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Scene")]
pub(crate) struct Description {
    /// What the scene shows, in a line.
    #[serde(default)]
    pub(crate) about: String,
    pub(crate) geometry: Geometry,
    /// Instead of the geometry's own.
    #[serde(default)]
    pub(crate) camera: Option<Camera>,
    #[serde(default)]
    pub(crate) lights: Vec<Light>,
    /// Whether the geometry's own lights shine too.
    #[serde(default = "yes")]
    pub(crate) lights_from_file: bool,
    #[serde(default)]
    pub(crate) keyframes: Option<Keyframes>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) enum Geometry {
    /// Made by code.
    BuiltIn(String),
    /// A glTF file, from the folder of the scene file.
    File(String),
    /// Several, each at its own place.
    Objects(Vec<Object>),
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Object {
    pub(crate) name: String,
    pub(crate) geometry: Geometry,
    #[serde(default)]
    pub(crate) transform: Transform,
}

/// First scale, then rotate (about x, then y, then z), then translate.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Transform {
    #[serde(deserialize_with = "finite_vector")]
    pub(crate) translate: Vec3,
    #[serde(deserialize_with = "finite_vector")]
    pub(crate) rotate_deg: Vec3,
    #[serde(deserialize_with = "finite_vector")]
    pub(crate) scale: Vec3,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Camera {
    #[serde(deserialize_with = "finite_vector")]
    pub(crate) position: Vec3,
    #[serde(deserialize_with = "finite_vector")]
    pub(crate) target: Vec3,
    #[serde(default = "upwards", deserialize_with = "direction")]
    pub(crate) up: Vec3,
    #[serde(deserialize_with = "field_of_view")]
    pub(crate) vertical_fov_deg: f32,
    /// A ten-thousandth of the scene's extent unless given.
    #[serde(default, deserialize_with = "near_plane")]
    pub(crate) near: Option<f32>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) enum Light {
    Spot {
        #[serde(default)]
        name: String,
        #[serde(deserialize_with = "finite_vector")]
        position: Vec3,
        #[serde(deserialize_with = "direction")]
        direction: Vec3,
        #[serde(deserialize_with = "power")]
        intensity: Vec3,
        #[serde(deserialize_with = "cone")]
        outer_deg: f32,
        /// As wide as the outer cone, for an edge that is a step, unless given.
        #[serde(default, deserialize_with = "inner_cone")]
        inner_deg: Option<f32>,
    },
    Point {
        #[serde(default)]
        name: String,
        #[serde(deserialize_with = "finite_vector")]
        position: Vec3,
        #[serde(deserialize_with = "power")]
        intensity: Vec3,
    },
    Directional {
        #[serde(default)]
        name: String,
        #[serde(deserialize_with = "direction")]
        direction: Vec3,
        #[serde(deserialize_with = "power")]
        irradiance: Vec3,
    },
}

/// Movement. Positions, directions, targets and intensities run smoothly through their keys (Catmull-Rom);
/// turns and scales of objects run from key to key (slerp, linear). A key may leave out what it does not set.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Keyframes {
    #[serde(default = "thirty", deserialize_with = "frame_rate")]
    pub(crate) frames_per_second: f32,
    /// Whether all starts again after the last key; else the first and last keys hold.
    #[serde(default)]
    pub(crate) repeat: bool,
    #[serde(default)]
    pub(crate) camera: Vec<CameraKey>,
    #[serde(default)]
    pub(crate) lights: BTreeMap<String, Vec<LightKey>>,
    #[serde(default)]
    pub(crate) objects: BTreeMap<String, Vec<ObjectKey>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Key")]
pub(crate) struct CameraKey {
    #[serde(deserialize_with = "seconds")]
    pub(crate) time: f32,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) position: Option<Vec3>,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) target: Option<Vec3>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Key")]
pub(crate) struct LightKey {
    #[serde(deserialize_with = "seconds")]
    pub(crate) time: f32,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) position: Option<Vec3>,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) direction: Option<Vec3>,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) intensity: Option<Vec3>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Key")]
pub(crate) struct ObjectKey {
    #[serde(deserialize_with = "seconds")]
    pub(crate) time: f32,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) translate: Option<Vec3>,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) rotate_deg: Option<Vec3>,
    #[serde(default, deserialize_with = "some_vector")]
    pub(crate) scale: Option<Vec3>,
}

impl Default for Transform {
    fn default() -> Self {
        Transform { translate: Vec3::ZERO, rotate_deg: Vec3::ZERO, scale: Vec3::ONE }
    }
}

impl Transform {
    pub(crate) fn model(&self) -> model::Transform {
        let rotation = rotation(self.rotate_deg);
        model::Transform { translation: self.translate, rotation, scale: self.scale }
    }
}

/// About x, then y, then z, by degrees.
pub(crate) fn rotation(degrees: Vec3) -> Quat {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Quat::from_euler(EulerRot::ZYX, z, y, x)
}

fn yes() -> bool {
    true
}

fn thirty() -> f32 {
    30.0
}

fn upwards() -> Vec3 {
    Vec3::Y
}

/// Reads a number that must be as `is` says.
fn number<'de, D: Deserializer<'de>>(from: D, expected: &str, is: fn(f32) -> bool) -> Result<f32, D::Error> {
    let x = f32::deserialize(from)?;
    if is(x) { Ok(x) } else { Err(D::Error::custom(format!("expected {expected}, found {x}"))) }
}

fn vector<'de, D: Deserializer<'de>>(
    from: D,
    expected: &str,
    is: fn(Vec3) -> bool,
) -> Result<Vec3, D::Error> {
    let v = Vec3::from(<[f32; 3]>::deserialize(from)?);
    let [x, y, z] = v.to_array();
    if is(v) { Ok(v) } else { Err(D::Error::custom(format!("expected {expected}, found ({x}, {y}, {z})"))) }
}

fn finite_vector<'de, D: Deserializer<'de>>(from: D) -> Result<Vec3, D::Error> {
    vector(from, "three finite numbers", Vec3::is_finite)
}

fn some_vector<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec3>, D::Error> {
    finite_vector(from).map(Some)
}

fn direction<'de, D: Deserializer<'de>>(from: D) -> Result<Vec3, D::Error> {
    vector(from, "a direction: three finite numbers, not all 0", |v| v.try_normalize().is_some())
}

fn power<'de, D: Deserializer<'de>>(from: D) -> Result<Vec3, D::Error> {
    let expected = "red, green and blue, each finite and not negative";
    vector(from, expected, |v| v.is_finite() && v.min_element() >= 0.0)
}

fn seconds<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, "a time in seconds, not negative", |x| x.is_finite() && x >= 0.0)
}

fn frame_rate<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, "frames per second, above 0", |x| x.is_finite() && x > 0.0)
}

fn field_of_view<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, "degrees between 0 and 180", |x| x > 0.0 && x < 180.0)
}

fn near_plane<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f32>, D::Error> {
    number(from, "a distance in metres, above 0", |x| x.is_finite() && x > 0.0).map(Some)
}

fn cone<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, "half the cone's angle, above 0 and at most 90 degrees", |x| x > 0.0 && x <= 90.0)
}

fn inner_cone<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f32>, D::Error> {
    number(from, "half the inner cone's angle, 0 to 90 degrees", |x| (0.0..=90.0).contains(&x)).map(Some)
}

/// Reads a scene file.
///
/// Codes: `C001` syntax, type or value; `C002` unknown field or variant; `C003` missing or repeated field.
pub(crate) fn parse(source: &Arc<Source>) -> Result<Description, Diagnostics> {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .from_str(&source.text)
        .map_err(|error| Diagnostics(vec![diagnose(source, &error)]))
}

fn diagnose(source: &Arc<Source>, error: &SpannedError) -> Diagnostic {
    let inside = |outer: &Option<String>| outer.as_ref().map(|o| format!(" in `{o}`")).unwrap_or_default();
    let (code, message, here, notes) = match &error.code {
        RonError::NoSuchStructField { expected, found, outer } => {
            ("C002", format!("unknown field `{found}`{}", inside(outer)), "unknown", offer(found, expected))
        }
        RonError::NoSuchEnumVariant { expected, found, outer } => {
            ("C002", format!("unknown variant `{found}`{}", inside(outer)), "unknown", offer(found, expected))
        }
        RonError::MissingStructField { field, outer } => {
            ("C003", format!("field `{field}` is missing{}", inside(outer)), "ends without it", Vec::new())
        }
        RonError::DuplicateStructField { field, outer } => {
            ("C003", format!("field `{field}` is given twice{}", inside(outer)), "again", Vec::new())
        }
        other => ("C001", other.to_string(), "here", Vec::new()),
    };
    let (start, end) = (offset(&source.text, error.span.start), offset(&source.text, error.span.end));
    let mut start = start.min(end);
    let read = &source.text[start..end];
    match &error.code {
        // A value that was read, but is not as it should be; the span is that of its last token.
        RonError::Message(_) if read.ends_with(')') => start = source.text[..end].rfind('(').unwrap_or(start),
        // The span may begin with the blanks before what was read.
        _ => start += read.len() - read.trim_start().len(),
    }
    let span = span(source, start, end);
    Diagnostic { code, message, labels: vec![Label { span, message: here.into() }], notes }
}

/// The byte at which a line and column (both from 1, columns in characters) begin.
fn offset(text: &str, position: Position) -> usize {
    let line: usize = text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let rest = &text[line..];
    line + rest.char_indices().nth(position.col.saturating_sub(1)).map_or(rest.len(), |(byte, _)| byte)
}

pub(crate) fn span(source: &Arc<Source>, start: usize, end: usize) -> Span {
    Span { source: source.clone(), start: start as u32, end: end as u32 }
}

/// Notes that offer the nearest of the names there are.
pub(crate) fn offer<S: AsRef<str>>(found: &str, names: &[S]) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(name) = nearest(found, names).first() {
        notes.push(format!("did you mean `{name}`?"));
    }
    let names: Vec<_> = names.iter().map(|n| format!("`{}`", n.as_ref())).collect();
    notes.push(if names.is_empty() {
        "there are none".into()
    } else {
        format!("there are: {}", names.join(", "))
    });
    notes
}

/// The names that are near enough to `found` to be meant, nearest first.
pub(crate) fn nearest<'a, S: AsRef<str>>(found: &str, names: &'a [S]) -> Vec<&'a str> {
    let similarity = |name: &&str| strsim::jaro_winkler(found, name);
    let mut near: Vec<&str> = names.iter().map(AsRef::as_ref).filter(|name| similarity(name) > 0.7).collect();
    near.sort_by(|a, b| similarity(b).total_cmp(&similarity(a)).then(a.cmp(b)));
    near
}
