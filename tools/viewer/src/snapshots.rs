//! Pictures that were kept, to flicker between them and what is rendered now.

use crate::app::App;
use crate::engine::SideId;
use eframe::egui::{ColorImage, Ui};
use std::sync::Arc;

/// The most that are kept.
const MOST: usize = 12;

/// A picture of side A as it was shown.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    /// The name, which can be changed.
    pub(crate) name: String,
    /// The picture.
    pub(crate) picture: Arc<ColorImage>,
    /// Differs between all snapshots.
    pub(crate) id: u64,
}

/// The pictures that were kept.
#[derive(Debug, Default)]
pub(crate) struct Snapshots {
    all: Vec<Snapshot>,
    made: u64,
    /// The one that is compared with.
    chosen: Option<u64>,
    /// Whether it is shown at the moment.
    shown: bool,
}

impl Snapshots {
    /// Keeps a picture, which is compared with from now on. The oldest goes where there are too many.
    pub(crate) fn keep(&mut self, of: &str, picture: Arc<ColorImage>) {
        self.made += 1;
        let name = format!("{} {of}", self.made);
        self.all.push(Snapshot { name, picture, id: self.made });
        if self.all.len() > MOST {
            self.all.remove(0);
        }
        (self.chosen, self.shown) = (Some(self.made), false);
    }

    fn remove(&mut self, id: u64) {
        self.all.retain(|snapshot| snapshot.id != id);
        if self.chosen == Some(id) {
            (self.chosen, self.shown) = (self.all.last().map(|last| last.id), false);
        }
    }

    /// Shows the chosen one, or again what is rendered.
    pub(crate) fn flick(&mut self) {
        self.shown = !self.shown && self.chosen.is_some();
    }

    /// Returns the one that is shown in place of what is rendered.
    pub(crate) fn shown(&self) -> Option<&Snapshot> {
        let chosen = self.chosen.filter(|_| self.shown)?;
        self.all.iter().find(|snapshot| snapshot.id == chosen)
    }
}

impl App {
    /// Keeps the picture of side A.
    pub(crate) fn keep_snapshot(&mut self) {
        let Some(side) = self.now.side(SideId::A) else { return };
        if let Some(picture) = &side.picture {
            self.snapshots.keep(&side.name, Arc::clone(picture));
        }
    }
}

/// Shows the list.
pub(crate) fn show(app: &mut App, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.strong("Snapshots");
        if ui.button("Keep the picture").on_hover_text("N").clicked() {
            app.keep_snapshot();
        }
        if app.snapshots.chosen.is_some() && ui.button("Flicker").on_hover_text("G").clicked() {
            app.snapshots.flick();
        }
    });
    let (mut chosen, mut removed) = (None, None);
    for snapshot in &app.snapshots.all {
        ui.horizontal(|ui| {
            let [width, height] = snapshot.picture.size;
            let is_chosen = app.snapshots.chosen == Some(snapshot.id);
            if ui.radio(is_chosen, format!("{} ({width}×{height})", snapshot.name)).clicked() {
                chosen = Some(snapshot.id);
            }
            if ui.small_button("Remove").clicked() {
                removed = Some(snapshot.id);
            }
        });
    }
    if let Some(id) = chosen {
        (app.snapshots.chosen, app.snapshots.shown) = (Some(id), true);
    }
    if let Some(id) = removed {
        app.snapshots.remove(id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Color32;

    fn picture() -> Arc<ColorImage> {
        Arc::new(ColorImage::filled([1, 1], Color32::RED))
    }

    #[test]
    fn the_newest_is_flickered_against() {
        let mut snapshots = Snapshots::default();
        snapshots.flick();
        assert!(snapshots.shown().is_none(), "there is none");
        snapshots.keep("ism", picture());
        snapshots.keep("tcas", picture());
        assert!(snapshots.shown().is_none());
        snapshots.flick();
        assert_eq!(snapshots.shown().map(|shown| shown.name.as_str()), Some("2 tcas"));
        snapshots.flick();
        assert!(snapshots.shown().is_none());
        snapshots.flick();
        snapshots.remove(2);
        assert!(snapshots.shown().is_none());
        snapshots.flick();
        assert_eq!(snapshots.shown().map(|shown| shown.name.as_str()), Some("1 ism"));
    }

    #[test]
    fn old_ones_go() {
        let mut snapshots = Snapshots::default();
        (0..2 * MOST).for_each(|_| snapshots.keep("ism", picture()));
        assert_eq!((snapshots.all.len(), snapshots.all[0].id), (MOST, MOST as u64 + 1));
    }
}
