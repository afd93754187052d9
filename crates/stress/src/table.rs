//! The table of extremes, read from `cases.ron`.

use crate::case::{Case, Expect};
use crate::room::Room;
use crate::triangles::Mesh;
use serde::Deserialize;

/// The name of the plain scene.
pub(crate) const PLAIN: &str = "plain";

/// A case, as the table describes it.
#[derive(Deserialize)]
#[serde(rename = "Case", deny_unknown_fields)]
struct Row {
    group: String,
    name: String,
    about: String,
    expect: Expect,
    /// The changes of the room; `None` for the plain one.
    room: Option<Room>,
    /// The mesh of the file `NAME.gltf`.
    file: Option<Mesh>,
    size: Option<(u32, u32)>,
    #[serde(default = "one")]
    frames: u32,
    #[serde(default)]
    set: Vec<(String, String)>,
}

fn one() -> u32 {
    1
}

fn rows() -> Vec<Row> {
    ron::from_str(include_str!("cases.ron")).expect("cases.ron is a list of cases")
}

impl Row {
    fn case(self) -> Case {
        let Row { group, name, about, expect, room, file, size, frames, set } = self;
        let is_plain = room.is_none() && file.is_none();
        let mut room = room.unwrap_or_default();
        if !is_plain {
            room.about.clone_from(&about);
        }
        let mut files = Vec::new();
        if let Some(mesh) = file {
            let file = format!("{name}.gltf");
            if mesh.replaces_box() {
                room = Room::of_file(&file, about.clone());
            }
            files.push((file, mesh.gltf()));
        }
        Case { name, group, about, scene: room.text(), files, size, frames, set, expect }
    }
}

/// Returns all cases. The first is the plain scene, with which others are compared.
pub fn cases() -> Vec<Case> {
    rows().into_iter().map(Row::case).collect()
}

/// Returns the plain scene.
pub(crate) fn plain() -> Case {
    rows().swap_remove(0).case()
}
