//! The files beside the page.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use super::sample;

/// Every file below a folder with its bytes, by relative path.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).expect("below").to_string_lossy().into_owned();
                found.insert(name, std::fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

#[test]
fn the_same_results_give_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let results = sample::with_pictures(folder.path());
    let files = study::report(&results, folder.path()).expect("a report");
    let first = contents(folder.path());
    for file in &files {
        let name = file.strip_prefix(folder.path()).expect("in the folder").to_string_lossy();
        assert!(first.contains_key(&*name), "{name}");
    }
    assert!(first.keys().all(|name| !name.contains(".part")), "what was half written is gone");
    study::report(&results, folder.path()).expect("a report");
    assert!(first == contents(folder.path()));
}

/// Charts are for a column of a paper, as SVG and as PDF, and in the page for its width.
#[test]
fn charts_are_files_for_papers() {
    let folder = tempfile::tempdir().expect("a folder");
    study::report(&sample::results(), folder.path()).expect("a report");
    let files = contents(folder.path());
    let page = String::from_utf8(files["report.html"].clone()).expect("text");
    let is_chart = |name: &&String| name.starts_with("figures/") && name.ends_with(".svg");
    let figures: Vec<&String> = files.keys().filter(is_chart).collect();
    // Three errors over time, five measures over two axes with the other one fixed, passes, memory; two scenes.
    assert_eq!(figures.len(), 2 * (3 + 5 * 5 + 2), "{figures:?}");
    for name in figures {
        let svg = std::str::from_utf8(&files[name]).expect("text");
        let label = svg.split("aria-label=").nth(1).and_then(|rest| rest.split('>').next()).expect("a label");
        assert!(page.contains(label), "{name}");
        // Alone it has all it needs.
        assert!(!svg.contains("var(") && svg.contains("fill=\"#") && svg.contains("xmlns="), "{name}");
        assert!(svg.contains("width=\"320\"") && page.contains("width=\"540\""), "{name}");
        let pdf = String::from_utf8_lossy(&files[&name.replace(".svg", ".pdf")]);
        // 240 points wide, with the font.
        assert!(pdf.contains("/MediaBox [0 0 240 ") && pdf.contains("/FontFile2"), "{name}");
    }
    for link in ["http://", "https://"] {
        let outside = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!outside.contains(link), "the page points outside by {link}");
    }
}

#[test]
fn crops_are_files_for_papers() {
    let folder = tempfile::tempdir().expect("a folder");
    let results = sample::with_pictures(folder.path());
    study::report(&results, folder.path()).expect("a report");
    let files = contents(folder.path());
    let crops: Vec<&String> =
        files.keys().filter(|name| name.starts_with("figures/") && name.ends_with(".png")).collect();
    // Two crops of each reference, and of the first seed of each combination; and each reference as a whole.
    assert_eq!(crops.len(), 2 * 2 * (1 + 18) + 2, "{crops:?}");
    let read =
        |name: &str| metrics::Image::read(folder.path().join("figures").join(name)).expect("a picture");
    let crop = read("cornell-box-crop-1-reference.png");
    // 6 by 8 pixels, 48 times.
    assert_eq!((crop.width(), crop.height()), (288, 384));
    let method = read("cornell-box-crop-1-sequential-lights-64-gather.filter-false.png");
    assert_eq!((method.width(), method.height()), (288, 384));
    assert!(method.pixels() != crop.pixels());
}

#[test]
fn crops_are_composed_to_figures_with_the_error_under_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let results = sample::with_pictures(folder.path());
    study::report(&results, folder.path()).expect("a report");
    let files = contents(folder.path());
    let is_composed =
        |name: &&String| name.ends_with(".pdf") && files.contains_key(&name.replace(".pdf", ".tex"));
    let figures: Vec<&String> = files.keys().filter(is_composed).collect();
    // Six of 18 combinations in each.
    assert_eq!(figures.len(), 2 * 3, "{figures:?}");
    let page = std::str::from_utf8(&files["report.html"]).expect("text");
    for pdf in figures {
        assert!(files[pdf].starts_with(b"%PDF-"), "{pdf}");
        // The page leads to both.
        for name in [pdf, &pdf.replace(".pdf", ".tex")] {
            assert!(page.contains(&format!("<a href=\"{name}\">")), "{name}");
        }
        let tex = std::str::from_utf8(&files[&pdf.replace(".pdf", ".tex")]).expect("text");
        assert_eq!(tex.matches("\\includegraphics").count(), 1 + 2 * 7, "{tex}");
        let named = tex.split("\\unitlength]{").skip(1).filter_map(|rest| rest.split_once('}'));
        for (picture, _) in named {
            assert!(files.contains_key(&format!("figures/{picture}")), "{picture}");
        }
    }
    let tex = std::str::from_utf8(&files["figures/cornell-box-figure.tex"]).expect("text");
    // The number is that of the table.
    let table = std::str::from_utf8(&files["tables/cornell-box.tex"]).expect("text");
    let line = tex.lines().find(|line| line.contains("\\\\ $")).expect("a method");
    let (_, number) = line.split_once("\\\\ $").expect("a number");
    let number = number.split('$').next().expect("its end");
    assert!(number.contains("\\pm") && table.contains(number), "{number} in {table}");
}

/// LaTeX takes tables, figures and charts as they are, with all that names may contain.
#[test]
fn latex_takes_all_files() {
    if Command::new("pdflatex").arg("--version").output().is_err() {
        eprintln!("skipped: there is no pdflatex");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut results = sample::with_pictures(folder.path());
    let odd = "[1] *a_b* {50 %} ~ #2 ^ \\x $y$ & \"z\" <|> ≤ ≥ ≈ ± × · ² ⁻⁵ µ σ δ ε √ ∞ Δ → – − ′ ’ … ä";
    let known = sample::PIPELINES[0];
    results
        .study
        .pipelines
        .iter_mut()
        .filter(|record| record.name == known)
        .for_each(|record| record.name = odd.to_owned());
    results
        .cells
        .iter_mut()
        .filter(|cell| cell.pipeline == known)
        .for_each(|cell| cell.pipeline = odd.to_owned());
    study::report(&results, folder.path()).expect("a report");
    let mut paper = String::from(
        "\\documentclass[twocolumn]{article}\n\\usepackage{booktabs,graphicx,color}\n\\graphicspath{{figures/}}\n\\begin{document}\n",
    );
    let files = contents(folder.path());
    for name in files.keys().filter(|name| name.ends_with(".tex")) {
        paper += &format!("\\input{{{name}}}\n\n");
    }
    let charts = files.keys().filter(|name| name.ends_with("-time.pdf"));
    for name in charts.clone().chain(files.keys().filter(|name| name.ends_with("figure.pdf"))) {
        paper += &format!("\\includegraphics{{{name}}}\n\n");
    }
    assert!(charts.count() > 0 && paper.matches("\\input").count() > 4, "{paper}");
    paper += "\\end{document}\n";
    std::fs::write(folder.path().join("paper.tex"), &paper).expect("a file");
    let mut latex = Command::new("pdflatex");
    latex.args(["-interaction=nonstopmode", "-halt-on-error", "paper.tex"]).current_dir(folder.path());
    let ran = latex.output().expect("pdflatex runs");
    let log = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success() && !log.contains("Missing character"), "{log}");
    eprintln!("ran: pdflatex");
}

#[test]
fn the_order_of_the_cells_does_not_matter() {
    let mut results = sample::results();
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    study::report(&results, folders[0].path()).expect("a report");
    results.cells.reverse();
    study::report(&results, folders[1].path()).expect("a report");
    let [first, second] = folders.map(|folder| contents(folder.path()));
    assert!(first == second);
}

#[test]
fn figures_and_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    study::report(&sample::results(), folder.path()).expect("a report");
    let files = contents(folder.path());
    for name in ["tables/cornell-box.md", "tables/cornell-box.tex", "figures/cornell-box-rel-mse-time.svg"] {
        let text = std::str::from_utf8(&files[name]).expect("text");
        let snapshot = name.rsplit('/').next().expect("a name");
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
            insta::assert_snapshot!(snapshot, text);
        });
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file where a folder has to be.
    let place = folder.path().join("study");
    std::fs::write(&place, "").expect("a file");
    let error = study::report(&sample::results(), &place).expect_err("no folder");
    let text = error.to_string();
    assert!(text.contains("study/figures: cannot make the folder"), "{text}");
}
