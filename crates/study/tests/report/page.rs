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
        assert!(start.elapsed() < Duration::from_secs(30), "{name} is not saved");
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
    let scale = "new DOMMatrix(getComputedStyle(document.querySelector('.over img')).transform).a";
    let left = "document.querySelector('.over img').getBoundingClientRect().left";
    let middle = browser.middle("#stage");
    assert_eq!(browser.number(scale), 1.0);
    browser.wheel(middle, -400.0);
    browser.wait(&format!("{scale} > 2"));
    let rendering = "getComputedStyle(document.querySelector('.over img')).imageRendering";
    assert_eq!(browser.text(rendering), "pixelated");
    // The reference moves along.
    let same = "document.querySelector('.over img').getBoundingClientRect().left === \
                document.querySelector('.under img').getBoundingClientRect().left";
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

fn views_change(browser: &mut Browser) {
    let source = "document.querySelector('.over img').src";
    let shown = |id: &str| format!("getComputedStyle(document.querySelector('#{id}')).display !== 'none'");
    let image = browser.text(source);
    let mut seen = vec![image.clone()];
    for view in ["reference", "flip", "difference"] {
        browser.click(&format!("label:has(> input[value={view}])"));
        let source = browser.text(source);
        assert!(source.starts_with("data:image/png;base64,") && !seen.contains(&source), "{view}");
        seen.push(source);
        assert_eq!(browser.eval(&shown("flip-bar")), view == "flip");
        assert_eq!(browser.eval(&shown("difference-bar")), view == "difference");
        assert_eq!(browser.eval(&shown("divider")), false);
    }
    browser.wait("document.querySelector('.over img').naturalWidth === 48");
    browser.click("label:has(> input[value=side])");
    let lefts = "['.over', '.under'].map(p => document.querySelector(p).getBoundingClientRect().left)";
    let lefts = browser.eval(lefts);
    assert!(lefts[0].as_f64() < lefts[1].as_f64(), "{lefts}");
    assert_eq!(browser.text(source), image);
    browser.click("label:has(> input[value=slider])");
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
    let source = browser.text("document.querySelector('.over img').src");
    assert_eq!(browser.complaints(), Vec::<String>::new());
    browser.open(url);
    assert_ne!(browser.text("document.querySelector('.over img').src"), source);
    browser.open(&address);
    assert_eq!(browser.text("document.querySelector('.over img').src"), source);
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
