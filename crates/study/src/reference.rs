//! References: rendered once, stored in the study's folder, and shared by the cells that are compared with
//! them.

use crate::error::{Failure, StudyError};
use crate::folder::{Folder, REFERENCES, read_json};
use crate::key::{self, Key};
use crate::laboratory::{Laboratory, Observed, RunRequest, Step};
use crate::plan::{Origin, PlannedReference};
use crate::record::ReferenceRecord;
use metrics::Image;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The record of a reference, stored once all its pictures are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Kept {
    from: String,
    /// One picture for all frames, or one per frame; relative to the study's folder.
    images: Vec<String>,
    seconds: f64,
    #[serde(default)]
    work: f64,
    noise: Option<f64>,
    provenance: String,
}

/// A reference in the index of a study, by which a process that did not render it finds it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Listed {
    /// `None` if it is broken.
    key: Option<String>,
    scene: String,
    from: String,
}

/// The references of a study, with the state of each.
#[derive(Debug)]
pub(crate) struct References<'a> {
    planned: &'a [PlannedReference],
    scenes: Vec<String>,
    /// The key of each, or the reason why there is none.
    keys: Vec<Result<Key, Failure>>,
    /// The results of the references that were requested so far.
    known: Vec<Option<Result<Kept, Failure>>>,
    /// A folder in which references of other studies are looked up and stored as well.
    shared: Option<PathBuf>,
}

/// The frame of a reference that is being rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// From 1.
    pub(crate) frame: usize,
    /// Number of frames: 1 unless every frame has a reference of its own.
    pub(crate) frames: usize,
}

/// The reference pictures of a cell.
#[derive(Debug)]
pub(crate) struct Truth {
    files: Vec<PathBuf>,
    read: Option<(usize, Image)>,
}

impl Truth {
    /// Returns the reference of a frame, counted from the first measured one.
    pub(crate) fn frame(&mut self, index: usize) -> Result<&Image, Failure> {
        // For a scene that stands still, one picture is the reference of all frames.
        let file = if self.files.len() > 1 { index } else { 0 };
        if self.read.as_ref().is_none_or(|(read, _)| *read != file) {
            let path = self.files.get(file).ok_or(Failure::NoReference(index))?;
            self.read = Some((file, Image::read(path)?));
        }
        self.read.as_ref().map(|(_, image)| image).ok_or(Failure::NoReference(index))
    }
}

impl<'a> References<'a> {
    pub(crate) fn new(
        planned: &'a [PlannedReference],
        scenes: Vec<String>,
        lab: &mut dyn Laboratory,
        shared: Option<PathBuf>,
    ) -> References<'a> {
        let keys = planned.iter().map(|reference| key::of_reference(&reference.origin, lab)).collect();
        References { planned, scenes, keys, known: vec![None; planned.len()], shared }
    }

    /// Returns the key of a reference, which is part of the keys of its cells.
    pub(crate) fn key(&self, index: usize) -> String {
        match &self.keys[index] {
            Ok(key) => key.to_string(),
            Err(why) => format!("none: {why}"),
        }
    }

    /// Returns the entries for the index of the study.
    pub(crate) fn listed(&self) -> Vec<Listed> {
        let entry = |(index, planned): (usize, &PlannedReference)| Listed {
            key: self.keys[index].as_ref().ok().map(Key::to_string),
            scene: self.scenes[planned.scene].clone(),
            from: planned.from.clone(),
        };
        self.planned.iter().enumerate().map(entry).collect()
    }

    /// Returns an estimate of the time for those that were not requested yet, from the time of the others.
    pub(crate) fn left(&self) -> Duration {
        let rendered = self.known.iter().flatten().flatten();
        let (seconds, count) = rendered.fold((0.0, 0), |sum, kept| (sum.0 + kept.seconds, sum.1 + 1));
        let open = self.known.iter().filter(|known| known.is_none()).count();
        let left = open as f64 * seconds / f64::from(count.max(1));
        Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX)
    }

    /// Looks up the references that are in the folder already, without rendering any.
    pub(crate) fn recall(&mut self, folder: &Folder) {
        for (index, key) in self.keys.iter().enumerate() {
            if let Ok(key) = key
                && let Some(kept) = recall(&folder.path, &key.to_string())
            {
                self.known[index] = Some(Ok(kept));
            }
        }
    }

    /// Returns whether the result of a reference is known: its pictures, or why it failed.
    pub(crate) fn is_known(&self, index: usize) -> bool {
        self.known[index].is_some()
    }

    /// Returns the pictures of a reference, which is rendered if it is missing, or the reason why there are
    /// none. An error of the folder ends the study. While it is rendered, `step` is called with the progress of each frame.
    pub(crate) fn get(
        &mut self,
        index: usize,
        folder: &Folder,
        lab: &mut dyn Laboratory,
        step: &mut dyn FnMut(Part, Step),
    ) -> Result<Result<Truth, Failure>, StudyError> {
        if self.known[index].is_none() {
            let known = match &self.keys[index] {
                Ok(key) => self.render(index, &key.clone(), folder, lab, step)?,
                Err(why) => Err(why.clone()),
            };
            self.known[index] = Some(known);
        }
        Ok(match &self.known[index] {
            Some(Ok(kept)) => {
                let files = kept.images.iter().map(|image| folder.path.join(image)).collect();
                Ok(Truth { files, read: None })
            }
            Some(Err(why)) => Err(why.clone()),
            None => Err(Failure::NoPicture),
        })
    }

    fn render(
        &self,
        index: usize,
        key: &Key,
        folder: &Folder,
        lab: &mut dyn Laboratory,
        step: &mut dyn FnMut(Part, Step),
    ) -> Result<Result<Kept, Failure>, StudyError> {
        if let Some(shared) = &self.shared
            && let Some(kept) = recall(shared, &key.to_string())
        {
            copy(&kept, key, shared, &folder.path)?;
            return Ok(Ok(kept));
        }
        let start = Instant::now();
        let planned = &self.planned[index];
        let mut kept = Kept {
            from: planned.from.clone(),
            images: Vec::new(),
            seconds: 0.0,
            work: planned.origin.work(),
            noise: None,
            provenance: String::new(),
        };
        match &planned.origin {
            Origin::Picture(file) => {
                let image = match Image::read(file) {
                    Ok(image) => image,
                    Err(why) => return Ok(Err(why.into())),
                };
                if let Err(why) = sound(&image, planned.size) {
                    return Ok(Err(why.at(file)));
                }
                kept.provenance = metrics::read_provenance(file).ok().flatten().unwrap_or_default();
                let name = format!("{REFERENCES}/{key}.exr");
                folder.write_image(
                    &name,
                    &image,
                    Some(&kept.provenance).filter(|text| !text.is_empty()).map(String::as_str),
                )?;
                kept.images.push(name);
            }
            Origin::Run(requests) => {
                for (number, request) in (1..).zip(requests) {
                    let part = Part { frame: number, frames: requests.len() };
                    let step = &mut |progress| step(part, progress);
                    if let Err(why) = run(request, key, &mut kept, folder, lab, step)? {
                        return Ok(Err(why));
                    }
                }
                kept.seconds = start.elapsed().as_secs_f64();
            }
        }
        folder.write_json(&format!("{REFERENCES}/{key}.json"), &kept)?;
        if let Some(shared) = &self.shared {
            copy(&kept, key, &folder.path, shared)?;
        }
        Ok(Ok(kept))
    }

    /// Returns what is known of each reference, for the record.
    pub(crate) fn records(&self) -> Vec<ReferenceRecord> {
        let pairs = self.planned.iter().zip(&self.known);
        let record = |(planned, known): (&PlannedReference, &Option<Result<Kept, Failure>>)| {
            let scene = &self.scenes[planned.scene];
            Some(match known.as_ref()? {
                Ok(kept) => kept.record(scene, &planned.from),
                Err(why) => ReferenceRecord {
                    scene: scene.clone(),
                    from: planned.from.clone(),
                    image: None,
                    seconds: 0.0,
                    work: 0.0,
                    noise: None,
                    error: why.to_string(),
                    provenance: String::new(),
                },
            })
        };
        pairs.filter_map(record).collect()
    }

    /// Returns the reference picture of the last frame of its cells.
    pub(crate) fn image(&self, index: usize) -> Option<String> {
        self.known[index].as_ref()?.as_ref().ok()?.images.last().cloned()
    }

    /// Returns a description of the reference, for messages.
    pub(crate) fn name(&self, index: usize) -> String {
        let planned = &self.planned[index];
        format!("{} at {}x{}", self.scenes[planned.scene], planned.size.0, planned.size.1)
    }
}

/// Runs one request of a reference and stores its pictures.
fn run(
    request: &RunRequest,
    key: &Key,
    kept: &mut Kept,
    folder: &Folder,
    lab: &mut dyn Laboratory,
    step: &mut dyn FnMut(Step),
) -> Result<Result<(), Failure>, StudyError> {
    // An error of the folder is stored separately: it ends the study, not only the reference.
    let mut disk = None;
    let images = &mut kept.images;
    let mut keep = |frame: Observed| {
        sound(&frame.image, request.size).map_err(|why| why.at(format!("frame {}", frame.frame)))?;
        let name = format!("{REFERENCES}/{key}-{:04}.exr", frame.frame);
        match folder.write_image(&name, &frame.image, None) {
            Ok(()) => images.push(name),
            Err(error) => {
                let message = Failure::render(error.to_string());
                disk = Some(error);
                return Err(message);
            }
        }
        Ok(())
    };
    let done = lab.run(request, &mut keep, step);
    if let Some(error) = disk {
        return Err(error);
    }
    Ok(match done {
        Ok(_) if kept.images.is_empty() => Err(Failure::NoPicture),
        Ok(run) => {
            kept.noise = run.noise;
            kept.provenance = run.provenance;
            Ok(())
        }
        Err(why) => Err(why),
    })
}

/// Checks that a picture can be a reference: its size, and that its pixels are finite.
fn sound(image: &Image, size: (u32, u32)) -> Result<(), Failure> {
    let found = (image.width(), image.height());
    if found != (size.0 as usize, size.1 as usize) {
        return Err(Failure::Size { found, expected: size });
    }
    Failure::check_finite(image, || "the reference".to_owned())
}

/// Adds the references that are in the folder of a study to the records of those that its last run knew, in the order of the
/// study.
pub(crate) fn complete(records: &mut Vec<ReferenceRecord>, listed: &[Listed], folder: &Path) {
    let mut known = std::mem::take(records);
    for one in listed {
        let is_same = |record: &ReferenceRecord| record.scene == one.scene && record.from == one.from;
        let before = known.iter().position(is_same).map(|place| known.remove(place));
        let rendered = before.as_ref().is_some_and(|before| before.image.is_some());
        let kept = one.key.as_ref().filter(|_| !rendered).and_then(|key| recall(folder, key));
        records.extend(kept.map(|kept| kept.record(&one.scene, &one.from)).or(before));
    }
    // Studies of earlier versions have no list.
    records.extend(known);
}

impl Kept {
    fn record(&self, scene: &str, from: &str) -> ReferenceRecord {
        ReferenceRecord {
            scene: scene.to_owned(),
            from: from.to_owned(),
            image: self.images.last().cloned(),
            seconds: self.seconds,
            work: self.work,
            noise: self.noise,
            error: String::new(),
            provenance: self.provenance.clone(),
        }
    }
}

fn recall(folder: &Path, key: &str) -> Option<Kept> {
    let kept: Kept = read_json(&folder.join(REFERENCES).join(format!("{key}.json"))).ok()?;
    kept.images.iter().all(|image| folder.join(image).is_file()).then_some(kept)
}

/// Copies a reference from one folder to another; its record last, so that it is complete or absent.
fn copy(kept: &Kept, key: &Key, from: &Path, to: &Path) -> Result<(), StudyError> {
    let record = format!("{REFERENCES}/{key}.json");
    for name in kept.images.iter().chain([&record]) {
        crate::folder::copy(&from.join(name), &to.join(name))?;
    }
    Ok(())
}
