//! Files that were saved: what they are part of is loaded again.

use super::{RECENT, Session, report};
use crate::engine::Publisher;
use crate::engine::model::SideId;
use crate::engine::watch::Saved;
use crate::terminal;
use renderer::{Reload, reload_all};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

impl Session {
    /// Loads again what was saved.
    pub(super) fn reload(&mut self, saved: &Saved, waits: &AtomicBool, publisher: &Publisher) {
        let began = Instant::now();
        let mut read = self.files_read(saved);
        if let Some(spec) = self.wanted_scene.clone() {
            self.set_scene(&spec, publisher);
        }
        self.try_wanted(publisher);
        let stands = self.sides.first().map(|(_, side)| side.renderer.shared_scene().clone());
        let renderers = self.sides.iter_mut().map(|(_, side)| &mut side.renderer);
        let results = reload_all(renderers, &saved.files);
        let mut lines = Vec::new();
        for (at, result) in results.into_iter().enumerate() {
            let id = self.sides[at].0;
            match result {
                Reload::Nothing => {}
                Reload::Done(load) => {
                    let side = &mut self.sides[at].1;
                    side.loaded(&self.catalog);
                    lines.push(format!("{}: {}", id.name(), side.describe(&load)));
                    self.clear(id.name(), publisher);
                    self.clear("scene", publisher);
                }
                Reload::Failed(error) => {
                    self.trouble(id.name(), &error, publisher);
                    lines.clear();
                }
            }
        }
        let now = self.sides.first().map(|(_, side)| side.renderer.shared_scene().clone());
        if let (Some(before), Some(now)) = (stands, now)
            && !Arc::ptr_eq(before.scene(), now.scene())
        {
            self.scene = now;
            self.publish_scene(publisher);
        }
        self.watch(publisher);
        if lines.is_empty() {
            return;
        }
        self.move_on();
        self.frames(publisher, Some(SideId::A), waits);
        let ended: String = self.sides.first().map_or_else(String::new, |(_, side)| side.ended());
        let since_save = saved.at.and_then(|at| at.elapsed().ok()).filter(|time| *time < RECENT);
        let since_save = since_save.map(|time| time.as_secs_f64() * 1e3);
        let ms = began.elapsed().as_secs_f64() * 1e3;
        read.extend(self.files_read(saved));
        // What is only beside them may have been missed before.
        let read = if read.is_empty() { saved.files.clone() } else { read };
        let files: Vec<String> = read
            .iter()
            .take(3)
            .filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned()))
            .collect();
        let more = read.len().saturating_sub(files.len());
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let gone: Vec<String> = saved.files.iter().filter_map(|file| self.replaced(file)).collect();
        let gone = if gone.is_empty() {
            String::new()
        } else {
            format!("; {} gone, what is built into the program is used", gone.join(", "))
        };
        let whole = since_save.map_or(String::new(), |ms| format!(", {ms:.0} ms since the save"));
        let line = format!(
            "{}{more} read again: {}{ended}{gone}. Picture after {ms:.0} ms{whole}.",
            files.join(", "),
            lines.join("; ")
        );
        terminal::say(&line);
        publisher.with(|published| published.reload_ms = since_save.map(|ms| ms as f32));
        report(publisher, &line, false);
    }

    /// Returns the saved files that pipelines or the scene are made from: others may lie in their folders, as those that the
    /// window writes itself.
    fn files_read(&self, saved: &Saved) -> BTreeSet<PathBuf> {
        self.sides.iter().flat_map(|(_, side)| side.renderer.reads(&saved.files)).collect()
    }

    /// Returns the path in the tree of a file that is gone, where one is built into the program that takes its place.
    fn replaced(&self, file: &Path) -> Option<String> {
        let assets = self.catalog.assets();
        let path = file.strip_prefix(assets.root()?.canonicalize().ok()?).ok()?.to_str()?.replace('\\', "/");
        (!file.exists() && assets.text(&path).is_some()).then_some(path)
    }

    pub(super) fn watch(&mut self, publisher: &Publisher) {
        let mut folders: Vec<PathBuf> =
            self.sides.iter().flat_map(|(_, side)| side.renderer.watched_folders()).collect();
        // What is missing may come, and what is wrong may be mended: in the folder of the file that was asked for.
        let wanted = self.sides.iter().filter_map(|(_, side)| Some(&side.wanted.as_ref()?.0));
        let files = wanted.chain(&self.wanted_scene).filter(|name| Path::new(name).extension().is_some());
        let folder = |file: &String| match Path::new(file).parent() {
            Some(folder) if folder.as_os_str().is_empty() => Path::new(".").canonicalize().ok(),
            folder => folder?.canonicalize().ok(),
        };
        folders.extend(files.filter_map(folder));
        let scenes = self.catalog.assets().root().map(|root| root.join("scenes"));
        folders.extend(scenes.filter(|_| self.wanted_scene.is_some()));
        folders.retain(|folder| folder.is_dir());
        if let Err(error) = self.files.watch(folders) {
            report(publisher, &format!("changes of files are not seen: {error}"), true);
        }
    }
}
