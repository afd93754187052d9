//! A laboratory that renders nothing: it reads frames.

use super::Row;
use super::files::Sequence;
use metrics::{Image, decode, read_attributes};
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use study::{CellRun, Failure, Laboratory, Observed, Occluded, RunRequest, Step};
use xxhash_rust::xxh3::xxh3_128;

pub(super) struct FileLaboratory<'a> {
    pub(super) rows: &'a [Row],
    pub(super) reference: &'a Sequence,
}

impl FileLaboratory<'_> {
    /// Returns the row of a request; that of the reference has none.
    fn row(&self, request: &RunRequest) -> Option<&Row> {
        self.rows.iter().find(|row| row.name == request.pipeline && request.output.is_empty())
    }
}

impl Laboratory for FileLaboratory<'_> {
    fn adapter(&self) -> String {
        "files".to_owned()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        let row = self.row(request);
        let files: Vec<&PathBuf> = match row {
            Some(row) => row.runs.iter().flat_map(|run| &run.files).collect(),
            None => self.reference.files.iter().collect(),
        };
        let mut text = format!("{:?}", row.map(|row| &row.ms));
        for file in files {
            let bytes = decode::read_file(file).map_err(|error| unreadable(file, error))?;
            let _ = write!(text, " {:032x}", xxh3_128(&bytes));
        }
        Ok(xxh3_128(text.as_bytes()))
    }

    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        _: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        let row = self.row(request);
        let frames = row.map_or(self.reference, |row| &row.runs[request.seed as usize - 1]);
        for (index, (number, file)) in (frames.first()..).zip(&frames.files).enumerate() {
            let image = Image::read(file)?;
            if (image.width() as u32, image.height() as u32) != request.size {
                let ((width, height), found) = (request.size, (image.width(), image.height()));
                let message = format!(
                    "{}: it is {}x{}; the first picture of the reference is {width}x{height}",
                    file.display(),
                    found.0,
                    found.1
                );
                return Err(Failure::render(message));
            }
            let ms = row.and_then(|row| row.ms.get(index));
            let passes = ms.map(|ms| ("given time".to_owned(), *ms)).into_iter().collect();
            observe(Observed { passes, ..Observed::picture(number, image) })?;
        }
        let says = read_attributes(&frames.files[0])?;
        let provenance = json!({
            "external": frames.path,
            "first": frames.files[0],
            "count": frames.files.len(),
            "file says": says,
            "version": env!("CARGO_PKG_VERSION"),
        });
        Ok(CellRun { provenance: provenance.to_string(), ..CellRun::default() })
    }

    fn occluded(&mut self, _: &str, _: u32) -> Result<Occluded, Failure> {
        Err(Failure::render("frames of another engine have no scene"))
    }
}

fn unreadable(file: &Path, source: std::io::Error) -> Failure {
    Failure::Read { file: file.display().to_string(), source: source.into() }
}
