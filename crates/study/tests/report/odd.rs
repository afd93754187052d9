//! Results that are not as a study would like them.

use std::path::Path;

use metrics::{Display, Image};
use study::{AxisValue, CellImages, Memory, Outcome, Results};

use super::sample;

/// The page of some results, in a folder of its own.
fn page(results: &Results) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    page_in(results, folder.path())
}

fn page_in(results: &Results, folder: &Path) -> String {
    study::report(results, folder).expect("a report");
    let page = std::fs::read_to_string(folder.join("report.html")).expect("a page");
    let body = page.split("<script").next().expect("what comes before the scripts");
    for none in [">NaN", "\"NaN", "NaN ±", "NaN ms", ">inf", "\"inf", "inf ±", "\"-inf"] {
        let at =
            body.find(none).map(|at| body[at.saturating_sub(100)..].chars().take(150).collect::<String>());
        assert_eq!(at, None, "a number that is none");
    }
    page
}

#[test]
fn nothing_has_run() {
    let mut results = sample::results();
    results.cells.clear();
    let page = page(&results);
    assert!(page.contains("108 of 108 cells have not run yet"));
    assert!(page.contains("No cell has run yet.") && page.contains("There are no pictures"));
}

#[test]
fn every_cell_failed() {
    let mut results = sample::results();
    for cell in &mut results.cells {
        cell.outcome = Outcome::Failed { error: "shader `x.wgsl`: <syntax> & 100 % wrong".to_owned() };
        cell.measures.clear();
        cell.passes.clear();
        cell.memory = Memory::default();
    }
    let folder = tempfile::tempdir().expect("a folder");
    let page = page_in(&results, folder.path());
    assert!(page.contains("shader `x.wgsl`: &lt;syntax&gt; &amp; 100 % wrong <details><summary>108 cells"));
    let tex = std::fs::read_to_string(folder.path().join("tables/cornell-box.tex")).expect("a table");
    assert!(tex.contains("\\textless{}syntax\\textgreater{} \\& 100 \\% wrong}"), "{tex}");
    assert!(!page.contains("<svg"));
}

#[test]
fn one_cell_and_nothing_varied() {
    let mut results = sample::results();
    results.cells.truncate(1);
    let cell = &mut results.cells[0];
    cell.axes.clear();
    results.study.axes.clear();
    results.study.references.clear();
    results.study.differences.clear();
    results.study.cell_count = 1;
    let page = page(&results);
    assert!(page.contains("nothing is varied over two values"));
    assert!(page.contains("This study has no reference.") && page.contains("There is one pipeline."));
    assert_eq!(page.matches("class=\"series ").count(), 3, "one point for each error");
    assert!(!page.contains("<b>"), "the only value is not the best");
    assert!(!page.contains("id=failures"));
}

#[test]
fn zeros_stand_at_the_edge_and_missing_values_nowhere() {
    let mut results = sample::results();
    results.cells.truncate(54);
    for (index, cell) in results.cells.iter_mut().enumerate() {
        let value = match index / 3 {
            0 => Some(0.0),
            1 => None,
            _ => Some(10_f64.powi(-(index as i32 / 3))),
        };
        cell.measures.insert("rel-mse".to_owned(), value);
        cell.measures.insert("ssim".to_owned(), Some(-1.0 + f64::from(index as u32 / 3)));
        cell.measures.insert("flip".to_owned(), Some(f64::INFINITY));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let page = page_in(&results, folder.path());
    let chart =
        std::fs::read_to_string(folder.path().join("figures/cornell-box-rel-mse-time.svg")).expect("a chart");
    assert_eq!(chart.matches("class=\"mark\"").count(), 17);
    assert!(chart.contains("hollow, at the edge: 0 or less (1 of 17)"), "{chart}");
    assert!(!page.contains("ꟻLIP against"), "what is infinite is not drawn");
}

#[test]
fn errors_below_that_of_the_reference_are_no_gains() {
    let corners = |noise: f64| {
        let mut results = sample::results();
        results.study.references[0].noise = Some(noise);
        let folder = tempfile::tempdir().expect("a folder");
        page_in(&results, folder.path());
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
        let chart = read("figures/cornell-box-rel-mse-time.svg");
        let front = chart.split("class=\"front\"").nth(1);
        let path = front.and_then(|front| front.split("d=\"").nth(1)?.split('"').next());
        (path.map_or(0, |path| path.matches('V').count()), read("tables/cornell-box.md"))
    };
    let (corners_of_all, table) = corners(1e-9);
    assert!(corners_of_all > 3 && table.contains("| 2 of 3 | **0.00111"), "{corners_of_all} {table}");
    let (corners_of_some, table) = corners(0.02);
    assert!((1..corners_of_all).contains(&corners_of_some), "{corners_of_some} of {corners_of_all}");
    assert!(table.contains("| **0.0183 ± 0.0030** |") && !table.contains("**0.0370"), "{table}");
    // Every error of the scene is below that of its reference.
    let (corners_of_none, table) = corners(1.0);
    assert_eq!(corners_of_none, 0, "no front");
    assert!(table.contains("relMSE below 1, the reference’s own, is no gain"), "{table}");
    assert!(table.contains("| 2 of 3 | 0.00111 ± 0.00030 | **0.0071"), "{table}");
}

#[test]
fn pictures_of_one_pixel_and_pictures_that_are_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut results = sample::results();
    let pixel = |value: f32| Image::new(1, 1, vec![[value, 0.0, 0.0, 1.0]]).expect("a pixel");
    pixel(0.0).write(folder.path().join("one.exr"), Display::AS_IS, None).expect("a file");
    pixel(f32::NAN).write(folder.path().join("broken.exr"), Display::AS_IS, None).expect("a file");
    sample::picture(0, 0.0, 0).write(folder.path().join("large.exr"), Display::AS_IS, None).expect("a file");
    std::fs::write(folder.path().join("text.exr"), "not a picture").expect("a file");
    results.study.references[0].image = Some("one.exr".to_owned());
    results.study.references[1].image = Some("gone.exr".to_owned());
    for (cell, name) in
        results.cells.iter_mut().zip(["one.exr", "broken.exr", "large.exr", "text.exr", "gone.exr"])
    {
        cell.images =
            CellImages { image: Some(name.to_owned()), flip: Some("gone.png".to_owned()), reference: None };
    }
    let page = page_in(&results, folder.path());
    assert!(page.contains("gone.exr: cannot open"), "a file that is not there is told");
    assert!(page.contains("text.exr: expected an EXR picture"), "one that is none as well");
    assert!(page.contains("the sizes differ: the image is 48x32, the reference 1x1"));
    assert!(!page.contains(&folder.path().display().to_string()), "paths are those of the study");
}

#[test]
fn names_and_values_that_the_study_does_not_have() {
    let mut results = sample::results();
    results.cells[0].scene = "elsewhere".to_owned();
    results.cells[1].pipeline = "another".to_owned();
    results.cells[2]
        .axes
        .insert("lights".to_owned(), AxisValue::Text("</script><script>alert(1)".to_owned()));
    results.cells[3].axes.clear();
    let page = page(&results);
    assert!(page.contains("elsewhere") && page.contains("another"));
    assert_eq!(page.matches("<script").count(), 2, "the data and the page's own");
}

#[test]
fn what_the_budget_chose_has_a_column() {
    let mut results = sample::results();
    for cell in &mut results.cells {
        cell.chosen.insert("lights".to_owned(), AxisValue::Number(480.0 + f64::from(cell.seed)));
    }
    let folder = tempfile::tempdir().expect("a folder");
    page_in(&results, folder.path());
    let table = std::fs::read_to_string(folder.path().join("tables/cornell-box.md")).expect("a table");
    assert!(table.contains("| lights\\* |") && table.contains("| 481–483 |"), "{table}");
}

#[test]
fn many_rows_are_split_and_many_combinations_left_out() {
    let mut results = sample::results();
    let lights: Vec<AxisValue> = (1..=40).map(|n| AxisValue::Number(f64::from(n))).collect();
    let cell = results.cells[0].clone();
    results.cells = (0..40)
        .flat_map(|n| {
            let cell = &cell;
            let lights = &lights;
            [false, true].map(|filter| {
                let mut cell = cell.clone();
                cell.key = format!("{n}{filter}");
                cell.axes.insert("lights".to_owned(), lights[n].clone());
                cell.axes.insert("gather.filter".to_owned(), AxisValue::Bool(filter));
                cell
            })
        })
        .collect();
    results.study.axes[0].values = lights;
    let folder = tempfile::tempdir().expect("a folder");
    let page = page_in(&results, folder.path());
    assert!(
        page.contains("33 to 64 of 80") && folder.path().join("figures/cornell-box-passes-3.svg").is_file()
    );
    // 40 combinations for the filter's axis, of which 16 are drawn, for each of five measures.
    assert!(page.contains("120 charts over axes of cornell-box are left out"));
}

#[test]
fn a_page_that_would_be_too_large_keeps_a_seed_of_each_combination() {
    let folder = tempfile::tempdir().expect("a folder");
    // Noise does not compress: each picture is about 0.6 MB, and a third more in base64.
    let noise = |index: u32| sample::random(index);
    let pixel = |x: usize, y: usize| {
        let index = 3 * (y * 360 + x) as u32;
        [noise(index), noise(index + 1), noise(index + 2), 1.0]
    };
    let image = Image::from_fn(360, 360, pixel).expect("pixels");
    image.write(folder.path().join("noise.exr"), Display::AS_IS, None).expect("a file");
    let mut results = sample::results();
    for cell in &mut results.cells {
        cell.images.image = Some("noise.exr".to_owned());
    }
    let page = page_in(&results, folder.path());
    assert!((25_000_000..40_000_000).contains(&page.len()), "{} bytes", page.len());
    let count = |seed: u32| page.matches(&format!("\"seed\":{seed},\"key\"")).count();
    assert_eq!(count(1), 36, "one of each combination");
    let kept = 36 + count(2) + count(3);
    assert!((37..108).contains(&kept), "{kept}");
    assert!(page.contains(&format!("{} of 108 pictures are left out", 108 - kept)), "{kept}");
}

/// As `Paired({ "lights": […], "gather.filter": […] })` makes them: lights say what the filter is.
#[test]
fn axes_that_go_together_are_drawn_over_as_one() {
    let mut results = sample::results();
    results.cells.retain(|cell| {
        let few = cell.axes["lights"] == AxisValue::Number(64.0);
        cell.axes["gather.filter"] == AxisValue::Bool(!few)
    });
    let folder = tempfile::tempdir().expect("a folder");
    study::report(&results, folder.path()).expect("a report");
    let files = std::fs::read_dir(folder.path().join("figures")).expect("figures");
    let names: Vec<String> =
        files.map(|file| file.expect("a file").file_name().to_string_lossy().into_owned()).collect();
    let over: Vec<&String> =
        names.iter().filter(|name| name.contains("-over-") && name.ends_with(".svg")).collect();
    // Five measures of two scenes, each in one chart of all three numbers of lights.
    assert_eq!(over.len(), 10, "{over:?}");
    assert!(over.iter().all(|name| name.ends_with("-over-lights.svg")), "{over:?}");
}

#[test]
fn a_title_stands_in_place_of_the_name() {
    let mut results = sample::results();
    results.study.title = "Maps & <rays>".to_owned();
    let folder = tempfile::tempdir().expect("a folder");
    let files = study::report(&results, folder.path()).expect("a report");
    let page = std::fs::read_to_string(&files[0]).expect("a page");
    assert!(page.contains("<h1>Maps &amp; &lt;rays&gt;</h1>"));
    assert!(page.contains(&format!("<dt>Study</dt><dd>{}</dd>", results.study.name)));
}
