//! Files that were saved: what they are part of is loaded again.

use super::{RECENT, Session, report};
use crate::engine::Publisher;
use crate::engine::model::SideId;
use crate::engine::watch::Saved;
use renderer::{Reload, reload_all};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

impl Session {
    /// Loads again what was saved.
    pub(super) fn reload(&mut self, saved: &Saved, waits: &AtomicBool, publisher: &Publisher) {
        let began = Instant::now();
        let wanted: Vec<_> =
            self.sides.iter_mut().filter_map(|(id, side)| Some((*id, side.wanted.take()?))).collect();
        for (id, (name, overrides)) in wanted {
            self.set_pipeline(id, &name, &overrides, publisher);
        }
        let stands = self.sides.first().map(|(_, side)| side.renderer.shared_scene().clone());
        let renderers = self.sides.iter_mut().map(|(_, side)| &mut side.renderer);
        let results = reload_all(renderers, &saved.files);
        let mut told = Vec::new();
        for (at, result) in results.into_iter().enumerate() {
            let id = self.sides[at].0;
            match result {
                Reload::Nothing => {}
                Reload::Done(load) => {
                    let side = &mut self.sides[at].1;
                    side.loaded(&self.catalog);
                    told.push(format!("{}: {}", id.name(), side.describe(&load)));
                    self.clear(id.name(), publisher);
                    self.clear("scene", publisher);
                }
                Reload::Failed(error) => {
                    self.trouble(id.name(), &error, publisher);
                    told.clear();
                }
            }
        }
        let now = self.sides.first().map(|(_, side)| side.renderer.shared_scene().clone());
        if let (Some(before), Some(now)) = (stands, now)
            && !Arc::ptr_eq(before.scene(), now.scene())
        {
            self.scene = now;
            self.tell_scene(publisher);
        }
        self.watch(publisher);
        if told.is_empty() {
            return;
        }
        self.move_on();
        self.frames(publisher, Some(SideId::A), waits);
        let ended: String = self.sides.first().map_or_else(String::new, |(_, side)| side.ended());
        let since_save = saved.at.and_then(|at| at.elapsed().ok()).filter(|time| *time < RECENT);
        let since_save = since_save.map(|time| time.as_secs_f64() * 1e3);
        let ms = began.elapsed().as_secs_f64() * 1e3;
        let files: Vec<String> = saved
            .files
            .iter()
            .take(3)
            .filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned()))
            .collect();
        let more = saved.files.len().saturating_sub(files.len());
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let whole = since_save.map_or(String::new(), |ms| format!(", {ms:.0} ms since the save"));
        let line = format!(
            "{}{more} read again: {}{ended}. Picture after {ms:.0} ms{whole}.",
            files.join(", "),
            told.join("; ")
        );
        println!("{line}");
        publisher.with(|published| published.reload_ms = since_save.map(|ms| ms as f32));
        report(publisher, self.begun, &line, false);
    }

    pub(super) fn watch(&mut self, publisher: &Publisher) {
        let mut folders: Vec<PathBuf> =
            self.sides.iter().flat_map(|(_, side)| side.renderer.watched_folders()).collect();
        let wanted = self.sides.iter().filter_map(|(_, side)| side.wanted.as_ref());
        let files = wanted.map(|(name, _)| PathBuf::from(name)).filter(|path| path.is_file());
        folders.extend(files.filter_map(|file| file.canonicalize().ok()?.parent().map(PathBuf::from)));
        folders.retain(|folder| folder.is_dir());
        if let Err(error) = self.files.watch(folders) {
            report(publisher, self.begun, &format!("changes of files are not seen: {error}"), true);
        }
    }
}
