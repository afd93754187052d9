//! Inserts results into pages of documentation: sections that are generated, not written by hand.

use crate::description::SIZE;
use crate::error::{StudyError, io};
use crate::folder::write;
use crate::record::{Outcome, Results};
use crate::report;
use crate::report::distinct;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const END: &str = "<!-- end -->";

const STUDY: &str = "<!-- study: ";

fn begin(name: &str) -> String {
    format!("{STUDY}{name} -->")
}

/// Writes the results of studies to pages of Markdown in a folder: that of each to `NAME.md`, between `<!-- study: NAME -->`
/// and `<!-- end -->`; if the page has no such section, it is added at the end. The rest of the page stays as it is. Also
/// writes the reports of the studies again. Returns the pages.
///
/// # Errors
/// Fails for folders that are not studies, for a section without its end, and if a file cannot be written.
pub fn publish(folders: &[PathBuf], pages: &Path) -> Result<Vec<PathBuf>, StudyError> {
    std::fs::create_dir_all(pages).map_err(io(pages, "cannot make the folder"))?;
    let one = |folder: &PathBuf| {
        let results = Results::read(folder)?;
        let page = pages.join(format!("{}.md", results.study.name));
        let text = match std::fs::read_to_string(&page) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(io(&page, "cannot read")(error)),
        };
        let mut tables = Vec::new();
        for file in report(&results, folder)? {
            if file.extension().is_some_and(|extension| extension == "md") {
                tables.push(std::fs::read_to_string(&file).map_err(io(&file, "cannot read"))?);
            }
        }
        let name = &results.study.name;
        let text = replaced(&text, name, &section(&results, &tables)).ok_or_else(|| {
            let reason = format!("`{}` has no `{END}`", begin(name));
            StudyError::Damaged { path: page.clone(), reason }
        })?;
        write(&page, text.as_bytes())?;
        Ok(page)
    };
    folders.iter().map(one).collect()
}

/// Returns the page with the content of the section `name` replaced; `None` if that section has no end.
fn replaced(page: &str, name: &str, section: &str) -> Option<String> {
    let begin = begin(name);
    if !page.contains(&begin) {
        let gap = if page.is_empty() || page.ends_with("\n\n") { "" } else { "\n" };
        return Some(format!("{page}{gap}{begin}\n{section}{END}\n"));
    }
    between(page, &begin, section)
}

/// Returns the page with what stands between a line and the next `<!-- end -->` replaced; `None` if there is none, or it is that of a
/// section after.
pub(crate) fn between(page: &str, begin: &str, section: &str) -> Option<String> {
    let (before, rest) = page.split_once(begin)?;
    let next = rest.find(STUDY);
    let end = rest.find(END).filter(|end| next.is_none_or(|next| *end < next))?;
    Some(format!("{before}{begin}\n{section}{}", &rest[end..]))
}

fn section(results: &Results, tables: &[String]) -> String {
    let study = &results.study;
    let mut text = format!("\n# {}\n\n{}", study.heading(), study.about);
    if !study.paper.is_empty() {
        let _ = write!(text, " ({})", study.paper);
    }
    let adapters = results.ran_by().join("; ");
    let _ = write!(text, ".\n\n{adapters}; Lightloom {}; begun {}. ", study.version, study.started);
    if !study.output.is_empty() && !study.axes.iter().any(|axis| axis.name == SIZE) {
        let _ = write!(text, "Frames of {}×{} pixels. ", study.size.0, study.size.1);
    }
    let _ = write!(text, "A cell: {}.", study.budget);
    if study.seeds.len() > 1 {
        let _ = write!(text, " Mean and 95 % interval over {} seeds.", study.seeds.len());
    }
    text.push('\n');
    for reference in &study.references {
        let _ = write!(text, "\n- Reference of `{}`: {}", reference.scene, reference.from);
        let _ = match (&reference.image, reference.noise) {
            (None, _) => write!(text, "; it failed: {}", reference.error.lines().next().unwrap_or_default()),
            (Some(_), Some(noise)) => write!(text, "; its own relMSE is estimated at {noise:.1e}"),
            (Some(_), None) => Ok(()),
        };
    }
    if !study.references.is_empty() {
        text.push('\n');
    }
    if !study.command.is_empty() {
        let _ = write!(text, "\n```sh\n{}\n```", study.command);
    }
    text.push('\n');
    for table in tables {
        let _ = write!(text, "\n{}\n", table.trim_end());
    }
    let missing = study.cell_count.saturating_sub(results.cells.len());
    if missing > 0 {
        let _ = write!(text, "\n{missing} of {} cells have not been run.\n", study.cell_count);
    }
    let notes = distinct(results.cells.iter().flat_map(|cell| {
        let failure = match &cell.outcome {
            Outcome::Failed { error } => Some(error),
            Outcome::Done => None,
        };
        cell.notes.iter().chain(failure)
    }));
    if !notes.is_empty() {
        text.push('\n');
    }
    for note in notes {
        let _ = writeln!(text, "- {}", note.lines().next().unwrap_or_default());
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::replaced;

    #[test]
    fn only_the_section_changes() {
        let page = "# Results\n\nBy hand.\n\n<!-- study: a -->\nold\n<!-- end -->\n\n<!-- study: b -->\nkept\n<!-- end -->\n";
        let page = replaced(page, "a", "new\n").unwrap();
        assert_eq!(
            page,
            "# Results\n\nBy hand.\n\n<!-- study: a -->\nnew\n<!-- end -->\n\n<!-- study: b -->\nkept\n<!-- end -->\n"
        );
        assert_eq!(replaced(&page, "a", "new\n").unwrap(), page, "twice is once");
        let added = replaced("By hand.\n", "c", "new\n").unwrap();
        assert_eq!(added, "By hand.\n\n<!-- study: c -->\nnew\n<!-- end -->\n");
        let open = "<!-- study: a -->\n<!-- study: b -->\n<!-- end -->\n";
        assert_eq!(replaced(open, "a", ""), None);
    }
}
