//! What a reader does with the page, by real mouse and keyboard events.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::browser::Browser;
use super::sample::{self, LIGHTS, PIPELINES, SCENES, SEEDS};

/// Combinations of values of a pipeline.
const COMBINATIONS: usize = LIGHTS.len() * 2;

#[test]
fn the_page_works_in_a_browser() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let results = sample::with_pictures(folder.path());
    let files = study::report(&results, folder.path()).expect("a report");
    let url = format!("file://{}", files[0].display());
    browser.emulate(1400, "light");
    browser.open(&url);

    charts_are_there(&mut browser);
    choosers_choose(&mut browser);
    tips_are_shown(&mut browser);
    charts_are_saved(&mut browser, folder.path());
    tables_sort(&mut browser);
    tables_are_copied(&mut browser);
    the_slider_moves(&mut browser);
    pictures_zoom(&mut browser);
    views_change(&mut browser);
    the_exposure_is_chosen(&mut browser);
    pixels_are_read(&mut browser, &results);
    methods_are_beside_each_other(&mut browser, &results);
    crops_are_shown(&mut browser);
    cells_are_filtered(&mut browser);
    themes_change(&mut browser);
    names_are_text(&mut browser);
    the_address_brings_a_picture_back(&mut browser, &url);
    it_fits(&mut browser, &url);

    assert_eq!(browser.complaints(), Vec::<String>::new());
    for request in browser.requests() {
        assert!(request.starts_with(&url), "the page asks for {request}");
    }
}

fn charts_are_there(browser: &mut Browser) {
    let mut count =
        |selector: &str| browser.number(&format!("document.querySelectorAll({selector:?}).length"));
    let points = (PIPELINES.len() * COMBINATIONS) as f64;
    assert_eq!(count("#time .choice"), (SCENES.len() * 3) as f64, "an error each: relMSE, FLIP, SSIM");
    assert_eq!(count("#time .chosen svg"), 1.0);
    assert_eq!(count("#time .chosen svg .mark"), points);
    assert_eq!(count("#time .chosen svg .front"), 1.0);
    // Along `lights` with the filter off and on, along the filter with each number of lights; five measures.
    assert_eq!(count("#axes .choice"), (SCENES.len() * 5 * (2 + LIGHTS.len())) as f64);
    assert_eq!(count("#axes .chosen svg .mark"), (PIPELINES.len() * LIGHTS.len()) as f64);
    assert_eq!(count("#passes .chosen svg .mark"), 4.0 * points);
    assert_eq!(count("#memory .chosen svg .mark"), 4.0 * points);
    assert_eq!(count("#tables .chosen tbody tr"), points);
}

fn choosers_choose(browser: &mut Browser) {
    let choose = |browser: &mut Browser, section: &str, place: usize, value: &str| {
        let _ = browser.eval(&format!(
            "(() => {{ const s = document.querySelectorAll('#{section} select')[{place}]; s.value = {value:?}; \
             s.dispatchEvent(new Event('change')); }})()"
        ));
    };
    let caption = "document.querySelector('#time .chosen figcaption').textContent";
    assert!(browser.text(caption).starts_with("relMSE against GPU time, cornell-box"));
    choose(browser, "time", 1, "ꟻLIP");
    assert!(browser.text(caption).starts_with("ꟻLIP against GPU time, cornell-box"));
    // A scene is chosen everywhere; the measure stays.
    choose(browser, "memory", 0, SCENES[1]);
    assert!(browser.text(caption).starts_with(&format!("ꟻLIP against GPU time, {}", SCENES[1])));
    assert_eq!(browser.text("document.querySelector('#picture-selects select').value"), SCENES[1]);
    choose(browser, "memory", 0, SCENES[0]);
    // The last select offers what there is for the axis.
    choose(browser, "axes", 2, "gather.filter");
    assert_eq!(
        browser.number("document.querySelectorAll('#axes select')[3].options.length"),
        LIGHTS.len() as f64
    );
    assert_eq!(browser.text("document.querySelectorAll('#axes select')[3].value"), "lights = 64");
}

fn tips_are_shown(browser: &mut Browser) {
    let place = browser.middle("#time .chosen .mark path:last-child");
    browser.mouse("mouseMoved", place);
    let tip =
        browser.text("document.querySelector('#tip').hidden ? '' : document.querySelector('#tip').innerText");
    assert!(tip.contains("GPU time") && tip.contains("3 seeds"), "{tip:?}");
    browser.mouse("mouseMoved", (2.0, 2.0));
    assert_eq!(browser.eval("document.querySelector('#tip').hidden"), true);
}

/// As files, with what was shown as a tip put back.
fn charts_are_saved(browser: &mut Browser, folder: &Path) {
    let downloads = folder.join("downloads");
    browser.download_to(&downloads);
    let name = browser.text("document.querySelector('#time .chosen .save').dataset.file");
    browser.click("#time .chosen .save");
    let path = downloads.join(&name);
    let start = Instant::now();
    // The browser makes the file before it has written it.
    let whole = || std::fs::read_to_string(&path).is_ok_and(|text| text.trim_end().ends_with("</svg>"));
    while !whole() {
        assert!(start.elapsed() < Duration::from_secs(300), "{name} is not saved");
        std::thread::sleep(Duration::from_millis(20));
    }
    let [saved, written] = [path, folder.join("figures").join(&name)]
        .map(|path| std::fs::read_to_string(path).expect("a chart"));
    for part in ["class=\"mark\"", "<title>", "<path ", "<text "] {
        assert_eq!(saved.matches(part).count(), written.matches(part).count(), "{part}");
    }
}

fn tables_are_copied(browser: &mut Browser) {
    browser.click("#tables .chosen details summary");
    browser.click("#tables .chosen details .copy");
    // Where the browser refuses the clipboard, the text is selected for the reader to copy.
    browser.wait(
        "(t => t === 'Copied' || t.startsWith('Selected') && getSelection().toString().includes('tabular'))\
         (document.querySelector('#tables .chosen .copy').textContent)",
    );
    browser.click("#tables .chosen details summary");
}

fn tables_sort(browser: &mut Browser) {
    let values = "[...document.querySelectorAll('#tables .chosen tbody tr')].map(r => Number(r.cells[4].dataset.value))";
    let sorted = |browser: &mut Browser| -> Vec<f64> {
        let values = browser.eval(values);
        values.as_array().expect("a list").iter().filter_map(serde_json::Value::as_f64).collect()
    };
    browser.click("#tables .chosen th:nth-child(5) button");
    let rising = sorted(browser);
    assert!(rising.len() == PIPELINES.len() * COMBINATIONS && rising.is_sorted(), "{rising:?}");
    browser.click("#tables .chosen th:nth-child(5) button");
    let falling = sorted(browser);
    assert!(falling.iter().rev().is_sorted(), "{falling:?}");
    let sort = browser.text("document.querySelector('#tables .chosen th:nth-child(5)').ariaSort");
    assert_eq!(sort, "descending");
}

fn the_slider_moves(browser: &mut Browser) {
    let clip = "getComputedStyle(document.querySelector('.pane.over')).clipPath";
    let divider = "Number(document.querySelector('#divider').ariaValueNow)";
    let width = "document.querySelector('#stage').clientWidth";
    assert_eq!(browser.number(divider), 50.0);
    let before = browser.text(clip);
    let (x, y) = browser.middle("#divider");
    let quarter = browser.number(width) / 4.0;
    browser.mouse("mouseMoved", (x, y));
    browser.mouse("mousePressed", (x, y));
    for step in 1..=5 {
        browser.mouse("mouseMoved", (x + quarter * f64::from(step) / 5.0, y));
    }
    browser.mouse("mouseReleased", (x + quarter, y));
    assert_eq!(browser.number(divider), 75.0);
    assert_ne!(browser.text(clip), before);
    let (moved, _) = browser.middle("#divider");
    assert!((moved - x - quarter).abs() < 1.5, "{x} + {quarter} is not {moved}");
    // Released, it stays.
    browser.mouse("mouseMoved", (x, y));
    assert_eq!(browser.number(divider), 75.0);
    for (key, at) in [("ArrowLeft", 74.0), ("ArrowRight", 75.0), ("Home", 0.0), ("End", 100.0)] {
        browser.key(key);
        assert_eq!(browser.number(divider), at, "{key}");
    }
}

fn pictures_zoom(browser: &mut Browser) {
    let scale = "new DOMMatrix(getComputedStyle(document.querySelector('.over canvas')).transform).a";
    let left = "document.querySelector('.over canvas').getBoundingClientRect().left";
    let middle = browser.middle("#stage");
    assert_eq!(browser.number(scale), 1.0);
    browser.wheel(middle, -400.0);
    browser.wait(&format!("{scale} > 2"));
    let rendering = "getComputedStyle(document.querySelector('.over canvas')).imageRendering";
    assert_eq!(browser.text(rendering), "pixelated");
    // The reference moves along.
    let same = "document.querySelector('.over canvas').getBoundingClientRect().left === \
                document.querySelector('.under canvas').getBoundingClientRect().left";
    assert_eq!(browser.eval(same), true);
    let before = browser.number(left);
    let (x, y) = (middle.0 - 60.0, middle.1);
    browser.mouse("mousePressed", (x, y));
    browser.mouse("mouseMoved", (x + 40.0, y));
    browser.mouse("mouseReleased", (x + 40.0, y));
    assert!((browser.number(left) - before - 40.0).abs() < 1.0);
    assert_eq!(browser.eval(same), true);
    browser.click("#zoom-in");
    assert!(browser.number(scale) > 3.0);
    browser.click("#zoom-fit");
    assert_eq!(browser.number(scale), 1.0);
}

/// What is painted on the left or alone.
const LEFT: &str = "document.querySelector('.over canvas').toDataURL()";

/// Waits until a view, or a view and its cell, is painted.
fn painted(browser: &mut Browser, what: &str) {
    browser.wait(&format!("(document.querySelector('#stage').dataset.shown ?? '').startsWith({what:?})"));
}

fn views_change(browser: &mut Browser) {
    let shown = |id: &str| format!("getComputedStyle(document.querySelector('#{id}')).display !== 'none'");
    painted(browser, "slider");
    let image = browser.text(LEFT);
    let mut seen = vec![image.clone()];
    for view in ["reference", "flip", "difference"] {
        browser.click(&format!("label:has(> input[value={view}])"));
        painted(browser, view);
        let picture = browser.text(LEFT);
        assert!(!seen.contains(&picture), "{view}");
        seen.push(picture);
        assert_eq!(browser.eval(&shown("flip-bar")), view == "flip");
        assert_eq!(browser.eval(&shown("difference-bar")), view == "difference");
        assert_eq!(browser.eval(&shown("divider")), false);
    }
    assert_eq!(browser.number("document.querySelector('.over canvas').width"), 48.0);
    browser.click("label:has(> input[value=side])");
    painted(browser, "side");
    let lefts = "['.over', '.under'].map(p => document.querySelector(p).getBoundingClientRect().left)";
    let lefts = browser.eval(lefts);
    assert!(lefts[0].as_f64() < lefts[1].as_f64(), "{lefts}");
    assert_eq!(browser.text(LEFT), image);
    browser.click("label:has(> input[value=slider])");
    painted(browser, "slider");
}

fn the_exposure_is_chosen(browser: &mut Browser) {
    let auto = browser.text(LEFT);
    let stops = browser.number("document.querySelector('#exposure-number').valueAsNumber");
    let color = |browser: &mut Browser| {
        let pixel = browser.eval(
            "[...document.querySelector('.over canvas').getContext('2d').getImageData(2, 2, 1, 1).data]",
        );
        pixel.as_array().expect("a list").iter().filter_map(serde_json::Value::as_f64).collect::<Vec<_>>()
    };
    let before = color(browser);
    let _ = browser.eval(&format!(
        "(e => {{ e.value = {}; e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change')); }})\
         (document.querySelector('#exposure-number'))",
        stops - 1.0
    ));
    browser.wait(&format!("document.querySelector('#stage').dataset.shown.endsWith(' {:.2}')", stops - 1.0));
    // Half the light, in sRGB.
    let linear = |value: f64| {
        let value = value / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    for (before, after) in before.iter().zip(color(browser)).take(3).filter(|(before, _)| **before < 250.0) {
        assert!((linear(after) / linear(*before) - 0.5).abs() < 0.03, "{before} {after}");
    }
    assert_eq!(browser.number("document.querySelector('#exposure-number').valueAsNumber"), stops - 1.0);
    browser.click("#exposure-auto");
    browser.wait(&format!("document.querySelector('#stage').dataset.shown.endsWith(' {stops:.2}')"));
    assert_eq!(browser.text(LEFT), auto);
}

fn pixels_are_read(browser: &mut Browser, results: &study::Results) {
    let noise = results.cells[0].measures["rel-mse"].expect("an error").sqrt() as f32;
    let (image, reference) = (sample::picture(0, noise, 1), sample::picture(0, 0.0, 0));
    let row = |browser: &mut Browser, row: usize| -> Vec<f64> {
        let text = format!(
            "[...document.querySelectorAll('#pixel tbody tr')[{row}].cells].slice(1)\
             .map(c => Number(c.textContent.replace('−', '-')))"
        );
        browser.eval(&text).as_array().expect("a list").iter().filter_map(serde_json::Value::as_f64).collect()
    };
    let near = |found: &[f64], expected: [f32; 3]| {
        assert_eq!(found.len(), 3, "{found:?}");
        // Half floats, printed with four digits.
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - f64::from(expected)).abs() < 2e-3, "{found} is not {expected}");
        }
    };
    let rgb = |image: &metrics::Image, (x, y): (usize, usize)| -> [f32; 3] {
        let [r, g, b, _] = image.pixels()[y * sample::SIZE.0 + x];
        [r, g, b]
    };
    let _ = browser.middle("#stage");
    let place = browser.eval(
        "(b => [b.x + 10.5 / 48 * b.width, b.y + 5.5 / 32 * b.height])\
         (document.querySelector('#stage').getBoundingClientRect())",
    );
    let at = (place[0].as_f64().expect("x"), place[1].as_f64().expect("y"));
    browser.mouse("mouseMoved", at);
    let check = |browser: &mut Browser, at: (usize, usize)| {
        let (left, right) = (rgb(&image, at), rgb(&reference, at));
        near(&row(browser, 0), left);
        near(&row(browser, 1), right);
        near(&row(browser, 2), std::array::from_fn(|channel| left[channel] - right[channel]));
        let told = browser.text("document.querySelector('#pixel-at').textContent");
        assert_eq!(told, format!("Pixel {}, {}", at.0, at.1));
    };
    check(browser, (10, 5));
    // By keys, once it has the focus.
    let _ = browser.eval("document.querySelector('#pixel').focus({ preventScroll: true })");
    browser.key("ArrowRight");
    browser.key("ArrowDown");
    check(browser, (11, 6));
}

fn methods_are_beside_each_other(browser: &mut Browser, results: &study::Results) {
    let under = "document.querySelector('.under canvas').toDataURL()";
    let reference = browser.text(under);
    let other = results.cells.iter().find(|cell| cell.pipeline == PIPELINES[2]).expect("a cell");
    let choose = |browser: &mut Browser, key: &str| {
        let _ = browser.eval(&format!(
            "(s => {{ s.value = {key:?}; s.dispatchEvent(new Event('change')); }})(document.querySelector('#beside'))"
        ));
        browser.wait(&format!(
            "document.querySelector('#stage').dataset.shown.includes({:?})",
            format!(" {key} ")
        ));
    };
    choose(browser, &other.key);
    assert_ne!(browser.text(under), reference);
    assert!(browser.text("document.querySelector('.tag.right').textContent").starts_with(PIPELINES[2]));
    assert!(browser.text("location.hash").contains(&format!("beside={}", other.key)));
    // The reference has a row of its own.
    assert_eq!(browser.number("document.querySelectorAll('#pixel tbody tr').length"), 4.0);
    choose(browser, "reference");
    assert_eq!(browser.text(under), reference);
}

fn crops_are_shown(browser: &mut Browser) {
    let count = |browser: &mut Browser, wanted: usize| {
        browser.wait(&format!("document.querySelectorAll('#crops .crop').length === {wanted}"));
        let outlines = "document.querySelectorAll('.pane.over .outline').length";
        assert_eq!(browser.number(outlines), wanted as f64);
    };
    // Those of the study: the reference and each pipeline with these values.
    count(browser, 2);
    let sizes = "[...document.querySelectorAll('#crops .crop:first-child canvas')].map(c => c.width + 'x' + c.height)";
    assert_eq!(browser.eval(sizes), serde_json::json!(["6x8", "6x8", "6x8", "6x8"]));
    // Marked with Shift held.
    browser.click("#crop-mark");
    let (x, y) = browser.middle("#stage");
    browser.mouse("mouseMoved", (x + 20.0, y + 20.0));
    browser.mouse("mousePressed", (x + 20.0, y + 20.0));
    browser.mouse("mouseMoved", (x + 90.0, y + 80.0));
    browser.mouse("mouseReleased", (x + 90.0, y + 80.0));
    count(browser, 3);
    assert!(
        browser.text("document.querySelector('#crops-field pre').textContent").starts_with("crops: [(0.25, ")
    );
    // By a key: what is on the stage.
    browser.key("c");
    count(browser, 4);
    for left in [3, 2] {
        browser.click("#crops .crop:last-child button");
        count(browser, left);
    }
}

fn cells_are_filtered(browser: &mut Browser) {
    let total = SCENES.len() * PIPELINES.len() * COMBINATIONS * SEEDS.len();
    let shown = "[...document.querySelectorAll('#cell-table tbody')].filter(r => !r.hidden).length";
    assert_eq!(browser.number(shown), total as f64);
    browser.click("#cells summary");
    browser.click("#cell-failed");
    assert_eq!(browser.number(shown), 1.0);
    browser.click("#cell-failed");
    browser.click("#cell-filter");
    let _ = browser.eval("document.execCommand('insertText', false, 'cornell sequential')");
    assert_eq!(browser.number(shown), (COMBINATIONS * SEEDS.len()) as f64);
}

fn themes_change(browser: &mut Browser) {
    let ground = "getComputedStyle(document.body).backgroundColor";
    let ink = "getComputedStyle(document.querySelector('#time .chosen svg text')).fill";
    let (light, light_ink) = (browser.text(ground), browser.text(ink));
    browser.emulate(1400, "dark");
    let (dark, dark_ink) = (browser.text(ground), browser.text(ink));
    assert!(light != dark && light_ink != dark_ink, "{light} {dark}, {light_ink} {dark_ink}");
    // By hand: light, then dark, then as the system has it.
    for expected in [&light, &dark, &dark] {
        browser.click("#theme");
        assert_eq!(browser.text(ground), *expected);
    }
    browser.emulate(1400, "light");
}

fn names_are_text(browser: &mut Browser) {
    assert_eq!(browser.number("document.querySelectorAll('main b:not(td b)').length"), 0.0);
    let legend = format!(
        "[...document.querySelectorAll('#time .chosen svg text')].some(t => t.textContent === {:?})",
        PIPELINES[1]
    );
    assert_eq!(browser.eval(&legend), true);
}

fn the_address_brings_a_picture_back(browser: &mut Browser, url: &str) {
    browser.click("label:has(> input[value=flip])");
    let _ = browser.eval(
        "(() => { const s = document.querySelectorAll('#picture-selects select'); s[3].value = '2'; \
         s[3].dispatchEvent(new Event('change')); })()",
    );
    let address = browser.text("location.href");
    assert!(address.contains("view=flip") && address.contains("seed=2"), "{address}");
    let painted = "document.querySelector('#stage').dataset.shown ?? ''";
    browser.wait(&format!("({painted}).startsWith('flip')"));
    let seed = "document.querySelectorAll('#picture-selects select')[3].value === '2'";
    assert_eq!(browser.eval(seed), true);
    browser.wait(
        "!document.querySelector('#stage').ariaBusy || document.querySelector('#stage').ariaBusy === 'false'",
    );
    let shown = browser.text(painted);
    let picture = browser.text(LEFT);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    browser.open(url);
    browser.wait(&format!("({painted}).startsWith('slider')"));
    assert_ne!(browser.text(LEFT), picture);
    browser.open(&address);
    browser.wait(&format!("({painted}) === {shown:?}"));
    assert_eq!(browser.text(LEFT), picture);
}

/// No width makes the page scroll sideways. Pictures of it are kept in the folder `REPORT_SCREENSHOTS`, where
/// that is set.
fn it_fits(browser: &mut Browser, url: &str) {
    let folder = std::env::var_os("REPORT_SCREENSHOTS").map(PathBuf::from);
    for width in [1400, 420] {
        for scheme in ["light", "dark"] {
            browser.emulate(width, scheme);
            browser.open(url);
            let overflow = "document.scrollingElement.scrollWidth - document.documentElement.clientWidth";
            assert_eq!(browser.number(overflow), 0.0, "at {width} px");
            if let Some(folder) = &folder {
                browser.screenshot(&folder.join(format!("{scheme}-{width}.png")));
            }
        }
    }
}
