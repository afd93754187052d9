//! The palette: any command, pipeline, scene or pass by a few letters of its name.

use crate::action::{Action, table};
use crate::app::App;
use crate::engine::SideId;
use crate::files::{Kind, kind_of, listed};
use crate::panel::open::What;
use eframe::egui::{self, Context, Key, RichText, ScrollArea, TextEdit, Vec2, vec2};
use std::path::Path;

/// The palette while it is open.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    text: String,
    chosen: usize,
    opened: bool,
}

/// Something that can be chosen.
#[derive(Clone, Debug, PartialEq)]
struct Item {
    /// Its kind, in words.
    kind: &'static str,
    /// Its name.
    name: String,
    /// A line about it.
    about: String,
    /// The effect of choosing it.
    does: Does,
}

#[derive(Clone, Debug, PartialEq)]
enum Does {
    Act(Action),
    Pipeline(SideId, String),
    Scene(String),
    Pass(String),
    Bookmark(String),
}

/// The most items that are listed.
const MOST: usize = 60;

/// The size of the list, if the window has room for it.
const LIST: Vec2 = vec2(560.0, 380.0);

/// The part of a window that the palette leaves free at both sides, and around the list.
const FREE: Vec2 = vec2(40.0, 90.0);

fn items(app: &App, context: &Context) -> Vec<Item> {
    let actions = table().into_iter().map(|entry| Item {
        kind: "command",
        name: entry.about.to_owned(),
        about: entry.key.map_or(String::new(), |key| context.format_shortcut(&key)),
        does: Does::Act(entry.action),
    });
    let pipelines = app.library.pipelines().iter().flat_map(|named| {
        [(SideId::A, "pipeline"), (SideId::B, "compare with")].map(|(side, kind)| Item {
            kind,
            name: named.name.clone(),
            about: crate::panel::library::about(named).to_owned(),
            does: Does::Pipeline(side, named.name.clone()),
        })
    });
    let scenes = app.library.scenes().iter().map(|named| Item {
        kind: "scene",
        name: named.name.clone(),
        about: crate::panel::library::about(named).to_owned(),
        does: Does::Scene(named.name.clone()),
    });
    let passes = app.now.side(SideId::A).into_iter().flat_map(|side| &side.plan.passes).map(|pass| Item {
        kind: "pass",
        name: pass.name.to_string(),
        about: pass.kind.to_string(),
        does: Does::Pass(pass.name.to_string()),
    });
    let bookmarks = app.bookmarks().map(|bookmark| Item {
        kind: "bookmark",
        name: bookmark.name.clone(),
        about: "a camera of this scene".to_owned(),
        does: Does::Bookmark(bookmark.name.clone()),
    });
    actions.chain(pipelines).chain(scenes).chain(passes).chain(bookmarks).collect()
}

/// The items that have every word of the text in their kind and name, or at least in what is said about them; those whose
/// names are it, or begin with it, first.
fn matching(mut items: Vec<Item>, text: &str) -> Vec<Item> {
    let text = text.trim().to_lowercase();
    let rank = |item: &Item| {
        let name = item.name.to_lowercase();
        let named = format!("{} {name}", item.kind);
        let all = format!("{named} {}", item.about.to_lowercase());
        let has = |text: &str, within: &str| text.split_whitespace().all(|word| within.contains(word));
        if name == text {
            Some(0)
        } else if name.starts_with(&text) {
            Some(1)
        } else if has(&text, &named) {
            Some(2)
        } else {
            has(&text, &all).then_some(3)
        }
    };
    items.retain(|item| rank(item).is_some());
    // Of names that fit alike the shortest is meant.
    let length = |item: &Item| if text.is_empty() { 0 } else { item.name.len() };
    items.sort_by_key(|item| (rank(item), length(item)));
    items.truncate(MOST);
    items
}

/// A file that the user names: as what its ending and its first word say, or as all that it could be.
fn typed(text: &str) -> Vec<Item> {
    let text = text.trim();
    let kind = kind_of(Path::new(text));
    let mut all = Vec::new();
    if kind == Some(Kind::Pipeline) || (kind.is_none() && text.ends_with(".ron")) {
        all.extend(of_pipeline(text));
    }
    let of_scene = text.ends_with(".ron") || scene::is_geometry(text);
    if kind == Some(Kind::Scene) || (kind.is_none() && of_scene) {
        all.push(of_scene_file(text));
    }
    all
}

fn file(kind: &'static str, name: &str, does: Does) -> Item {
    Item { kind, name: name.to_owned(), about: "this file".to_owned(), does }
}

fn of_pipeline(name: &str) -> [Item; 2] {
    [(SideId::A, "pipeline"), (SideId::B, "compare with")]
        .map(|(side, kind)| file(kind, name, Does::Pipeline(side, name.to_owned())))
}

fn of_scene_file(name: &str) -> Item {
    file("scene", name, Does::Scene(name.to_owned()))
}

/// The files that were opened lately, and those of the working folder.
fn files(app: &mut App) -> Vec<Item> {
    let with = |mut all: Vec<String>, recent: &[String]| {
        let recent = listed(recent);
        all.retain(|name| !recent.contains(name));
        all.extend(recent);
        all
    };
    let pipelines = with(app.beside.of(Kind::Pipeline), &app.remembered.recent_pipelines);
    let scenes = with(app.beside.of(Kind::Scene), &app.remembered.recent_scenes);
    let pipelines = pipelines.iter().flat_map(|name| of_pipeline(name));
    pipelines.chain(scenes.iter().map(|name| of_scene_file(name))).collect()
}

/// Shows the palette where it is open.
pub(crate) fn show(app: &mut App, context: &Context) {
    let Some(mut palette) = app.palette.take() else { return };
    let mut all = items(app, context);
    all.extend(files(app));
    let mut found = matching(all, &palette.text);
    let named = typed(&palette.text);
    found.extend(named.into_iter().filter(|item| !found.contains(item)).collect::<Vec<_>>());
    let (up, down, enter, escape) = context.input_mut(|input| {
        let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
        (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Enter), pressed(Key::Escape))
    });
    let last = found.len().saturating_sub(1);
    palette.chosen =
        palette.chosen.saturating_add(usize::from(down)).min(last).saturating_sub(usize::from(up));
    let mut done = enter.then(|| found.get(palette.chosen).cloned()).flatten();
    let list = LIST.min(context.content_rect().size() - FREE).max(Vec2::ZERO);
    let modal = egui::Modal::new(egui::Id::unique("palette")).show(context, |ui| {
        ui.set_width(list.x);
        let field = TextEdit::singleline(&mut palette.text)
            .hint_text("A command, pipeline, scene, pass, or the path of a file")
            .desired_width(f32::INFINITY);
        let response = ui.add(field);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Palette"));
        if !palette.opened {
            response.request_focus();
            palette.opened = true;
        }
        if response.changed() {
            palette.chosen = 0;
        }
        ScrollArea::vertical()
            .max_height(list.y)
            .min_scrolled_height(list.y)
            .auto_shrink([false, false])
            .show(ui, |ui| {
                for (i, item) in found.iter().enumerate() {
                    ui.horizontal(|ui| {
                        ui.weak(RichText::new(format!("{:>12}", item.kind)).monospace());
                        let response = ui.selectable_label(i == palette.chosen, &item.name);
                        if i == palette.chosen && (up || down) {
                            response.scroll_to_me(None);
                        }
                        if response.clicked() {
                            done = Some(item.clone());
                        }
                        ui.add(egui::Label::new(RichText::new(&item.about).weak()).truncate());
                    });
                }
            });
    });
    let ends = escape || modal.should_close() || done.is_some();
    if !ends {
        app.palette = Some(palette);
    }
    match done.map(|item| item.does) {
        // It is closed already.
        Some(Does::Act(Action::Palette)) | None => {}
        Some(Does::Act(action)) => app.act(action, context),
        Some(Does::Pipeline(side, name)) => {
            app.open(What::Pipeline(side), name, context);
        }
        Some(Does::Scene(name)) => app.open(What::Scene, name, context),
        Some(Does::Bookmark(name)) => app.go_to_bookmark(&name),
        Some(Does::Pass(name)) => {
            app.look_at(SideId::A, &name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(kind: &'static str, name: &str, about: &str) -> Item {
        Item { kind, name: name.to_owned(), about: about.to_owned(), does: Does::Scene(name.to_owned()) }
    }

    #[test]
    fn names_that_begin_with_the_text_come_first() {
        let items = vec![
            item("pipeline", "ism-invtm", "lights by the inverse transform method"),
            item("pipeline", "tcas", "as `ism-invtm`, by chains"),
            item("pass", "lights/invtm", ""),
            item("scene", "atrium-spot", "the same by night"),
            item("scene", "atrium", "a court"),
        ];
        let names = |text: &str| {
            let found = matching(items.clone(), text);
            found.into_iter().map(|item| item.name).collect::<Vec<_>>()
        };
        assert_eq!(names("ism"), ["ism-invtm", "tcas"]);
        assert_eq!(names("atrium"), ["atrium", "atrium-spot"]);
        assert_eq!(names("invtm"), ["ism-invtm", "lights/invtm", "tcas"]);
        assert_eq!(names("scene night"), ["atrium-spot"]);
        assert_eq!(names("scene atr"), ["atrium", "atrium-spot"]);
        assert_eq!(names("").len(), 5);
        assert!(names("nothing like it").is_empty());
    }

    #[test]
    fn a_path_can_be_opened_as_what_its_ending_says() {
        assert_eq!(typed("my/variant.ron").len(), 3, "it is not there, and could be anything");
        assert_eq!(typed("model.glb").len(), 1);
        assert!(typed("model").is_empty());
        let folder = tempfile::tempdir().unwrap();
        for (text, expected) in [("Scene(", 1), ("Pipeline(", 2)] {
            let path = folder.path().join("own.ron");
            std::fs::write(&path, text).unwrap();
            assert_eq!(typed(&path.display().to_string()).len(), expected, "{text}");
        }
    }
}
