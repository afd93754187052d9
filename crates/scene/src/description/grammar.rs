//! Reads a description from the syntax tree of a scene file: every value is checked at its place, and all
//! errors are reported at once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use data_file::codes::scene as codes;
use data_file::paths::{OUTSIDE, may_name};
use data_file::reader::{self, Fields, Form, Node, Reader};
use data_file::{Diagnostic, Diagnostics, Place, Source};
use glam::{DVec3, Vec3};

use super::{
    At, CameraKeys, Description, Geometry, Keyframes, Keys, LightKeys, Object, ObjectKeys, numbers, rotation,
};
use crate::built_in;
use crate::camera::Camera;
use crate::light::{BRIGHTEST, Light, LightKind};
use crate::model::Transform;
use crate::origin::{local, world};

const SCENE: &[&str] = &["about", "geometry", "camera", "lights", "lights_from_file", "keyframes"];
const CAMERA: &[&str] = &["position", "target", "up", "vertical_fov_deg", "near"];
const SPOT: &[&str] = &["name", "position", "direction", "intensity", "outer_deg", "inner_deg"];
const POINT: &[&str] = &["name", "position", "intensity"];
const DIRECTIONAL: &[&str] = &["name", "direction", "irradiance"];
const KEYFRAMES: &[&str] = &["frames_per_second", "repeat", "camera", "lights", "objects"];
const GEOMETRY: &str = "`BuiltIn(\"name\")`, `File(\"model.glb\")` or `Objects([…])`";
const TRANSFORM: &str = "`Transform(translate: (x, y, z), rotate_deg: (x, y, z), scale: (x, y, z))`";
const FINITE: &str = "a finite number";

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
    let objects = BTreeMap::new();
    reader::parse(source, |reader, tree| Grammar { reader, folder, origin, objects }.scene(tree))
}

struct Grammar<'a, 'b> {
    reader: &'a mut Reader<'b>,
    folder: Option<(&'a Path, &'a [PathBuf])>,
    origin: DVec3,
    /// Names of objects, at any depth: where they stand, and what is subtracted from their places, which is nothing
    /// within another object.
    objects: BTreeMap<String, (Place, DVec3)>,
}

/// A condition on a number, and its description for messages.
type Rule = (&'static str, fn(f32) -> bool);

impl Grammar<'_, '_> {
    fn scene(mut self, tree: &Node) -> Option<Description> {
        let fields = self.reader.fields(tree, "`Scene(…)`", &[("Scene", SCENE)])?;
        let about = fields.get("about").and_then(|node| self.reader.text(node, "text"));
        let geometry =
            self.reader.need(&fields, "geometry").and_then(|node| self.geometry(node, self.origin));
        let camera = fields.get("camera").map(|node| self.camera(node));
        let lights = fields.get("lights").map(|node| self.lights(node)).unwrap_or_default();
        let lights_from_file = fields.get("lights_from_file").map_or(Some(true), |node| self.bool(node));
        let keyframes = fields.get("keyframes").map(|node| self.keyframes(node));
        Some(Description {
            about: about.unwrap_or_default().to_owned(),
            geometry: geometry?,
            camera: camera.map_or(Some(None), |camera| camera.map(Some))?,
            lights,
            lights_from_file: lights_from_file?,
            keyframes: keyframes.map_or(Some(None), |keyframes| keyframes.map(Some))?,
        })
    }

    fn geometry(&mut self, node: &Node, origin: DVec3) -> Option<Geometry> {
        let (name, [item]) = (match &node.form {
            Form::Tuple(Some(name), items) => (name, items.as_slice()),
            _ => {
                self.reader.wrong(node, GEOMETRY);
                return None;
            }
        }) else {
            self.reader.wrong(node, GEOMETRY);
            return None;
        };
        match name.text.as_str() {
            "BuiltIn" => {
                let name = self.text(item, "the name of a built-in geometry")?;
                if !built_in::names().contains(&name.value.as_str()) {
                    let message = format!("there is no built-in geometry `{}`", name.value);
                    let error = Diagnostic::new(&codes::NAME, message)
                        .label(self.reader.span(name.place), "not built in")
                        .suggest("built-in geometries", &name.value, built_in::names());
                    self.reader.tell(error);
                }
                Some(Geometry::BuiltIn(name))
            }
            "File" => {
                let file = self.text(item, "the path of a .glb or .gltf file")?;
                self.file_is_there(&file);
                Some(Geometry::File(file))
            }
            "Objects" => {
                let items = self.reader.list(item, "a list: [Object(…), …]");
                Some(Geometry::Objects(items.iter().filter_map(|item| self.object(item, origin)).collect()))
            }
            other => {
                let place = Place { file: self.reader.file, start: name.start, end: name.end };
                let error = Diagnostic::new(
                    &data_file::codes::UNKNOWN_FORM,
                    format!("`{other}` is not known here: expected {GEOMETRY}"),
                )
                .label(self.reader.span(place), "")
                .suggest("forms", other, ["BuiltIn", "File", "Objects"]);
                self.reader.tell(error);
                None
            }
        }
    }

    fn file_is_there(&mut self, file: &At<String>) {
        let Some((folder, roots)) = self.folder else { return };
        let path = folder.join(&file.value);
        let scene = folder.join("scene");
        if !may_name(&scene, &path, roots) {
            let error = Diagnostic::new(&codes::NAME, format!("the file {} {OUTSIDE}", path.display()))
                .label(self.reader.span(file.place), "outside");
            self.reader.tell(error);
            return;
        }
        if path.exists() {
            return;
        }
        let error = Diagnostic::new(&codes::NAME, format!("there is no file {}", path.display()))
            .label(self.reader.span(file.place), "not found")
            .note("file names start from the folder of the scene file");
        let inner = Path::new(&file.value).parent().unwrap_or(Path::new(""));
        let known = models_in(folder, inner);
        let error = if known.is_empty() {
            error
        } else {
            error.suggest("glTF files there", &file.value, known.iter().map(String::as_str))
        };
        self.reader.tell(error);
    }

    fn object(&mut self, node: &Node, origin: DVec3) -> Option<Object> {
        let forms = [("Object", &["name", "geometry", "transform"][..])];
        let fields = self.reader.fields(node, "`Object(name: \"…\", geometry: …)`", &forms)?;
        let name = self.reader.need(&fields, "name").and_then(|node| self.text(node, "a name"));
        if let Some(name) = &name {
            match self.objects.get(&name.value) {
                Some((first, _)) => {
                    self.reader.duplicate(&format!("the object `{}`", name.value), name.place, *first);
                }
                None => {
                    self.objects.insert(name.value.clone(), (name.place, origin));
                }
            }
        }
        let geometry = self.reader.need(&fields, "geometry");
        let geometry = geometry.and_then(|node| self.geometry(node, DVec3::ZERO));
        let unmoved = Transform { translation: (DVec3::ZERO - origin).as_vec3(), ..Transform::default() };
        let transform = fields.get("transform").map_or(Some(unmoved), |node| self.transform(node, origin));
        Some(Object { name: name?, geometry: geometry?, transform: transform? })
    }

    fn transform(&mut self, node: &Node, origin: DVec3) -> Option<Transform> {
        let forms = [("Transform", &["translate", "rotate_deg", "scale"][..])];
        let fields = self.reader.fields(node, TRANSFORM, &forms)?;
        let unmoved = Some((DVec3::ZERO - origin).as_vec3());
        let translation = fields.get("translate").map_or(unmoved, |node| self.place(node, origin));
        let mut vector = |name: &str, otherwise: Vec3| {
            fields.get(name).map_or(Some(otherwise), |node| self.finite_vector(node))
        };
        let turn = vector("rotate_deg", Vec3::ZERO);
        let scale = vector("scale", Vec3::ONE);
        Some(Transform { translation: translation?, rotation: rotation(turn?), scale: scale? })
    }

    fn camera(&mut self, node: &Node) -> Option<Camera> {
        let fields =
            self.reader.fields(node, "`Camera(position: …, target: …, …)`", &[("Camera", CAMERA)])?;
        let position = self.needed(&fields, "position", Self::position);
        let target = self.needed(&fields, "target", Self::position);
        let up = fields.get("up").map_or(Some(Vec3::Y), |node| self.direction(node));
        let fov = self.needed(&fields, "vertical_fov_deg", |grammar, node| {
            grammar.number(node, ("degrees between 0 and 180", |x| x > 0.0 && x < 180.0))
        });
        let near = fields.get("near").map_or(Some(0.0), |node| {
            self.number(node, ("a distance in metres, above 0", |x| x.is_finite() && x > 0.0))
        });
        // Two points that are one for `f32` so far from the origin may be two for another origin.
        let exact = |name: &str| fields.get(name).and_then(numbers).map(|numbers| numbers.map(world));
        if let (Some(from), Some(to), Some(node)) = (position, target, fields.get("target"))
            && from == to
            && exact("position") == exact("target")
        {
            let place = self.reader.place(node);
            self.reader
                .error(&codes::CONFLICT, place, "the camera's position and target are the same point")
                .labels[0]
                .message = "it looks nowhere".to_owned();
        }
        Some(Camera {
            position: position?,
            target: target?,
            up: up?,
            vertical_fov: fov?.to_radians(),
            near: near?,
        })
    }

    fn lights(&mut self, node: &Node) -> Vec<Light> {
        let items = self.reader.list(node, "a list: [Spot(…), Point(…), Directional(…)]");
        items.iter().enumerate().filter_map(|(index, item)| self.light(item, index)).collect()
    }

    fn light(&mut self, node: &Node, index: usize) -> Option<Light> {
        let forms = [("Spot", SPOT), ("Point", POINT), ("Directional", DIRECTIONAL)];
        let fields = self.reader.fields(node, "`Spot(…)`, `Point(…)` or `Directional(…)`", &forms)?;
        let name = match fields.get("name") {
            Some(node) => self.text(node, "a name").map(|name| name.value),
            None => Some(String::new()),
        };
        let name = name.map(|name| if name.is_empty() { format!("light {index}") } else { name });
        let kind = match fields.form() {
            "Spot" => self.cone(&fields),
            "Point" => Some(LightKind::Point),
            _ => Some(LightKind::Directional),
        };
        let position = match kind {
            Some(LightKind::Directional) => Some(Vec3::ZERO),
            _ => self.needed(&fields, "position", Self::position),
        };
        let direction = match kind {
            Some(LightKind::Point) => Some(Vec3::NEG_Y),
            _ => self.needed(&fields, "direction", Self::direction).map(Vec3::normalize),
        };
        let intensity = if fields.form() == "Directional" { "irradiance" } else { "intensity" };
        let intensity = self.needed(&fields, intensity, Self::power);
        Some(Light {
            name: name?,
            kind: kind?,
            position: position?,
            direction: direction?,
            intensity: intensity?,
        })
    }

    fn cone(&mut self, fields: &Fields<'_>) -> Option<LightKind> {
        let outer = self.needed(fields, "outer_deg", |grammar, node| {
            let expected = "half the cone's angle, above 0 and at most 90 degrees";
            grammar.number(node, (expected, |x| x > 0.0 && x <= 90.0))
        });
        let inner = match fields.get("inner_deg") {
            Some(node) => {
                let expected = "half the inner cone's angle, 0 to 90 degrees";
                self.number(node, (expected, |x| (0.0..=90.0).contains(&x)))
            }
            None => outer,
        };
        let (outer, inner) = (outer?, inner?);
        if let (true, Some(inner_node), Some(outer_node)) =
            (inner > outer, fields.get("inner_deg"), fields.get("outer_deg"))
        {
            let message = format!("the inner cone, {inner}°, is wider than the outer, {outer}°");
            let error = Diagnostic::new(&codes::CONFLICT, message)
                .label(self.reader.span_of(inner_node), "at most `outer_deg`")
                .label(self.reader.span_of(outer_node), "the outer cone");
            self.reader.tell(error);
        }
        Some(LightKind::Spot { inner: inner.to_radians(), outer: outer.to_radians() })
    }

    fn keyframes(&mut self, node: &Node) -> Option<Keyframes> {
        let fields = self.reader.fields(node, "`Keyframes(…)`", &[("Keyframes", KEYFRAMES)])?;
        let rate = fields.get("frames_per_second").map_or(Some(30.0), |node| {
            self.number(node, ("frames per second, above 0", |x| x.is_finite() && x > 0.0))
        });
        let repeat = fields.get("repeat").map_or(Some(false), |node| self.bool(node));
        let mut end = 0.0;
        let camera = fields.get("camera").map(|node| {
            let value = self.camera_keys(node, &mut end);
            At { value, place: self.reader.head(node) }
        });
        let lights = fields.get("lights").map(|node| self.named(node, "a light"));
        let lights = lights.unwrap_or_default().into_iter();
        let lights = lights.map(|(name, node)| (name, self.light_keys(node, &mut end))).collect();
        let objects = fields.get("objects").map(|node| self.named(node, "an object")).unwrap_or_default();
        for (name, _) in &objects {
            if !self.objects.contains_key(&name.value) && !self.reader.is_full() {
                let message = format!("keyframes for `{}`, but no object has this name", name.value);
                let error = Diagnostic::new(&codes::NAME, message)
                    .label(self.reader.span(name.place), "no such object")
                    .suggest("objects", &name.value, self.objects.keys().map(String::as_str));
                self.reader.tell(error);
            }
        }
        let objects = objects.into_iter().map(|(name, node)| {
            let origin = self.objects.get(&name.value).map_or(DVec3::ZERO, |(_, origin)| *origin);
            (name, self.object_keys(node, origin, &mut end))
        });
        let objects = objects.collect();
        Some(Keyframes { frames_per_second: rate?, repeat: repeat?, end, camera, lights, objects })
    }

    fn camera_keys(&mut self, node: &Node, end: &mut f32) -> CameraKeys {
        let keys = self.keys(node, &["time", "position", "target"], end);
        CameraKeys {
            position: self.channel(&keys, "position", Self::position),
            target: self.channel(&keys, "target", Self::position),
        }
    }

    fn light_keys(&mut self, node: &Node, end: &mut f32) -> LightKeys {
        let keys = self.keys(node, &["time", "position", "direction", "intensity"], end);
        LightKeys {
            position: self.channel(&keys, "position", Self::position),
            direction: self.channel(&keys, "direction", Self::direction),
            intensity: self.channel(&keys, "intensity", Self::power),
        }
    }

    fn object_keys(&mut self, node: &Node, origin: DVec3, end: &mut f32) -> ObjectKeys {
        let keys = self.keys(node, &["time", "translate", "rotate_deg", "scale"], end);
        let degrees = self.channel(&keys, "rotate_deg", Self::finite_vector);
        ObjectKeys {
            translate: self.channel(&keys, "translate", |grammar, node| grammar.place(node, origin)),
            rotate: degrees.into_iter().map(|(time, degrees)| (time, rotation(degrees))).collect(),
            scale: self.channel(&keys, "scale", Self::finite_vector),
        }
    }

    /// Reads the entries of a map whose keys are names, and reports names that are given twice.
    fn named<'n>(&mut self, node: &'n Node, what: &str) -> Vec<(At<String>, &'n Node)> {
        let Form::Map(entries) = &node.form else {
            self.reader.wrong(node, &format!("a map: {{ \"the name of {what}\": [Key(…), …] }}"));
            return Vec::new();
        };
        let mut found: Vec<(At<String>, &Node)> = Vec::new();
        let mut places = BTreeMap::new();
        for (key, value) in entries {
            let Some(name) = self.text(key, &format!("the name of {what}")) else { continue };
            match places.get(&name.value) {
                Some(first) => self.reader.duplicate(&format!("`{}`", name.value), name.place, *first),
                None => {
                    places.insert(name.value.clone(), name.place);
                    found.push((name, value));
                }
            }
        }
        found
    }

    /// Reads the fields of each valid key with its time; `end` is raised to the last time.
    fn keys<'n>(&mut self, node: &'n Node, names: &'static [&'static str], end: &mut f32) -> Vec<Key<'n>> {
        let items = self.reader.list(node, "a list: [Key(time: …, …), …]");
        let mut keys = Vec::with_capacity(items.len());
        for item in items {
            let Some(fields) = self.reader.fields(item, "`Key(time: …, …)`", &[("Key", names)]) else {
                continue;
            };
            let Some(node) = self.reader.need(&fields, "time") else { continue };
            let rule: Rule = ("a time in seconds, not negative", |x| x.is_finite() && x >= 0.0);
            let Some(value) = self.number(node, rule) else { continue };
            *end = end.max(value);
            keys.push(Key { time: At { value, place: self.reader.place(node) }, fields });
        }
        keys
    }

    /// Reads the keys that set one value; their times must rise.
    fn channel(
        &mut self,
        keys: &[Key<'_>],
        name: &str,
        read: impl Fn(&mut Self, &Node) -> Option<Vec3>,
    ) -> Keys<Vec3> {
        let mut found = Keys::new();
        let mut last: Option<&At<f32>> = None;
        for key in keys {
            let Some(node) = key.fields.get(name) else { continue };
            if let Some(last) = last.filter(|last| key.time.value <= last.value) {
                let message = format!(
                    "the keys of `{name}` must be in the order of their times: {:?} s is not later than {:?} s",
                    key.time.value, last.value
                );
                let error = Diagnostic::new(&codes::CONFLICT, message)
                    .label(self.reader.span(key.time.place), "not later")
                    .label(self.reader.span(last.place), "than the key before it");
                self.reader.tell(error);
            }
            last = Some(&key.time);
            found.extend(read(self, node).map(|value| (key.time.value, value)));
        }
        found
    }

    fn needed<T>(
        &mut self,
        fields: &Fields<'_>,
        name: &str,
        read: impl Fn(&mut Self, &Node) -> Option<T>,
    ) -> Option<T> {
        self.reader.need(fields, name).and_then(|node| read(self, node))
    }

    fn text(&mut self, node: &Node, expected: &str) -> Option<At<String>> {
        let value = self.reader.text(node, expected)?.to_owned();
        Some(At { value, place: self.reader.place(node) })
    }

    fn bool(&mut self, node: &Node) -> Option<bool> {
        if let Form::Bool(value) = node.form {
            return Some(value);
        }
        self.reader.wrong(node, "`true` or `false`");
        None
    }

    /// Reads a number that satisfies the rule.
    fn number(&mut self, node: &Node, (expected, keeps): Rule) -> Option<f32> {
        let Form::Number(number) = node.form else {
            self.reader.wrong(node, expected);
            return None;
        };
        let value = local(number, 0.0);
        if keeps(value) {
            return Some(value);
        }
        let place = self.reader.place(node);
        self.reader.error(&codes::RANGE, place, format!("expected {expected}, found {value}"));
        None
    }

    /// Reads three numbers, each of which satisfies the rule.
    fn vector(&mut self, node: &Node, expected: &str, rule: Rule) -> Option<Vec3> {
        match &node.form {
            Form::Tuple(None, items) if items.len() == 3 => {
                let [x, y, z] = [0, 1, 2].map(|i| self.number(&items[i], rule));
                Some(Vec3::new(x?, y?, z?))
            }
            _ => {
                self.reader.wrong(node, expected);
                None
            }
        }
    }

    fn finite_vector(&mut self, node: &Node) -> Option<Vec3> {
        self.vector(node, "three numbers: (x, y, z)", (FINITE, f32::is_finite))
    }

    /// Reads a place in the world.
    fn position(&mut self, node: &Node) -> Option<Vec3> {
        self.place(node, self.origin)
    }

    /// Reads a place, relative to `origin`.
    fn place(&mut self, node: &Node, origin: DVec3) -> Option<Vec3> {
        self.finite_vector(node)?;
        let numbers = numbers(node)?;
        Some(Vec3::from_array(std::array::from_fn(|i| local(numbers[i], origin[i]))))
    }

    fn direction(&mut self, node: &Node) -> Option<Vec3> {
        let direction = self.vector(node, "a direction: (x, y, z)", (FINITE, f32::is_finite))?;
        if direction.try_normalize().is_none() {
            let place = self.reader.place(node);
            let message = "expected a direction: not all three numbers can be 0, or too large for a length";
            self.reader.error(&codes::RANGE, place, message);
            return None;
        }
        Some(direction)
    }

    fn power(&mut self, node: &Node) -> Option<Vec3> {
        let rule: Rule = ("a number from 0 to 10³⁰", |x| (0.0..=BRIGHTEST).contains(&x));
        self.vector(node, "red, green and blue: (r, g, b)", rule)
    }
}

/// A key of an animation.
struct Key<'n> {
    time: At<f32>,
    fields: Fields<'n>,
}

/// Returns the glTF files of `folder`/`inner`, as a scene file in `folder` names them.
fn models_in(folder: &Path, inner: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join(inner)).into_iter().flatten().flatten();
    let names = entries.map(|entry| inner.join(entry.file_name()).to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".glb") || n.ends_with(".gltf")).collect();
    names.sort();
    names
}
