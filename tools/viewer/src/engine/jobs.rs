//! Jobs that write files or send pictures elsewhere, on the engine's thread.

use super::model::SideId;
use super::side::Side;
use anyhow::{Context as _, Result, bail};
use metrics::tev::{self, Tev};
use metrics::{Display, FileFormat, Image};
use renderer::Provenance;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use whole_file::Unfinished;

/// Something to write or to send.
#[derive(Clone, Debug)]
pub(crate) enum Job {
    /// A resource or output into a picture file: .png, .exr or .pfm.
    Picture {
        /// The side whose pictures are taken.
        side: SideId,
        /// An output of the pipeline, or any resource.
        output: String,
        /// Layer of an array.
        layer: u32,
        /// The file.
        path: PathBuf,
        /// The size of the frame; `None` as it is shown.
        size: Option<(u32, u32)>,
    },
    /// A resource or output to a tev that runs.
    Tev {
        /// The side whose pictures are taken.
        side: SideId,
        /// An output of the pipeline, or any resource.
        output: String,
        /// Layer of an array.
        layer: u32,
    },
    /// One frame, captured by the graphics debugger that the program was started in.
    Capture(SideId),
    /// Frames of the animation from its start, one file each (a name with `####`), or a video (.mp4, .webm, .mkv) by ffmpeg.
    Sequence {
        /// The side whose pictures are taken.
        side: SideId,
        /// The pattern of names, or the video.
        path: PathBuf,
        /// The number of frames.
        frames: u32,
        /// The size of the frames; `None` as they are shown.
        size: Option<(u32, u32)>,
    },
}

impl Job {
    /// Returns whose pictures it takes.
    pub(super) fn side(&self) -> SideId {
        match self {
            Job::Picture { side, .. } | Job::Sequence { side, .. } | Job::Tev { side, .. } => *side,
            Job::Capture(side) => *side,
        }
    }

    /// Describes it in a line.
    pub(super) fn describe(&self) -> String {
        match self {
            Job::Picture { path, .. } | Job::Sequence { path, .. } => format!("Writing {}", path.display()),
            Job::Tev { output, .. } => format!("Sending {output} to tev"),
            Job::Capture(_) => "Capturing a frame".to_owned(),
        }
    }
}

/// Does a job, and returns a line for the user. `stage` is called with its progress.
pub(super) fn run(
    job: &Job,
    side: &mut Side,
    quits: &AtomicBool,
    mut stage: impl FnMut(String),
) -> Result<String> {
    match job {
        Job::Picture { output, layer, path, size, .. } => {
            if let Some(size) = *size {
                resize(side, size, Some(output), quits, |step| {
                    stage(format!("Writing {}: {step}", path.display()));
                })?;
            }
            let picture = side.renderer.picture(output, *layer)?;
            write(side, &picture, (output, *layer), path)?;
            Ok(format!("wrote {} ({}×{})", shown(path), picture.width(), picture.height()))
        }
        Job::Tev { output, layer, .. } => {
            let picture = side.renderer.picture(output, *layer)?;
            let name = format!("{} {output}", side.renderer.pipeline_name());
            Tev::connect(tev::ADDRESS)?.send_image(&name, &picture)?;
            Ok(format!("sent {name} to tev"))
        }
        Job::Capture(_) => {
            side.renderer.gpu().clone().capture(|| {
                side.renderer.run_everything();
                side.frame()
            })?;
            Ok("a frame was run for the graphics debugger; without one nothing was captured".to_owned())
        }
        Job::Sequence { path, frames, size, .. } => {
            if let Some(size) = *size {
                side.renderer.set_size(size)?;
            }
            let progress = |frame: u32| format!("Writing {}: frame {frame} of {frames}", path.display());
            if is_video(path) {
                video(side, path, *frames, quits, |frame| stage(progress(frame)))
            } else {
                sequence(side, path, *frames, quits, |frame| stage(progress(frame)))
            }
        }
    }
}

/// Renders in another size until the picture has all of its samples. `kept` is what is read then.
fn resize(
    side: &mut Side,
    size: (u32, u32),
    kept: Option<&str>,
    quits: &AtomicBool,
    mut step: impl FnMut(String),
) -> Result<()> {
    side.renderer.set_size(size)?;
    side.renderer.keep_only(kept)?;
    loop {
        if quits.load(Ordering::Acquire) {
            bail!("the window was closed before the picture was written");
        }
        side.frame()?;
        if !side.converges() {
            return Ok(());
        }
        step(side.step());
    }
}

fn is_video(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["mp4", "webm", "mkv"].iter().any(|video| ending == *video))
}

fn shown(path: &Path) -> String {
    path.canonicalize().unwrap_or_else(|_| path.to_owned()).display().to_string()
}

fn write(side: &Side, picture: &Image, shown: (&str, u32), path: &Path) -> Result<()> {
    if FileFormat::of(path).is_none() {
        bail!("{}: expected a name that ends in .png, .exr or .pfm", path.display());
    }
    folder_of(path)?;
    let display = Display::of_output(shown.0, Display::default());
    picture.write(path, display, Some(&record(side, shown).written_to(path, display).to_json()))?;
    Ok(())
}

/// Returns the record of a picture. Earlier frames count where history buffers hold their results.
fn record(side: &Side, shown: (&str, u32)) -> Provenance {
    let mut record = Provenance::new(&side.renderer, &side.renderer.scene().spec, shown, 0);
    let remembers = side.renderer.plan().is_some_and(|plan| !plan.histories.is_empty());
    if !remembers || side.has_progress() {
        record.first_frame = record.frame;
    }
    record
}

fn folder_of(path: &Path) -> Result<()> {
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => std::fs::create_dir_all(folder)
            .with_context(|| format!("the folder {} cannot be made", folder.display())),
        None => Ok(()),
    }
}

/// Runs the animation from its start and hands each frame's picture on. Histories go on, as in a window that plays.
fn play(
    side: &mut Side,
    frames: u32,
    quits: &AtomicBool,
    mut begins: impl FnMut(u32),
    mut take: impl FnMut(&Side, u32) -> Result<()>,
) -> Result<()> {
    let rate = side.renderer.scene().frames_per_second;
    for frame in 0..frames {
        if quits.load(Ordering::Acquire) {
            bail!("the window was closed after {frame} of {frames} frames");
        }
        begins(frame + 1);
        side.renderer.set_time(Some(frame as f32 / rate));
        loop {
            side.frame()?;
            if !side.converges() {
                break;
            }
        }
        take(side, frame)?;
    }
    Ok(())
}

fn sequence(
    side: &mut Side,
    pattern: &Path,
    frames: u32,
    quits: &AtomicBool,
    begins: impl FnMut(u32),
) -> Result<String> {
    let text = pattern.to_string_lossy().into_owned();
    let Some(first) = text.find('#') else {
        bail!(
            "{text}: expected a name with #### for the number of the frame, or one that ends in .mp4, .webm or .mkv"
        );
    };
    let width = text[first..].chars().take_while(|c| *c == '#').count();
    let path =
        |frame: u32| PathBuf::from(format!("{}{frame:0width$}{}", &text[..first], &text[first + width..]));
    let output = match FileFormat::of(pattern) {
        Some(format) if format.is_display_referred() && side.renderer.find_output("display").is_ok() => {
            "display"
        }
        _ => "image",
    };
    play(side, frames, quits, begins, |side, frame| {
        write(side, &side.renderer.output(output)?, (output, 0), &path(frame))
    })?;
    Ok(format!("wrote {frames} pictures, the last {}", shown(&path(frames.saturating_sub(1)))))
}

/// Encodes by ffmpeg, which reads raw pixels.
fn video(
    side: &mut Side,
    path: &Path,
    frames: u32,
    quits: &AtomicBool,
    begins: impl FnMut(u32),
) -> Result<String> {
    folder_of(path)?;
    let (width, height) = side.renderer.size();
    let rate = side.renderer.scene().frames_per_second;
    let unwritten = || format!("the video {} was not written", path.display());
    let part = Unfinished::of(path).with_context(unwritten)?;
    let beside = part.beside().with_context(|| format!("{} is no file", path.display()))?;
    // The name that it is written under does not say.
    let container = match path.extension().and_then(|ending| ending.to_str()) {
        Some("mkv") => "matroska",
        Some(ending) => ending,
        None => bail!("{}: expected a name that ends in .mp4, .webm or .mkv", path.display()),
    };
    let record = record(side, ("display", 0)).to_json();
    let mut ffmpeg = Process::new("ffmpeg")
        .args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-s", &format!("{width}x{height}"), "-r", &rate.to_string(), "-i", "-"])
        // Encoders of 4:2:0 want even sides.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .args(["-metadata", &format!("comment={record}")])
        .args(["-f", container])
        .arg(beside)
        .stdin(Stdio::piped())
        .spawn()
        .context(
            "videos are encoded by ffmpeg, which cannot be run; a name with #### writes pictures instead",
        )?;
    let mut pipe = ffmpeg.stdin.take().context("ffmpeg takes no pictures")?;
    let played = play(side, frames, quits, begins, |side, _| {
        let picture = side.picture().context("there is no picture")?;
        let bytes: Vec<u8> = picture.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
        pipe.write_all(&bytes).context("ffmpeg takes no more pictures")
    });
    drop(pipe);
    let status = ffmpeg.wait()?;
    played?;
    if !status.success() {
        bail!("ffmpeg failed: {status}");
    }
    part.finish().with_context(unwritten)?;
    Ok(format!("wrote {}", shown(path)))
}
