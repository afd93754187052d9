//! The grammar of scene files: types that serde reads, and the checks of their values. All errors are reported at once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::codes;
use data_file::grammar::{Entries, Expected, Number, Reader, Spanned, read};
use data_file::paths::{OUTSIDE, may_name};
use data_file::{Diagnostic, Diagnostics, Place, Source};
use glam::{DVec3, Quat, Vec3};
use serde::Deserialize;

use super::{
    CameraKeys, Description, EnvironmentDescription, EnvironmentMap, Geometry, Keyframes, Keys, LightKeys,
    Object, ObjectKeys, rotation,
};
use crate::built_in;
use crate::camera::Camera;
use crate::light::{BRIGHTEST, Light, LightKind};
use crate::load::GEOMETRY_ENDINGS;
use crate::model::Transform;
use crate::origin::local;

/// Reads a scene file, with its places in the world relative to `origin`. Geometry files are looked up in a `folder`, if
/// one is given; they may also be in the folders given with it.
///
/// # Errors
/// All errors of the file that can be found without reading geometry.
pub(crate) fn parse(
    source: &Arc<Source>,
    folder: Option<(&Path, &[PathBuf])>,
    origin: DVec3,
) -> Result<Description, Diagnostics> {
    read(source, 0, |reader, file| Checks { reader, folder, origin, objects: BTreeMap::new() }.scene(file))
}

/// Returns which fields and forms may stand at a byte of a scene file.
pub fn expected(text: &str, at: usize) -> Expected {
    data_file::grammar::expected::<SceneFile>(text, at)
}

#[derive(Deserialize)]
#[serde(rename = "Scene")]
struct SceneFile {
    about: Option<String>,
    geometry: GeometryFile,
    camera: Option<CameraFile>,
    lights: Vec<LightFile>,
    environment: Option<EnvironmentFile>,
    lights_from_file: Option<bool>,
    keyframes: Option<Spanned<KeyframesFile>>,
}

#[derive(Deserialize)]
#[serde(expecting = "`BuiltIn(\"name\")`, `File(\"model.glb\")` or `Objects([…])`")]
enum GeometryFile {
    BuiltIn(Spanned<String>),
    File(Spanned<String>),
    Objects(Vec<ObjectFile>),
}

#[derive(Deserialize)]
#[serde(rename = "Object", expecting = "`Object(name: \"…\", geometry: …)`")]
struct ObjectFile {
    name: Spanned<String>,
    geometry: GeometryFile,
    transform: Option<TransformFile>,
}

#[derive(Deserialize)]
#[serde(
    rename = "Transform",
    expecting = "`Transform(translate: (x, y, z), rotate_deg: (x, y, z), scale: (x, y, z))`"
)]
struct TransformFile {
    translate: Option<Vector>,
    rotate_deg: Option<Vector>,
    scale: Option<Vector>,
}

#[derive(Deserialize)]
#[serde(rename = "Camera", expecting = "`Camera(position: …, target: …, …)`")]
struct CameraFile {
    position: Vector,
    target: Spanned<Vector>,
    up: Option<Direction>,
    vertical_fov_deg: Spanned<Number>,
    near: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(expecting = "`Spot(…)`, `Point(…)` or `Directional(…)`")]
#[expect(clippy::large_enum_variant, reason = "a scene has few lights, and each is converted at once")]
enum LightFile {
    Spot {
        name: Option<String>,
        position: Vector,
        direction: Direction,
        intensity: Power,
        outer_deg: Spanned<Number>,
        inner_deg: Option<Spanned<Number>>,
    },
    Point {
        name: Option<String>,
        position: Vector,
        intensity: Power,
    },
    Directional {
        name: Option<String>,
        direction: Direction,
        irradiance: Power,
    },
}

#[derive(Deserialize)]
#[serde(rename = "Environment", expecting = "`Environment(map: …, radiance: …, rotation_deg: …)`")]
struct EnvironmentFile {
    map: Option<MapFile>,
    radiance: Option<Power>,
    rotation_deg: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(expecting = "`BuiltIn(\"sky\")` or `File(\"sky.hdr\")`")]
enum MapFile {
    BuiltIn(Spanned<String>),
    File(Spanned<String>),
}

#[derive(Deserialize)]
#[serde(rename = "Keyframes")]
struct KeyframesFile {
    frames_per_second: Option<Spanned<Number>>,
    repeat: Option<bool>,
    camera: Option<Spanned<Vec<CameraKey>>>,
    lights: Entries<Vec<LightKey>>,
    objects: Entries<Vec<ObjectKey>>,
}

#[derive(Deserialize)]
#[serde(rename = "Key", expecting = "`Key(time: …, …)`")]
struct CameraKey {
    time: Spanned<Number>,
    position: Option<Vector>,
    target: Option<Vector>,
}

#[derive(Deserialize)]
#[serde(rename = "Key", expecting = "`Key(time: …, …)`")]
struct LightKey {
    time: Spanned<Number>,
    position: Option<Vector>,
    direction: Option<Direction>,
    intensity: Option<Power>,
}

#[derive(Deserialize)]
#[serde(rename = "Key", expecting = "`Key(time: …, …)`")]
struct ObjectKey {
    time: Spanned<Number>,
    translate: Option<Vector>,
    rotate_deg: Option<Vector>,
    scale: Option<Vector>,
}

type Numbers = [Spanned<Number>; 3];

#[derive(Deserialize)]
#[serde(expecting = "three numbers: (x, y, z)")]
struct Vector(Numbers);

#[derive(Deserialize)]
#[serde(expecting = "a direction: (x, y, z)")]
struct Direction(Spanned<Numbers>);

#[derive(Deserialize)]
#[serde(expecting = "red, green and blue: (r, g, b)")]
struct Power(Numbers);

struct Checks<'a, 'b> {
    reader: &'a mut Reader<'b>,
    folder: Option<(&'a Path, &'a [PathBuf])>,
    origin: DVec3,
    /// Names of objects, at any depth: where they stand, and what is subtracted from their places, which is nothing
    /// within another object.
    objects: BTreeMap<String, (Place, DVec3)>,
}

/// A condition on a number, and its description for messages.
type Rule = (&'static str, fn(f32) -> bool);

/// The built-in map of an environment.
const SKY: &str = "sky";

const FINITE: Rule = ("a finite number", f32::is_finite);

impl Checks<'_, '_> {
    fn scene(mut self, file: SceneFile) -> Description {
        let lights = file.lights.into_iter().enumerate();
        Description {
            about: file.about.unwrap_or_default(),
            geometry: self.geometry(file.geometry, self.origin),
            camera: file.camera.map(|camera| self.camera(&camera)),
            lights: lights.map(|(index, light)| self.light(light, index)).collect(),
            environment: file.environment.map(|environment| self.environment(environment)),
            lights_from_file: file.lights_from_file.unwrap_or(true),
            keyframes: file.keyframes.map(|keyframes| self.keyframes(keyframes.value)),
        }
    }

    fn geometry(&mut self, file: GeometryFile, origin: DVec3) -> Geometry {
        match file {
            GeometryFile::BuiltIn(name) => {
                if !built_in::names().contains(&name.as_str()) {
                    let message = format!("there is no built-in geometry `{}`", *name);
                    let error = Diagnostic::new(&codes::NAME, message)
                        .label(self.reader.span(name.place), "not built in")
                        .suggest("built-in geometries", &name, built_in::names());
                    self.reader.report(error);
                }
                Geometry::BuiltIn(name)
            }
            GeometryFile::File(file) => {
                self.file_is_there(&file, ("files of geometry there", &GEOMETRY_ENDINGS));
                Geometry::File(file)
            }
            GeometryFile::Objects(objects) => {
                Geometry::Objects(objects.into_iter().map(|object| self.object(object, origin)).collect())
            }
        }
    }

    fn environment(&mut self, file: EnvironmentFile) -> EnvironmentDescription {
        let map = file.map.map(|map| match map {
            MapFile::BuiltIn(name) => {
                if name.value != SKY {
                    let message = format!("there is no built-in map `{}`", *name);
                    let error = Diagnostic::new(&codes::NAME, message)
                        .label(self.reader.span(name.place), "not built in")
                        .suggest("built-in maps", &name, [SKY]);
                    self.reader.report(error);
                }
                EnvironmentMap::Sky
            }
            MapFile::File(file) => {
                self.file_is_there(&file, ("maps there", &[".hdr", ".exr", ".pfm"]));
                EnvironmentMap::File(file)
            }
        });
        EnvironmentDescription {
            map,
            radiance: file.radiance.map_or(Vec3::ONE, |radiance| self.power(&radiance)),
            rotation: file.rotation_deg.map_or(0.0, |turn| self.number(turn, FINITE)).to_radians(),
        }
    }

    /// Checks that a file may be named and exists. `(what, endings)` are the files that a mistaken name is compared with.
    fn file_is_there(&mut self, file: &Spanned<String>, (what, endings): (&str, &[&str])) {
        let Some((folder, roots)) = self.folder else { return };
        let path = folder.join(&file.value);
        let scene = folder.join("scene");
        if !may_name(&scene, &path, roots) {
            let error = Diagnostic::new(&codes::NAME, format!("the file {} {OUTSIDE}", path.display()))
                .label(self.reader.span(file.place), "outside");
            self.reader.report(error);
            return;
        }
        if path.exists() {
            return;
        }
        let error = Diagnostic::new(&codes::NAME, format!("there is no file {}", path.display()))
            .label(self.reader.span(file.place), "not found")
            .note("file names start from the folder of the scene file");
        let inner = Path::new(&file.value).parent().unwrap_or(Path::new(""));
        let known = files_in(folder, inner, endings);
        let error = if known.is_empty() {
            error
        } else {
            error.suggest(what, &file.value, known.iter().map(String::as_str))
        };
        self.reader.report(error);
    }

    fn object(&mut self, file: ObjectFile, origin: DVec3) -> Object {
        let name = file.name;
        match self.objects.get(&name.value) {
            Some((first, _)) => {
                let first = *first;
                self.reader.duplicate(&format!("the object `{}`", *name), name.place, first);
            }
            None => {
                self.objects.insert(name.value.clone(), (name.place, origin));
            }
        }
        let geometry = self.geometry(file.geometry, DVec3::ZERO);
        let unmoved = Transform { translation: (DVec3::ZERO - origin).as_vec3(), ..Transform::default() };
        let transform = file.transform.map_or(unmoved, |file| Transform {
            translation: file.translate.map_or(unmoved.translation, |at| self.place(&at, origin)),
            rotation: file.rotate_deg.map_or(Quat::IDENTITY, |turn| self.rotation(&turn)),
            scale: file.scale.map_or(Vec3::ONE, |scale| self.vector(&scale)),
        });
        Object { name, geometry, transform }
    }

    fn camera(&mut self, file: &CameraFile) -> Camera {
        let (position, target) = (self.position(&file.position), self.position(&file.target));
        // Two points that are one for `f32` so far from the origin may be two for another origin.
        let exact = |vector: &Vector| vector.0.map(|number| number.value.as_f64());
        if position == target && exact(&file.position) == exact(&file.target) {
            let message = "the camera's position and target are the same point";
            let place = self.reader.span(file.target.place);
            self.reader.report(Diagnostic::new(&codes::CONFLICT, message).label(place, "it looks nowhere"));
        }
        let fov: Rule = ("degrees between 0 and 180", |x| x > 0.0 && x < 180.0);
        let near: Rule = ("a distance in metres, above 0", |x| x.is_finite() && x > 0.0);
        Camera {
            position,
            target,
            up: file.up.as_ref().map_or(Vec3::Y, |up| self.direction(up)),
            vertical_fov: self.number(file.vertical_fov_deg, fov).to_radians(),
            near: file.near.map_or(0.0, |distance| self.number(distance, near)),
        }
    }

    fn light(&mut self, file: LightFile, index: usize) -> Light {
        let (name, kind, position, direction, intensity) = match file {
            LightFile::Spot { name, position, direction, intensity, outer_deg, inner_deg } => {
                let kind = self.cone(outer_deg, inner_deg);
                (name, kind, Some(position), Some(direction), intensity)
            }
            LightFile::Point { name, position, intensity } => {
                (name, LightKind::Point, Some(position), None, intensity)
            }
            LightFile::Directional { name, direction, irradiance } => {
                (name, LightKind::Directional, None, Some(direction), irradiance)
            }
        };
        Light {
            name: name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("light {index}")),
            kind,
            position: position.map_or(Vec3::ZERO, |at| self.position(&at)),
            direction: direction.map_or(Vec3::NEG_Y, |aim| self.direction(&aim).normalize_or_zero()),
            intensity: self.power(&intensity),
        }
    }

    fn cone(&mut self, outer_deg: Spanned<Number>, inner_deg: Option<Spanned<Number>>) -> LightKind {
        let rule: Rule = ("half the cone's angle, above 0 and at most 90 degrees", |x| x > 0.0 && x <= 90.0);
        let outer = self.number(outer_deg, rule);
        let rule: Rule = ("half the inner cone's angle, 0 to 90 degrees", |x| (0.0..=90.0).contains(&x));
        let inner = inner_deg.map_or(outer, |inner| self.number(inner, rule));
        if let Some(inner_deg) = inner_deg.filter(|_| inner > outer) {
            let message = format!("the inner cone, {inner}°, is wider than the outer, {outer}°");
            let error = Diagnostic::new(&codes::CONFLICT, message)
                .label(self.reader.span(inner_deg.place), "at most `outer_deg`")
                .label(self.reader.span(outer_deg.place), "the outer cone");
            self.reader.report(error);
        }
        LightKind::Spot { inner: inner.to_radians(), outer: outer.to_radians() }
    }

    fn keyframes(&mut self, file: KeyframesFile) -> Keyframes {
        let rule: Rule = ("frames per second, above 0", |x| x.is_finite() && x > 0.0);
        let frames_per_second = file.frames_per_second.map_or(30.0, |rate| self.number(rate, rule));
        let mut end = 0.0;
        let camera = file.camera.map(|keys| {
            let place = self.reader.head(keys.place);
            Spanned { value: self.camera_keys(&keys.value, &mut end), place }
        });
        let lights = file.lights.into_iter();
        let lights = lights.map(|(name, keys)| (name, self.light_keys(&keys, &mut end))).collect();
        let mut objects = Vec::new();
        for (name, keys) in file.objects {
            if !self.objects.contains_key(&name.value) && !self.reader.is_full() {
                let message = format!("keyframes for `{}`, but no object has this name", *name);
                let error = Diagnostic::new(&codes::NAME, message)
                    .label(self.reader.span(name.place), "no such object")
                    .suggest("objects", &name, self.objects.keys().map(String::as_str));
                self.reader.report(error);
            }
            let origin = self.objects.get(&name.value).map_or(DVec3::ZERO, |(_, origin)| *origin);
            objects.push((name, self.object_keys(&keys, origin, &mut end)));
        }
        Keyframes { frames_per_second, repeat: file.repeat.unwrap_or(false), end, camera, lights, objects }
    }

    fn camera_keys(&mut self, keys: &[CameraKey], end: &mut f32) -> CameraKeys {
        let times = self.times(keys.iter().map(|key| key.time), end);
        let channel = |of: fn(&CameraKey) -> &Option<Vector>| keys.iter().map(of);
        CameraKeys {
            position: self.channel("position", &times, channel(|key| &key.position), Self::position),
            target: self.channel("target", &times, channel(|key| &key.target), Self::position),
        }
    }

    fn light_keys(&mut self, keys: &[LightKey], end: &mut f32) -> LightKeys {
        let times = self.times(keys.iter().map(|key| key.time), end);
        let (position, direction) =
            (keys.iter().map(|key| &key.position), keys.iter().map(|key| &key.direction));
        let intensity = keys.iter().map(|key| &key.intensity);
        LightKeys {
            position: self.channel("position", &times, position, Self::position),
            direction: self.channel("direction", &times, direction, Self::direction),
            intensity: self.channel("intensity", &times, intensity, Self::power),
        }
    }

    fn object_keys(&mut self, keys: &[ObjectKey], origin: DVec3, end: &mut f32) -> ObjectKeys {
        let times = self.times(keys.iter().map(|key| key.time), end);
        let channel = |of: fn(&ObjectKey) -> &Option<Vector>| keys.iter().map(of);
        ObjectKeys {
            translate: self.channel("translate", &times, channel(|key| &key.translate), |checks, at| {
                checks.place(at, origin)
            }),
            rotate: self.channel("rotate_deg", &times, channel(|key| &key.rotate_deg), Self::rotation),
            scale: self.channel("scale", &times, channel(|key| &key.scale), Self::vector),
        }
    }

    /// Returns the times of keys; `end` is raised to the last of them.
    fn times(&mut self, times: impl Iterator<Item = Spanned<Number>>, end: &mut f32) -> Vec<Spanned<f32>> {
        let rule: Rule = ("a time in seconds, not negative", |x| x.is_finite() && x >= 0.0);
        let times: Vec<_> = times.map(|time| time.with(self.number(time, rule))).collect();
        *end = times.iter().fold(*end, |end, time| end.max(time.value));
        times
    }

    /// Returns the keys that set one value; their times must rise.
    fn channel<'k, T: 'k, V>(
        &mut self,
        name: &str,
        times: &[Spanned<f32>],
        values: impl Iterator<Item = &'k Option<T>>,
        read: impl Fn(&mut Self, &T) -> V,
    ) -> Keys<V> {
        let mut found = Keys::new();
        let mut last: Option<Spanned<f32>> = None;
        for (time, value) in times.iter().zip(values) {
            let Some(value) = value else { continue };
            if let Some(last) = last.filter(|last| time.value <= last.value) {
                let message = format!(
                    "the keys of `{name}` must be in the order of their times: {:?} s is not later than {:?} s",
                    time.value, last.value
                );
                let error = Diagnostic::new(&codes::CONFLICT, message)
                    .label(self.reader.span(time.place), "not later")
                    .label(self.reader.span(last.place), "than the key before it");
                self.reader.report(error);
            }
            last = Some(*time);
            found.push((time.value, read(self, value)));
        }
        found
    }

    /// Returns a number that satisfies the rule.
    fn number(&mut self, number: Spanned<Number>, (expected, keeps): Rule) -> f32 {
        let value = local(number.value, 0.0);
        if !keeps(value) {
            self.reader.error(&codes::RANGE, number.place, format!("expected {expected}, found {value}"));
        }
        value
    }

    fn numbers(&mut self, numbers: &Numbers, rule: Rule) -> Vec3 {
        Vec3::from_array(numbers.map(|number| self.number(number, rule)))
    }

    fn vector(&mut self, vector: &Vector) -> Vec3 {
        self.numbers(&vector.0, FINITE)
    }

    fn rotation(&mut self, degrees: &Vector) -> Quat {
        rotation(self.vector(degrees))
    }

    /// Returns a place in the world.
    fn position(&mut self, vector: &Vector) -> Vec3 {
        self.place(vector, self.origin)
    }

    /// Returns a place, relative to `origin`.
    fn place(&mut self, vector: &Vector, origin: DVec3) -> Vec3 {
        self.vector(vector);
        Vec3::from_array(std::array::from_fn(|axis| local(vector.0[axis].value, origin[axis])))
    }

    fn direction(&mut self, direction: &Direction) -> Vec3 {
        let vector = self.numbers(&direction.0, FINITE);
        if vector.is_finite() && vector.try_normalize().is_none() {
            let message = "expected a direction: not all three numbers can be 0, or too large for a length";
            self.reader.error(&codes::RANGE, direction.0.place, message);
        }
        vector
    }

    fn power(&mut self, power: &Power) -> Vec3 {
        self.numbers(&power.0, ("a number from 0 to 10³⁰", |x| (0.0..=BRIGHTEST).contains(&x)))
    }
}

/// Returns the files of `folder`/`inner` with these endings, as a scene file in `folder` names them.
pub(crate) fn files_in(folder: &Path, inner: &Path, endings: &[&str]) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join(inner)).into_iter().flatten().flatten();
    let names = entries.map(|entry| inner.join(entry.file_name()).to_string_lossy().into_owned());
    let mut names: Vec<String> =
        names.filter(|name| endings.iter().any(|ending| name.ends_with(ending))).collect();
    names.sort();
    names
}
