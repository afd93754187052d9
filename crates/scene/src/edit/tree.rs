//! Finds the values of an edit in the tree of a scene file.

use std::collections::BTreeMap;

use crate::codes;
use data_file::Diagnostic;
use data_file::grammar::{Node, Parts, Reader, Shape};
use glam::{DVec3, Vec3};

use super::patches::{Items, Patches};
use super::value::{Field, Value, degrees, form, number};
use super::{CameraKey, LightKey, SceneEdit};
use crate::camera::Camera;
use crate::light::{Light, LightKind};

/// Adds to `patches` what makes the edit of a valid scene file.
pub(super) fn edit(reader: &mut Reader<'_>, tree: Node<'_>, patches: &mut Patches<'_>, edit: &SceneEdit) {
    let mut items = Items::of(tree);
    if let Some(camera) = &edit.camera {
        match tree.field("camera") {
            Some(node) => set_fields(node, patches, &camera_fields(camera, edit.origin, Some(node))),
            None => items.add(items.len(), format!("camera: {}", camera_text(camera, edit.origin))),
        }
    }
    edit_lights(reader, tree, &mut items, patches, edit);
    match tree.field("keyframes") {
        Some(node) => edit_keyframes(node, patches, edit),
        None => {
            let indent = items.indent(patches);
            items.add_some(keyframes(patches, edit, &indent));
        }
    }
    items.finish(patches);
}

impl Items {
    /// Adds an item behind all others, if there is one.
    fn add_some(&mut self, text: Option<String>) {
        if let Some(text) = text {
            self.add(self.len(), text);
        }
    }
}

/// Sets fields of a form, adds those that it lacks and removes those that are to be left out.
fn set_fields(node: Node<'_>, patches: &mut Patches<'_>, fields: &[Field]) {
    let Parts::Fields(known) = node.parts() else { return };
    let mut items = Items::of(node);
    let mut kept = known.len();
    for (name, value) in fields {
        match (known.iter().position(|(known, _)| known.text() == *name), value) {
            (Some(index), Some(value)) => value.write(known[index].1, patches),
            (Some(index), None) => items.remove(index),
            (None, _) => {}
        }
    }
    let left_out =
        |index: &usize| fields.iter().any(|(name, value)| value.is_none() && known[*index].0.text() == *name);
    while kept > 0 && left_out(&(kept - 1)) {
        kept -= 1;
    }
    for (name, value) in fields {
        if let (None, Some(value)) = (known.iter().find(|(known, _)| known.text() == *name), value) {
            items.add(kept, format!("{name}: {}", value.text()));
        }
    }
    items.finish(patches);
}

/// Returns the fields of a camera, given that of the file: what follows from the scene stays out.
fn camera_fields(camera: &Camera, origin: DVec3, file: Option<Node<'_>>) -> Vec<Field> {
    let has = |name: &str| file.is_some_and(|node| node.field(name).is_some());
    let most = 180f32.next_down();
    let mut fields = vec![
        ("position", Some(Value::Place { value: camera.position, origin })),
        ("target", Some(Value::Place { value: camera.target, origin })),
    ];
    if camera.up != Vec3::Y || has("up") {
        fields.push(("up", Some(Value::Vector(camera.up))));
    }
    fields.push(("vertical_fov_deg", Some(Value::Angle { radians: camera.vertical_fov, most })));
    if camera.near > 0.0 && (file.is_none() || has("near")) {
        fields.push(("near", Some(Value::Number(camera.near))));
    }
    fields
}

pub(super) fn camera_text(camera: &Camera, origin: DVec3) -> String {
    form("Camera", &camera_fields(camera, origin, None))
}

/// Returns the form of a light, and its fields, given that of the file.
fn light_fields(light: &Light, origin: DVec3, file: Option<Node<'_>>) -> (&'static str, Vec<Field>) {
    let position = ("position", Some(Value::Place { value: light.position, origin }));
    let direction = ("direction", Some(Value::Direction(light.direction)));
    let intensity = ("intensity", Some(Value::Vector(light.intensity)));
    match light.kind {
        LightKind::Point => ("Point", vec![position, intensity]),
        LightKind::Directional => {
            ("Directional", vec![direction, ("irradiance", Some(Value::Vector(light.intensity)))])
        }
        LightKind::Spot { inner, outer } => {
            let known = |name| file.and_then(|node| node.field(name));
            let kept = known("outer_deg").and_then(number).filter(|kept| kept.to_radians() == outer);
            // An inner cone that is read as wider than the outer is an error, be it by rounding.
            let outer_deg = kept.unwrap_or_else(|| degrees(outer).min(90.0));
            let outer_cone = ("outer_deg", Some(Value::Angle { radians: outer, most: 90.0 }));
            let mut fields = vec![position, direction, intensity, outer_cone];
            if inner != outer || known("inner_deg").is_some() {
                fields.push(("inner_deg", Some(Value::Angle { radians: inner, most: outer_deg })));
            }
            ("Spot", fields)
        }
    }
}

pub(super) fn light_text(light: &Light, origin: DVec3) -> String {
    let (name, fields) = light_fields(light, origin, None);
    let text = form(name, &fields);
    text.replacen('(', &format!("(name: {:?}, ", light.name), 1)
}

fn edit_lights(
    reader: &mut Reader<'_>,
    tree: Node<'_>,
    root: &mut Items,
    patches: &mut Patches<'_>,
    edit: &SceneEdit,
) {
    let list = tree.field("lights");
    let nodes = list.map(Node::items).unwrap_or_default();
    let name = |(index, node): (usize, &Node<'_>)| match node.field("name").map(|name| name.shape()) {
        Some(Shape::Text(name)) if !name.is_empty() => name,
        _ => format!("light {index}"),
    };
    let names: Vec<String> = nodes.iter().enumerate().map(name).collect();
    let known = edit.added.iter().filter(|light| names.contains(&light.name));
    // The first edit of a name is of the first light with that name, and so on.
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for light in edit.lights.iter().chain(known) {
        let count = seen.entry(&light.name).or_default();
        let found = names.iter().zip(&nodes).filter(|(name, _)| **name == light.name).nth(*count);
        *count += 1;
        let Some((_, node)) = found else {
            report_stranger(reader, list.or(tree.field("geometry")).unwrap_or(tree), &light.name, &names);
            continue;
        };
        let (form, fields) = light_fields(light, edit.origin, Some(*node));
        match node.shape() {
            Shape::Form(Some(known)) if known == form => set_fields(*node, patches, &fields),
            _ => patches.rewrite(*node, &light_text(light, edit.origin)),
        }
    }
    let mut items = list.map(Items::of);
    for removed in &edit.removed {
        match (names.iter().position(|name| name == removed), &mut items) {
            (Some(index), Some(items)) => items.remove(index),
            _ => report_stranger(reader, list.or(tree.field("geometry")).unwrap_or(tree), removed, &names),
        }
    }
    let added = edit.added.iter().filter(|light| !names.contains(&light.name));
    let texts: Vec<String> = added.map(|light| light_text(light, edit.origin)).collect();
    match &mut items {
        Some(items) => {
            // Behind the last that stays.
            let stays = |index: &usize| !edit.removed.contains(&names[*index]);
            let last = (0..items.len()).rev().find(stays).map_or(0, |index| index + 1);
            texts.into_iter().for_each(|text| items.add(last, text));
        }
        None if texts.is_empty() => {}
        None => root.add(root.len(), format!("lights: [{}]", texts.join(", "))),
    }
    if let Some(items) = items {
        items.finish(patches);
    }
}

/// Reports a light that the file does not have.
fn report_stranger(reader: &mut Reader<'_>, place: Node<'_>, name: &str, names: &[String]) {
    let error = Diagnostic::new(&codes::NAME, format!("the light `{name}` is not in `lights` of this file"))
        .label(reader.span(reader.head(reader.place(place))), "not here")
        .note("it belongs to the geometry, a glTF file, which is not written to")
        .note("`lights_from_file: false` leaves out the lights of that file; those in `lights` can be edited")
        .suggest("lights of this file", name, names.iter().map(String::as_str));
    reader.report(error);
}

fn camera_key(key: &CameraKey, origin: DVec3) -> Vec<Field> {
    let place = |value| Value::Place { value, origin };
    vec![
        ("time", Some(Value::Number(key.time))),
        ("position", key.position.map(place)),
        ("target", key.target.map(place)),
    ]
}

fn light_key(key: &LightKey, origin: DVec3) -> Vec<Field> {
    vec![
        ("time", Some(Value::Number(key.time))),
        ("position", key.position.map(|value| Value::Place { value, origin })),
        ("direction", key.direction.map(Value::Direction)),
        ("intensity", key.intensity.map(Value::Vector)),
    ]
}

/// The keys of one light or camera, as fields.
type KeyFields = Vec<Vec<Field>>;

fn camera_keys(edit: &SceneEdit) -> Option<KeyFields> {
    let fields = |key| camera_key(key, edit.origin);
    edit.camera_keys.as_ref().map(|keys| keys.iter().map(fields).collect())
}

fn light_keys(edit: &SceneEdit) -> impl Iterator<Item = (&str, KeyFields)> {
    let fields = |key| light_key(key, edit.origin);
    edit.light_keys.iter().map(move |(name, keys)| (name.as_str(), keys.iter().map(fields).collect()))
}

fn edit_keyframes(node: Node<'_>, patches: &mut Patches<'_>, edit: &SceneEdit) {
    let mut items = Items::of(node);
    let indent = items.indent(patches);
    match (node.field("camera"), camera_keys(edit)) {
        (Some(list), Some(keys)) => edit_keys(list, patches, &keys),
        (None, keys) => items.add_some(camera_keys_text(patches, keys, &indent)),
        (Some(_), None) => {}
    }
    match node.field("lights") {
        Some(map) => {
            let entries = map.entries();
            let mut items = Items::of(map);
            let inner = items.indent(patches);
            for (name, keys) in light_keys(edit) {
                let is = |key: &Node<'_>| matches!(key.shape(), Shape::Text(text) if text == name);
                match entries.iter().find(|(key, _)| is(key)) {
                    Some((_, list)) => edit_keys(*list, patches, &keys),
                    None => items.add_some(light_entry(patches, name, &keys, &inner)),
                }
            }
            items.finish(patches);
        }
        None => items.add_some(light_keys_text(patches, edit, &indent)),
    }
    items.finish(patches);
}

/// Returns `keyframes` as a new field, if the edit has keys.
pub(super) fn keyframes(patches: &Patches<'_>, edit: &SceneEdit, indent: &str) -> Option<String> {
    let (inner, end) = (patches.within(indent), patches.line_end());
    let camera = camera_keys_text(patches, camera_keys(edit), &inner);
    let lights = light_keys_text(patches, edit, &inner);
    let fields: Vec<_> = camera.into_iter().chain(lights).collect();
    let fields: String = fields.iter().map(|field| format!("{end}{inner}{field},")).collect();
    (!fields.is_empty()).then(|| format!("keyframes: Keyframes({fields}{end}{indent})"))
}

fn camera_keys_text(patches: &Patches<'_>, keys: Option<KeyFields>, indent: &str) -> Option<String> {
    let keys = keys.filter(|keys| !keys.is_empty())?;
    Some(format!("camera: {}", keys_text(patches, &keys, indent)))
}

fn light_keys_text(patches: &Patches<'_>, edit: &SceneEdit, indent: &str) -> Option<String> {
    let (inner, end) = (patches.within(indent), patches.line_end());
    let entries = light_keys(edit).filter_map(|(name, keys)| light_entry(patches, name, &keys, &inner));
    let entries: String = entries.map(|entry| format!("{end}{inner}{entry},")).collect();
    (!entries.is_empty()).then(|| format!("lights: {{{entries}{end}{indent}}}"))
}

fn light_entry(patches: &Patches<'_>, name: &str, keys: &KeyFields, indent: &str) -> Option<String> {
    (!keys.is_empty()).then(|| format!("{name:?}: {}", keys_text(patches, keys, indent)))
}

fn keys_text(patches: &Patches<'_>, keys: &KeyFields, indent: &str) -> String {
    let (inner, end) = (patches.within(indent), patches.line_end());
    let keys: String = keys.iter().map(|key| format!("{end}{inner}{},", form("Key", key))).collect();
    format!("[{keys}{end}{indent}]")
}

/// Makes the keys of a list those that are given. A key at the same time is the same key; of those between two such
/// keys, each new one is written over an old one, as long as there are any.
fn edit_keys(list: Node<'_>, patches: &mut Patches<'_>, keys: &KeyFields) {
    let old = list.items();
    let old_time = |node: &Node<'_>| node.field("time").and_then(number);
    let new_time = |fields: &Vec<Field>| match fields[0].1 {
        Some(Value::Number(time)) => Some(time),
        _ => None,
    };
    let mut items = Items::of(list);
    let (mut i, mut j) = (0, 0);
    while i < old.len() || j < keys.len() {
        // The next pair at one time: whichever of the old keys has it first.
        let pair = (i..old.len()).find_map(|a| {
            let b = (j..keys.len()).find(|b| new_time(&keys[*b]) == old_time(&old[a]))?;
            Some((a, b))
        });
        let (to_i, to_j) = pair.unwrap_or((old.len(), keys.len()));
        let both = (to_i - i).min(to_j - j);
        for k in 0..both {
            set_fields(old[i + k], patches, &keys[j + k]);
        }
        (i + both..to_i).for_each(|index| items.remove(index));
        for key in &keys[j + both..to_j] {
            items.add(i + both, form("Key", key));
        }
        (i, j) = (to_i, to_j);
        if let Some((a, b)) = pair {
            set_fields(old[a], patches, &keys[b]);
            (i, j) = (a + 1, b + 1);
        }
    }
    items.finish(patches);
}
