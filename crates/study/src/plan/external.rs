//! Checks the commands of external programs.

use super::Resolved;
use super::check::Checker;
use crate::codes;
use crate::description::{At, Budget, Variant};
use crate::external::{External, Misfit, PLACEHOLDERS};
use crate::laboratory::PipelineFacts;
use crate::record::PipelineRecord;
use frame_graph::Span;
use std::collections::BTreeMap;

impl Checker<'_> {
    /// Returns the row of a program. What is wrong with its command is reported.
    pub(super) fn external(&mut self, variant: &Variant, external: &External) -> Resolved {
        let command = &variant.pipeline;
        match external.placeholders() {
            Err(misfit) => self.misfit(command, misfit),
            Ok(names) => self.budget_of(command, &names),
        }
        let record = PipelineRecord {
            name: variant.name.value.clone(),
            pipeline: command.value.clone(),
            about: "the program of another renderer".to_owned(),
            paper: String::new(),
            set: BTreeMap::new(),
        };
        let facts = PipelineFacts::default();
        Resolved { record, facts, set: Vec::new(), external: Some(external.clone()) }
    }

    /// Reports a command whose text is wrong.
    fn misfit(&mut self, command: &At<String>, misfit: Misfit) {
        let known = PLACEHOLDERS.iter().map(|(name, _)| *name);
        let error = match misfit {
            Misfit::Empty => command.error(&codes::COMMAND, "there is no command"),
            Misfit::OpenQuote => command.error(&codes::COMMAND, "a quotation mark is not closed"),
            Misfit::OpenBrace => {
                let error = command.error(&codes::COMMAND, "a brace stands alone");
                error.note("`{{` and `}}` are braces, and `{out}` is a placeholder")
            }
            Misfit::Unknown(name) => {
                let at = At { span: part(command, &format!("{{{name}}}")), value: name };
                let message = format!("there is no placeholder `{{{}}}`", at.value);
                at.unknown(&codes::COMMAND, message, "placeholders", known)
                    .note("`{{` and `}}` are braces of the command itself")
            }
        };
        self.errors.push(error);
    }

    /// Checks that a command takes what the study gives it.
    fn budget_of(&mut self, command: &At<String>, names: &[String]) {
        let has = |name: &str| names.iter().any(|known| known == name);
        if !has("out") {
            let error = command.error(&codes::COMMAND, "the command lacks `{out}`, the file to write");
            self.errors.push(error);
        }
        match &self.study.budget {
            Budget::Time { by: None, .. } if has("frames") => {
                let message = "time is spent over frames of a still picture, of which the program writes one";
                let error = command.error(&codes::BUDGET, message);
                self.errors.push(error.label(part(command, "{frames}"), "asks for their number"));
            }
            Budget::Time { .. } if !has("seconds") => {
                let message = "a budget of time needs `{seconds}` in the command";
                let error = command.error(&codes::BUDGET, message);
                self.errors.push(error.note("with it, the program knows the time that a frame may take"));
            }
            Budget::Frames(_) | Budget::Lights { .. } if has("seconds") => {
                let error = command.error(&codes::BUDGET, "the budget of this study is none of time");
                let error = error.label(part(command, "{seconds}"), "has no value");
                self.errors.push(error.note("write `budget: Time(ms: …)`"));
            }
            _ => {}
        }
    }
}

/// Returns the place of a part of a command, or of all of it where its text is written in another way.
fn part(command: &At<String>, part: &str) -> Span {
    let span = &command.span;
    let text = span.source.text.get(span.start as usize..span.end as usize).unwrap_or_default();
    let at = text.find(part).map(|at| span.start + at as u32);
    at.map_or_else(|| span.clone(), |start| Span { start, end: start + part.len() as u32, ..span.clone() })
}
