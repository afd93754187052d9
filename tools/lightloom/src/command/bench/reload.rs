//! The time from the save of a shader to the next frame.

use super::Bench;
use super::table::{Goal, Row, Section, Spread};
use anyhow::{Context as _, Result, bail};
use frame_graph::{Overrides, Value};
use renderer::{Assets, Catalog, Reload, Renderer};
use shader_library::Watcher;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// The shader that is saved: the last one of the frame, so that little else runs again.
const SHADER: &str = "passes/composite/composite.wgsl";

/// The text in it that is changed so that the driver has to compile it.
const CONSTANT: &str = "select(0.0, 1.0,";

/// Saves that are not counted: the first reload finds a cold driver.
const WARM_UP: u32 = 1;

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    let text = bench.catalog().assets().text(SHADER).with_context(|| format!("there is no {SHADER}"))?;
    let root = tempfile::tempdir()?;
    let path = root.path().join(SHADER);
    std::fs::create_dir_all(path.parent().unwrap_or(root.path()))?;
    save(&path, &text)?;
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root.path().to_owned()))));
    let scene = renderer::load_scene(&catalog, "cornell-box")?;
    let side = bench.size(256, 32);
    let mut renderer = Renderer::new(bench.gpu()?, catalog, scene, (side, side))?;
    let lights = Overrides(vec![("lights".to_owned(), Value::U32(64))]);
    renderer.set_pipeline("ism-invtm", &lights)?;
    renderer.frame()?;
    renderer.gpu().wait()?;
    let mut watcher = Watcher::new(&[root.path().to_owned()])?;
    if !text.contains(CONSTANT) {
        bail!("{SHADER} has no `{CONSTANT}` to change");
    }
    let (mut warm, mut cold) = (Vec::new(), Vec::new());
    let begun = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?.subsec_nanos();
    for number in 0..bench.args.runs + WARM_UP {
        let mut reload = |text: &str| -> Result<f64> {
            let start = Instant::now();
            save(&path, text)?;
            take_in(&mut renderer, &mut watcher)?;
            renderer.frame()?;
            renderer.gpu().wait()?;
            Ok(start.elapsed().as_secs_f64() * 1e3)
        };
        // Another text, of which the driver is given the same as before.
        warm.push(reload(&format!("{text}\n// Saved {number} times before.\n"))?);
        // Another constant, which no run before has had: the driver compiles it.
        let share = f64::from(begun.wrapping_add(number) % (1 << 22)) / f64::from(1 << 22);
        let other = format!("select(0.0, {:.9},", 0.5 + 0.5 * share);
        cold.push(reload(&text.replace(CONSTANT, &other))?);
    }
    let [warm, cold] = [warm, cold].map(|mut times| Spread::of(times.split_off(WARM_UP as usize)));
    let rows = vec![
        Row::new("save of a shader to the next frame", warm, "ms").goal(Goal::AtMost(100.0), "own"),
        Row::new("the same, where the driver compiles another shader", cold, "ms"),
    ];
    let note = format!(
        "{SHADER} in `ism-invtm` at {side}²: 30 ms in which the watcher waits for quiet, composing, checking, linking, a new \
         GPU pipeline, and the frame. In the first row the driver is given what it has compiled before, and finds it in its \
         cache; in the second a constant that it has never seen."
    );
    Ok(Section { rows, note })
}

/// Saves as editors do: a new file beside the old, renamed over it.
fn save(path: &Path, text: &str) -> Result<()> {
    let beside = path.with_extension("new");
    std::fs::write(&beside, text)?;
    Ok(std::fs::rename(beside, path)?)
}

/// Waits for the watcher, as a loop of frames does, until the renderer has the new shader.
fn take_in(renderer: &mut Renderer, watcher: &mut Watcher) -> Result<()> {
    let patience = Instant::now() + Duration::from_secs(20);
    while Instant::now() < patience {
        match renderer.reload(&watcher.changed()) {
            Reload::Nothing => std::thread::sleep(Duration::from_millis(1)),
            Reload::Done(report) if report.pipelines > 0 => return Ok(()),
            Reload::Done(_) => bail!("{SHADER} was saved, and no GPU pipeline was made again"),
            Reload::Failed(error) => return Err(error.into()),
        }
    }
    bail!("{SHADER} was saved, and the system reported no change in 20 s")
}
