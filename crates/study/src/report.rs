//! The report of a study: one page, figures and tables, generated from the study's results.

mod best;
mod digest;
mod figures;
mod gallery;
mod page;
mod pictures;
mod table;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::error::io;
use crate::{Results, StudyError, folder};
pub(crate) use digest::{Digest, distinct, is_time};
use figures::Figures;
pub use gallery::gallery;
use pictures::Pictures;
use report::{Table, escape};

/// Folders of the report's files inside the study's.
const FIGURES: &str = "figures";
const TABLES: &str = "tables";

/// Returns the table of claims, with what was measured; `None` for a study without claims.
pub fn claims(results: &Results) -> Option<Table> {
    table::of_claims(&Digest::new(results))
}

/// Returns the table of each scene: a row for each pipeline and combination of values.
pub fn tables(results: &Results) -> Vec<Table> {
    of_scenes(&Digest::new(results))
}

fn of_scenes(digest: &Digest<'_>) -> Vec<Table> {
    let scenes = (0..digest.scenes.len()).map(|scene| table::of_scene(digest, scene));
    scenes.filter(|table| !table.is_empty()).collect()
}

/// Writes a report into the study's folder, which holds the pictures that `results` names: `report.html`, a
/// single file that needs no other files and no network; its charts as `figures/*.svg`, the crops that the study declares as
/// `figures/*.png`, and figures of them with the error under each as `figures/*-figure.pdf` and `.tex`; its tables as `tables/*.md` and `tables/*.tex`. The same results give the same bytes. A file is
/// always complete or absent, also while it replaces another. Returns the files that were written, the page first.
///
/// # Errors
/// Fails if a file cannot be written. Pictures that cannot be read are no errors; the page reports them.
pub fn report(results: &Results, folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    report_with(results, folder, &[])
}

/// Writes a report as [`report()`] does, with further tables at the top of the page.
///
/// # Errors
/// Those of [`report()`].
pub fn report_with(results: &Results, folder: &Path, more: &[Table]) -> Result<Vec<PathBuf>, StudyError> {
    let digest = Digest::new(results);
    let figures = Figures::new(&digest);
    let tables = of_scenes(&digest);
    let claims = table::of_claims(&digest);
    let pictures = Pictures::new(&digest, folder);

    let page = page::page(&digest, &figures, (more, &tables, claims.as_ref()), &pictures);
    let mut files = vec![(PathBuf::from("report.html"), page.into_bytes())];
    for figure in figures.all {
        let file = Path::new(FIGURES).join(&figure.file);
        files.push((file.with_extension("pdf"), figure.column.pdf()));
        files.push((file, figure.column.svg().into_bytes()));
    }
    files.extend(pictures.insets.into_iter().map(|(name, bytes)| (Path::new(FIGURES).join(name), bytes)));
    let mut taken = BTreeSet::new();
    for table in more.iter().chain(&tables).chain(&claims) {
        let name = figures::unique(&mut taken, &format!("{}.md", escape::file_name(&table.name)));
        let path = Path::new(TABLES).join(name);
        files.push((path.with_extension("tex"), table.latex().into_bytes()));
        files.push((path, table.markdown().into_bytes()));
    }
    for part in [FIGURES, TABLES] {
        let part = folder.join(part);
        std::fs::create_dir_all(&part).map_err(io(&part, "cannot make the folder"))?;
    }
    let write = |(name, bytes): (PathBuf, Vec<u8>)| {
        let path = folder.join(name);
        folder::write(&path, &bytes)?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}
