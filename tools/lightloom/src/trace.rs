//! Traces what the program does over time: into a file in Chrome's trace format (`--trace`), and to Tracy (feature `tracy`).
//!
//! Spans of two targets are traced: phases of the start (`start.rs`), and `frame`: frames, and the passes that each
//! encodes.

use anyhow::{Context as _, Result};
use std::fmt;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id};
use tracing::{Metadata, Subscriber};
use tracing_chrome::{ChromeLayerBuilder, EventOrSpan, FlushGuard};
use tracing_subscriber::Layer;
use tracing_subscriber::filter::{FilterFn, filter_fn};
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;
use whole_file::Unfinished;

/// The target of the spans of frames.
const FRAME: &str = "frame";

/// A trace that is being written. Its file gets its name by [`Trace::finish`].
pub(crate) struct Trace {
    guard: FlushGuard,
    part: Unfinished,
    path: PathBuf,
    error: FirstError,
}

/// The first error of the thread that writes.
type FirstError = Arc<Mutex<Option<io::Error>>>;

/// The writer of the layer, which panics if a writer fails: so the first error is kept, and what follows is dropped.
struct Writer {
    file: File,
    error: FirstError,
}

impl Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut first = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        if first.is_none() {
            *first = self.file.write_all(bytes).err();
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Trace {
    /// Writes what is left, and gives the file its name.
    ///
    /// # Errors
    /// Fails if the file could not be written; there is no file then.
    pub(crate) fn finish(self) -> Result<()> {
        let Trace { guard, part, path, error } = self;
        // Waits for the thread that writes.
        drop(guard);
        let error = error.lock().unwrap_or_else(PoisonError::into_inner).take();
        error.map_or_else(|| part.finish(), Err).with_context(|| unwritten(&path))
    }
}

fn unwritten(path: &Path) -> String {
    format!("the trace {} cannot be written", path.display())
}

/// Begins the file, and creates the layer that writes into it.
///
/// # Errors
/// Fails if the file cannot be created.
pub(crate) fn to_file<S>(path: &Path) -> Result<(impl Layer<S> + use<S>, Trace)>
where
    S: Subscriber + for<'a> LookupSpan<'a> + Send + Sync,
{
    let begin = || {
        let part = Unfinished::of(path)?;
        Ok::<_, io::Error>((part.file().try_clone()?, part))
    };
    let (file, part) = begin().with_context(|| unwritten(path))?;
    let error = FirstError::default();
    let writer = Writer { file, error: Arc::clone(&error) };
    let name = |span: &EventOrSpan<'_, '_, S>| match span {
        EventOrSpan::Span(span) => {
            let pass = span.extensions().get::<PassName>().map(|PassName(name)| name.clone());
            pass.unwrap_or_else(|| span.name().to_owned())
        }
        EventOrSpan::Event(event) => event.metadata().name().to_owned(),
    };
    let builder = ChromeLayerBuilder::new().writer(writer).include_args(true).include_locations(false);
    let (layer, guard) = builder.name_fn(Box::new(name)).build();
    let trace = Trace { guard, part, path: path.to_owned(), error };
    Ok((PassNames.and_then(layer).with_filter(traced()), trace))
}

/// Creates the layer that sends to Tracy's profiler, if that is connected.
#[cfg(feature = "tracy")]
pub(crate) fn to_tracy<S>() -> impl Layer<S>
where
    S: Subscriber + for<'a> LookupSpan<'a>,
{
    tracing_tracy::TracyLayer::default().with_filter(traced())
}

/// Returns the filter of the spans that are traced.
fn traced() -> FilterFn<fn(&Metadata<'_>) -> bool> {
    filter_fn(|metadata| metadata.is_span() && [crate::start::TARGET, FRAME].contains(&metadata.target()))
}

/// The name of the pass that a span is about.
struct PassName(String);

/// Finds the names of passes in the fields of spans, so that a timeline shows them, and not one name for all.
struct PassNames;

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for PassNames {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        let mut find = FindPass(None);
        attributes.record(&mut find);
        if let (Some(name), Some(span)) = (find.0, context.span(id)) {
            span.extensions_mut().insert(name);
        }
    }
}

/// Reads the field `pass`.
struct FindPass(Option<PassName>);

impl Visit for FindPass {
    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "pass" {
            self.0 = Some(PassName(value.to_owned()));
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn fmt::Debug) {}
}
