//! The progress of a study, on standard error: a bar on a terminal, lines elsewhere.

use crate::output::stderr;
use data_file::visible;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;
use study::{Event, Outcome, Step, name_of};

pub(crate) struct Progress {
    /// `None` off a terminal.
    bar: Option<ProgressBar>,
    cells: usize,
    /// The estimate of the remaining time, in words; empty as long as there is none.
    left: String,
}

impl Progress {
    pub(crate) fn new() -> Progress {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{pos}/{len} {bar:24} {msg}");
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Progress { bar, cells: 0, left: String::new() }
    }

    pub(crate) fn report(&mut self, event: Event<'_>) {
        match event {
            Event::Begin { cells, finished, stale } => {
                self.cells = cells;
                if let Some(bar) = &self.bar {
                    bar.set_length(cells as u64);
                    bar.set_position(finished as u64);
                }
                if finished > 0 {
                    self.line(&format!("{finished} of {cells} cells are finished already"));
                }
                if stale > 0 {
                    self.line(&format!("{stale} cells in the folder belong to another version of this study; they stay there and are not reported"));
                }
            }
            Event::Reference { name } => match &self.bar {
                Some(_) => self.message(&format!("reference of {name}")),
                None => stderr!("reference of {name}"),
            },
            // Lines would depend on how fast the machine is.
            Event::Step { name, frame, frames, step } => {
                self.message(&step_text(name, (frame, frames), step));
            }
            Event::Cell { name } => self.message(&name),
            Event::Ended { cell, ended, left } => {
                let left = if ended < self.cells {
                    format!("about {} left", HumanDuration(left))
                } else {
                    "done".to_owned()
                };
                if let Outcome::Failed { error } = &cell.outcome {
                    self.line(&format!("failed  {}: {error}", name_of(cell)));
                }
                for note in &cell.notes {
                    self.line(&format!("note: {}: {note}", name_of(cell)));
                }
                match &self.bar {
                    Some(bar) => {
                        bar.set_position(ended as u64);
                        self.left = format!("{left}: ");
                    }
                    None => {
                        stderr!("{ended}/{} {} in {:.1} s, {left}", self.cells, name_of(cell), cell.seconds);
                    }
                }
            }
            Event::Note(note) => self.line(&format!("note: {note}")),
        }
    }

    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Shows what runs beside the bar, if there is one.
    fn message(&self, text: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{}{}", self.left, visible(text)));
        }
    }

    /// Prints a line that stays.
    fn line(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| stderr!("{text}")),
            None => stderr!("{text}"),
        }
    }
}

/// `reference of walk at 512x512, frame 2 of 8: 96 of at most 1024 steps, relMSE about 2.1e-3`.
fn step_text(name: &str, (frame, frames): (usize, usize), step: Step) -> String {
    let of = if frames > 1 { format!(", frame {frame} of {frames}") } else { String::new() };
    let noise = step.noise.map(|noise| format!(", relMSE about {noise:.1e}")).unwrap_or_default();
    format!("reference of {name}{of}: {} of at most {} steps{noise}", step.step, step.steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_reference_are_reported() {
        let step = Step { step: 96, steps: 1024, noise: Some(0.0021) };
        assert_eq!(
            step_text("walk at 8x8", (2, 8), step),
            "reference of walk at 8x8, frame 2 of 8: 96 of at most 1024 steps, relMSE about 2.1e-3"
        );
        let step = Step { noise: None, ..step };
        assert_eq!(
            step_text("box at 8x8", (1, 1), step),
            "reference of box at 8x8: 96 of at most 1024 steps"
        );
    }
}
