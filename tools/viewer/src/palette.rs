//! The palette: any command, pipeline, scene or pass by a few letters of its name.

use crate::action::{Action, table};
use crate::app::App;
use crate::engine::SideId;
use crate::leave::Leave;
use eframe::egui::{self, Context, Key, RichText, ScrollArea, TextEdit, Vec2, vec2};
use frame_graph::Overrides;

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

/// A file that the user names: a path that ends as pipelines or scenes do.
fn typed(text: &str) -> Vec<Item> {
    let text = text.trim();
    let item = |kind, does| Item { kind, name: text.to_owned(), about: "this file".to_owned(), does };
    if text.ends_with(".ron") {
        let mut all = vec![
            item("pipeline", Does::Pipeline(SideId::A, text.to_owned())),
            item("compare with", Does::Pipeline(SideId::B, text.to_owned())),
            item("scene", Does::Scene(text.to_owned())),
        ];
        // The first is what Enter opens.
        if is_scene(text) {
            all.rotate_right(1);
        }
        all
    } else if text.ends_with(".glb") || text.ends_with(".gltf") {
        vec![item("scene", Does::Scene(text.to_owned()))]
    } else {
        Vec::new()
    }
}

/// Whether a RON file says of itself that it is a scene: its first word is `Scene`.
fn is_scene(path: &str) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let of_file = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    text.lines().find(of_file).is_some_and(|line| line.trim_start().starts_with("Scene"))
}

/// Shows the palette where it is open.
pub(crate) fn show(app: &mut App, context: &Context) {
    let Some(mut palette) = app.palette.take() else { return };
    let mut found = matching(items(app, context), &palette.text);
    found.extend(typed(&palette.text));
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
            app.leave(Leave::Pipeline(side, name, Overrides::default()), context);
        }
        Some(Does::Scene(name)) => app.leave(Leave::Scene(name), context),
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
        assert_eq!(typed("my/variant.ron").len(), 3);
        assert_eq!(typed("model.glb").len(), 1);
        assert!(typed("model").is_empty());
    }
}
