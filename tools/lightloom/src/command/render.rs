//! `lightloom render`: headless pictures and sequences, also again at every save.

mod faults;
mod log;
mod report;
mod watch;

use crate::context::{Context, Sort, Values, parse_size};
use crate::output::{progress, set_parts, stderr, warn};
use anyhow::{Context as _, Result, bail};
use faults::explain_black;
use frame_graph::{CompileOptions, LinkContext, Overrides, Value};
use metrics::{Display, FileFormat, Tonemap};
use renderer::{Catalog, Compiled, FrameOptions, Gpu, Progress, Provenance, Renderer, compile_options};
use report::{Rendered, report};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Render a scene by a pipeline.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom render ism-invtm cornell-box -o box.png
  lightloom render ism-invtm sponza.glb -o sponza.exr --size 1280x720 --set lights=2048 --time
  lightloom render ism atrium -o walk/####.png --frames 60
  lightloom render ism-invtm cornell-box -o lights.exr --output importance
  lightloom render docs/examples/vignette.ron cornell-box -o v.png --output display --watch")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    /// A scene by name, or a .ron, .glb, .gltf, .pbrt or .xml file
    scene: String,
    /// The picture: .exr or .pfm (linear), .png (tone-mapped). In a sequence, #### is the frame's number
    #[arg(short, long = "out", value_name = "FILE", value_parser = parse_picture)]
    out: PathBuf,
    /// Size of the frame in pixels
    #[arg(long, default_value = "512x512", allow_hyphen_values = true, value_parser = parse_size)]
    size: (u32, u32),
    /// Number of frames; a pipeline with an output `progress` repeats each until it has converged
    #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Number of the first frame, and so the time of animations. History buffers begin empty there: with them, pictures can
    /// differ from those of a run that began before
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    first_frame: u32,
    /// Seed of all random numbers; 0 gives plain sequences, as the papers use them
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    seed: u32,
    /// Output of the pipeline, or any resource as pass, pass.port or pass.member. Of several, each goes into a file of its
    /// own: the name of the output is added to that of the picture
    #[arg(long, default_value = "image")]
    output: Vec<String>,
    /// Layer of a resource that is an array
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    layer: u32,
    #[command(flatten)]
    values: Values,
    /// Print the GPU time of each pass: the median of the frames after the first. Every pass runs in every frame. Also
    /// print where the time went from the start of the process to the first picture
    #[arg(long)]
    pub(crate) time: bool,
    /// Write to FILE a line of JSON for each frame: its number and seconds, the memory of the program, the objects on the
    /// device, and of each output a hash and the mean luminance
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// The curve from light to a screen, of PNG files and of the output `display`: reinhard, reinhard:WHITE,
    /// reinhard-simple, aces, filmic, filmic:WHITE, none [default: as the pipeline says]
    #[arg(long)]
    tonemap: Option<Tonemap>,
    /// Exposure of PNG files and of the output `display` in EV, -40 to 40 [default: as the pipeline says]
    #[arg(long, allow_negative_numbers = true, value_parser = parse_exposure)]
    exposure: Option<f32>,
    /// Give every resource an object of its own
    #[arg(long)]
    no_sharing: bool,
    /// Fill what passes write with NaN first: pictures must not change
    #[arg(long)]
    poison: bool,
    /// Run the threads of compute shaders in another order, which the seed chooses: pictures must not change
    #[arg(long, value_name = "SEED")]
    thread_order: Option<u32>,
    /// Render again whenever a file of the pipeline, its shaders or the scene is saved. An error is printed, and the
    /// last good picture stays. Ctrl-C ends it
    #[arg(long)]
    watch: bool,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    if args.first_frame.checked_add(args.frames).is_none() {
        bail!(
            "--first-frame {} with --frames {}: frames have numbers up to {}",
            args.first_frame,
            args.frames,
            u32::MAX - 1
        );
    }
    context.expect(Sort::Pipeline, &args.pipeline)?;
    context.expect(Sort::Scene, &args.scene)?;
    let out = Sequence::new(&args.out, args.frames)?;
    let catalog = match args.thread_order {
        Some(seed) => Arc::new(Catalog::with_thread_order(context.catalog.assets().clone(), seed)),
        None => Arc::clone(&context.catalog),
    };
    let overrides = args.values.overrides();
    // The driver starts on another thread, while this one loads the scene and the shaders.
    let (gpu, scene) = std::thread::scope(|scope| {
        let gpu = scope.spawn(Gpu::open);
        let scene = renderer::load_scene(&catalog, &args.scene);
        if let Ok(scene) = &scene {
            let link_context = LinkContext { frame: args.size, traits: scene.traits() };
            // The catalog keeps the shaders; errors are reported when the pipeline is set.
            let _ = Compiled::new(&catalog, &args.pipeline, &overrides, &link_context, &compile_options());
        }
        (gpu.join(), scene)
    });
    let (gpu, scene) = (gpu.unwrap_or_else(|panic| std::panic::resume_unwind(panic)), scene?);
    for repair in &scene.repairs {
        stderr!("note: {repair}");
    }
    let mut renderer = Renderer::new(gpu?, catalog, scene, args.size)?;
    renderer.set_seed(args.seed);
    renderer.set_compile_options(CompileOptions { sharing: !args.no_sharing, ..compile_options() })?;
    renderer.set_pipeline(&args.pipeline, &overrides)?;
    let display = set_display(args, &mut renderer, overrides)?;
    for output in &args.output {
        renderer.keep(output)?;
    }
    warn(&renderer.warnings(), context.json);
    renderer.set_frame_options(FrameOptions {
        timed: args.time,
        poison: args.poison.then_some(FrameOptions::NAN),
        ..FrameOptions::default()
    });
    render(context, args, &mut renderer, &out, display)?;
    if args.watch {
        watch::watch(&mut renderer, |renderer| {
            let display = shown(args, renderer);
            render(context, args, renderer, &out, display)
        })
    } else {
        Ok(())
    }
}

/// Returns the curve from light to a screen: that of the pipeline, unless another is requested.
fn shown(args: &Args, renderer: &Renderer) -> Display {
    let own = renderer.display().map_or_else(Display::default, |(_, display)| display);
    Display { tonemap: args.tonemap.unwrap_or(own.tonemap), exposure: args.exposure.unwrap_or(own.exposure) }
}

/// Gives the pipeline the curve and exposure that are requested, so that its output `display` has them as well as files
/// that are made of light; returns them.
fn set_display(args: &Args, renderer: &mut Renderer, mut overrides: Overrides) -> Result<Display> {
    let display = shown(args, renderer);
    let is_linear = FileFormat::of(&args.out) != Some(FileFormat::Png);
    let shows = args.output.iter().any(|output| output == "display");
    if is_linear && shows {
        stderr!(
            "note: {} holds `display` as a screen takes it: tone-mapped and encoded, not light",
            args.out.display()
        );
    }
    if args.tonemap.is_none() && args.exposure.is_none() {
        return Ok(display);
    }
    if let Some((pass, _)) = renderer.display() {
        let (curve, white) = display.tonemap.to_settings();
        let mut set = |setting: &str, value| overrides.0.push((format!("{pass}.{setting}"), value));
        set("tonemap", Value::Text(curve.into()));
        set("exposure", Value::F32(display.exposure));
        if let Some(white) = white {
            set("white", Value::F32(white));
        }
        renderer.set_values(overrides)?;
    }
    if is_linear && !shows {
        stderr!(
            "note: {} holds light as it is: --tonemap and --exposure change PNG files and the output `display`",
            args.out.display()
        );
    }
    Ok(display)
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(exposure) if (-40.0..=40.0).contains(&exposure) => Ok(exposure),
        _ => Err(format!("`{text}` is no exposure: expected a number of EV from -40 to 40")),
    }
}

fn parse_picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match FileFormat::of(&path) {
        Some(FileFormat::Exr | FileFormat::Png | FileFormat::Pfm) => Ok(path),
        _ => Err("expected a name that ends in .exr, .png or .pfm".to_owned()),
    }
}

/// Renders the requested frames, writes their pictures, and reports the result.
fn render(
    context: &Context,
    args: &Args,
    renderer: &mut Renderer,
    out: &Sequence,
    display: Display,
) -> Result<()> {
    let frames = args.frames;
    renderer.set_frame_index(args.first_frame);
    // A picture that takes many frames to be done is a long task, too.
    let progressive = frames == 1 && renderer.plan().is_some_and(|plan| plan.output("progress").is_some());
    // Its number of steps is known after the first of them.
    let bar = progress(if progressive { 1 } else { u64::from(frames) }, "rendering");
    let start = Instant::now();
    let mut log = args.log.as_deref().map(log::FrameLog::new).transpose()?;
    let mut done = Rendered::default();
    for frame in 0..frames {
        if args.time {
            renderer.run_everything();
        }
        let running = tracing::info_span!(target: "phase", "frames").entered();
        let begun = Instant::now();
        renderer.frame_until_done(|report, progress| {
            if !report.partial {
                done.times.push(report.times.clone());
            }
            match progress {
                Some(progress) if progressive => {
                    set_parts(&bar, u64::from(progress.steps));
                    bar.set_position(u64::from(progress.step));
                }
                Some(Progress { step, steps, .. }) => {
                    bar.set_message(format!("rendering, step {step} of {steps} of a frame"));
                }
                None => {}
            }
            ControlFlow::Continue(())
        })?;
        drop(running);
        if let Some(log) = &mut log {
            renderer.gpu().wait()?;
            let seconds = begun.elapsed().as_secs_f64();
            log.add(renderer, args.first_frame + frame, seconds, &args.output)?;
        }
        if out.wants(frame, frames) {
            for output in &args.output {
                let reading = tracing::info_span!(target: "phase", "read back").entered();
                let picture = renderer.picture(output, args.layer)?;
                drop(reading);
                let writing = tracing::info_span!(target: "phase", "encoded and written").entered();
                let path = out.path(args.first_frame + frame, (args.output.len() > 1).then_some(output));
                done.broken.look(&picture, output, args.first_frame + frame);
                // What a screen takes has no infinities: they are in the light that it shows.
                if output == "display" && renderer.plan().is_some_and(|plan| plan.output("image").is_some()) {
                    done.broken.look(&renderer.picture("image", 0)?, "image", args.first_frame + frame);
                }
                if frame + 1 == frames {
                    bar.suspend(|| explain_black(renderer, &picture, output));
                }
                let display = Display::of_output(output, display);
                let record = Provenance::new(renderer, &args.scene, (output, args.layer), args.first_frame);
                let record = record.written_to(&path, display).to_json();
                picture
                    .write(&path, display, Some(&record))
                    .with_context(|| format!("the picture {} was not written", path.display()))?;
                drop(writing);
                done.written.push(path);
                done.first_picture = done.first_picture.or_else(|| context.phases.first_picture());
            }
        }
        if !progressive {
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    done.seconds = start.elapsed().as_secs_f64();
    report(context, args, renderer, &done)?;
    done.broken.result()
}

/// The files of pictures.
struct Sequence {
    pattern: PathBuf,
    numbered: bool,
}

impl Sequence {
    fn new(pattern: &Path, frames: u32) -> Result<Sequence> {
        if let Some(folder) = pattern.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
        }
        let numbered = pattern.to_string_lossy().contains('#');
        if numbered && frames == 1 {
            stderr!(
                "note: {} is numbered, and one frame is rendered; --frames N makes a sequence",
                pattern.display()
            );
        }
        if !numbered && frames > 1 {
            stderr!(
                "note: {} holds the last of {frames} frames; #### in the name keeps all",
                pattern.display()
            );
        }
        Ok(Sequence { pattern: pattern.to_owned(), numbered })
    }

    /// Returns whether a frame has a file: without a number in the name, only the last one has.
    fn wants(&self, frame: u32, frames: u32) -> bool {
        self.numbered || frame + 1 == frames
    }

    /// Returns the file of a frame; for one of several outputs, with its name before the ending.
    fn path(&self, number: u32, output: Option<&str>) -> PathBuf {
        let text = self.pattern.to_string_lossy();
        let path = match text.find('#') {
            None => self.pattern.clone(),
            Some(first) => {
                let width = text[first..].chars().take_while(|c| *c == '#').count();
                PathBuf::from(format!("{}{number:0width$}{}", &text[..first], &text[first + width..]))
            }
        };
        let Some(output) = output else { return path };
        let [stem, ending] =
            [path.file_stem(), path.extension()].map(|part| part.unwrap_or_default().to_string_lossy());
        path.with_file_name(format!("{stem}-{}.{ending}", output.replace('/', "-")))
    }
}
