//! Finds the greatest value of a fact that every pass takes, for advice where one refuses a greater one.

use super::answers::Answers;
use super::sizes::Unknown;
use super::{Described, Linker};
use crate::port::{Limit, PassTypeError};
use data_file::Value;
use std::sync::Arc;

/// How often a lower value is tried.
const MAX_TRIALS: usize = 16;

impl Linker<'_> {
    /// Returns the error of a pass with advice for which no pass refuses its input for the same reason: the limits of the
    /// passes that follow, and of those that read the same output, are taken into account.
    pub(super) fn advised(
        &self,
        node: usize,
        error: PassTypeError,
        order: &[u32],
        ports: &[Described],
    ) -> PassTypeError {
        let Some(limit) = error.limit.as_deref().filter(|limit| limit.most > 0) else { return error };
        let (mut most, mut by) = (limit.most, node);
        for _ in 0..MAX_TRIALS {
            let refused = self.refusals(node, &Limit { most, ..limit.clone() }, order, ports);
            let lower =
                refused.into_iter().filter(|(_, other)| other.what == limit.what && other.most < most);
            let Some((other, lowest)) = lower.min_by_key(|(_, other)| other.most) else { break };
            (most, by) = (lowest.most, other);
        }
        if most == 0 {
            return error;
        }
        let else_ = error.help.as_ref().map_or_else(String::new, |help| format!("{help}, or "));
        let mut advice = format!("{else_}at most {most} {}", limit.what);
        if by != node {
            advice.push_str(&format!(", since `{}` takes no more", self.nodes[by].name));
        }
        error.help(advice)
    }

    /// Returns the limits for which passes refuse their inputs if the output that an input of `node` reads had the fact at
    /// its limit.
    fn refusals(
        &self,
        node: usize,
        limit: &Limit,
        order: &[u32],
        ports: &[Described],
    ) -> Vec<(usize, Limit)> {
        let Some(used) = &self.uses[node] else { return Vec::new() };
        let wire = self.describing_wires(node).iter();
        let mut wire = wire.filter(|wire| used.names.inputs[wire.input as usize].0 == limit.input.as_str());
        let Some(end) = wire.next().map(|wire| wire.end) else { return Vec::new() };
        let producer = end.node as usize;
        let Some(mut lowered) = ports[producer].as_ref().map(|described| described.to_vec()) else {
            return Vec::new();
        };
        let facts = Arc::make_mut(&mut lowered[end.port as usize].facts);
        facts.insert(limit.fact, Value::U32(limit.most));
        let mut ports = ports.to_vec();
        ports[producer] = Some(lowered.into());
        let mut answers = Answers::default();
        let mut limits = Vec::new();
        for i in order.iter().map(|i| *i as usize).filter(|i| *i != producer) {
            let Some(question) = self.question(i, &ports) else { continue };
            match self.answer(i, question, &ports, &mut answers) {
                Ok(found) => ports[i] = Some(found),
                Err(Unknown::Refused(error)) if self.is_on(i) => {
                    limits.extend(error.limit.map(|limit| (i, *limit)));
                }
                Err(_) => {}
            }
        }
        limits
    }
}
