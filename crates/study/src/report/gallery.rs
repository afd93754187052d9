//! The pictures of a study in a page of documentation, each with its time and its error.

use super::digest::{Digest, Row};
use super::pictures::{self, exposed_for};
use crate::error::io;
use crate::folder::write;
use crate::page::between;
use crate::{Results, StudyError};
use metrics::Image;
use report::{Measured, escape};
use std::path::{Path, PathBuf};

/// Pictures in a row of the page.
const COLUMNS: usize = 5;
/// Their width on the page \[px\].
const WIDTH: u32 = 160;
/// The measure of error that stands below a picture.
const ERROR: &str = "rel-mse";

/// Writes the pictures of a study, the reference first, as PNG files into a folder, and a table of them, with time and error
/// below each, into a page of Markdown between `<!-- gallery: NAME -->` and `<!-- end -->`. The rest of the page stays as it is.
/// Returns the files, the page last.
///
/// # Errors
/// Fails for a folder that is no study or has no picture, for pictures that cannot be read, for a page without the section, and if a file
/// cannot be written.
pub fn gallery(folder: &Path, page: &Path, into: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let results = Results::read(folder)?;
    let digest = Digest::new(&results);
    let name = &results.study.name;
    let damaged = |reason: String| StudyError::Damaged { path: page.to_owned(), reason };
    let text = std::fs::read_to_string(page).map_err(io(page, "cannot read"))?;
    std::fs::create_dir_all(into).map_err(io(into, "cannot make the folder"))?;

    // From the page, where the folder lies beside or below it.
    let beside = page.parent().unwrap_or(Path::new(""));
    let shown = into.strip_prefix(beside).unwrap_or(into).to_string_lossy().replace('\\', "/");
    let mut files = Vec::new();
    let mut table = Cells::default();
    for (scene, scene_name) in digest.scenes.iter().enumerate() {
        let references = results.study.references.iter().filter(|reference| reference.scene == *scene_name);
        let reference = references.filter_map(|reference| reference.image.as_deref()).next();
        let reference = reference.map(|image| (Some(image), "reference".to_owned(), String::new()));
        let rows = digest.of_scene(scene).map(|row| {
            let image = row.cells.iter().find_map(|cell| cell.images.image.as_deref());
            // What failed stands there with its reason.
            let failure = row.failure().filter(|_| image.is_none()).map(|(error, _)| error.to_owned());
            (image, digest.row_text(row), failure.unwrap_or_else(|| facts(row)))
        });
        let mut display = None;
        for (path, label, facts) in reference.into_iter().chain(rows) {
            let label = if digest.scenes.len() > 1 { format!("{scene_name}, {label}") } else { label };
            let Some(path) = path else {
                table.push(None, &label, &facts);
                continue;
            };
            let refused = |error| damaged(pictures::message(path, &error));
            let image = Image::read(folder.join(path)).map_err(refused)?;
            // That of the reference, or else of the first picture.
            let display = *display.get_or_insert_with(|| exposed_for(path, &image));
            let file = into.join(format!("{}.png", escape::file_name(&label)));
            write(&file, &image.png(display).map_err(refused)?)?;
            table.push(Some(&format!("{shown}/{}.png", escape::file_name(&label))), &label, &facts);
            files.push(file);
        }
    }
    if files.is_empty() {
        return Err(damaged(format!("the study `{name}` in {} has no pictures", folder.display())));
    }
    let study = &results.study;
    let scenes: Vec<String> = digest.scenes.iter().map(|scene| format!("`{scene}`")).collect();
    let section = format!(
        "\n{}, {}×{} pixels, {}. Below each picture the GPU time of a frame and the relMSE against the reference; {}.\n\n{}\n",
        scenes.join(", "),
        study.size.0,
        study.size.1,
        study.budget,
        results.ran_by().join("; "),
        table.html()
    );
    let begin = format!("<!-- gallery: {name} -->");
    let text = between(&text, &begin, &section)
        .ok_or_else(|| damaged(format!("it has no section from `{begin}` to `<!-- end -->`")))?;
    write(page, text.as_bytes())?;
    files.push(page.to_owned());
    Ok(files)
}

/// Time and error of a row.
fn facts(row: &Row<'_>) -> String {
    let text = |value: f64| Measured::new(value, None).text();
    let time = row.time().map(|time| format!("{} ms", text(time.mean)));
    let error = row.summary(ERROR).map(|error| text(error.mean));
    time.into_iter().chain(error).collect::<Vec<_>>().join(", ")
}

/// A table of pictures, in HTML: Markdown's tables have a head.
#[derive(Default)]
struct Cells(Vec<String>);

impl Cells {
    fn push(&mut self, picture: Option<&str>, label: &str, facts: &str) {
        let [label, facts] = [label, facts].map(escape::html);
        let picture = picture.map(|path| {
            format!("<img src=\"{}\" width=\"{WIDTH}\" alt=\"{label}\"><br>", escape::html(path))
        });
        let picture = picture.unwrap_or_default();
        self.0.push(format!("<td>{picture}<sub><code>{label}</code><br>{facts}</sub></td>"));
    }

    fn html(&self) -> String {
        let rows = self.0.chunks(COLUMNS).map(|row| format!("<tr>\n{}\n</tr>\n", row.join("\n")));
        format!("<table>\n{}</table>\n", rows.collect::<String>())
    }
}
