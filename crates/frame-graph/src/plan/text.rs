//! The plan as text.

use super::{Begins, Fate, Plan, PlannedPass};
use crate::resource::human_bytes;
use std::fmt::Write as _;

pub(super) fn text(plan: &Plan) -> String {
    let mut out =
        format!("plan {}, {}×{}, {} passes\n", plan.id, plan.frame.0, plan.frame.1, plan.passes.len());
    for (i, pass) in plan.passes.iter().enumerate() {
        write_pass(&mut out, plan, i, pass);
    }
    out.push_str("outputs\n");
    for output in &plan.outputs {
        let _ = writeln!(out, "  {} from {}: {}", output.name, output.from, output.interface);
    }
    let others: Vec<_> = plan.fates.iter().filter(|(_, fate)| !matches!(fate, Fate::Kept { .. })).collect();
    if !others.is_empty() {
        out.push_str("not run\n");
        for (name, fate) in others {
            let _ = writeln!(out, "  {name}: {fate}");
        }
    }
    if !plan.histories.is_empty() {
        out.push_str("kept for the next frame\n");
        for history in &plan.histories {
            let reset: Vec<String> = history.reset.iter().map(ToString::to_string).collect();
            let name = &plan.resources[history.resource.0 as usize].name;
            let rest = history
                .rest
                .map_or_else(String::new, |frames| format!("; rests after {frames} still frames"));
            let waits = if history.catches_up { "; waits while a picture settles" } else { "" };
            let _ = writeln!(out, "  {name}, reset by {}{rest}{waits}", reset.join(", "));
        }
    }
    let _ = writeln!(out, "memory\n  {}", plan.memory);
    out
}

fn write_pass(out: &mut String, plan: &Plan, at: usize, pass: &PlannedPass) {
    let shader = pass.shader.as_ref().map_or_else(String::new, |shader| format!(" {shader}"));
    let _ = writeln!(out, "{at:4} {}: {}{shader}", pass.name, pass.kind);
    if let Some((_, fate)) = plan.fates.iter().find(|(name, _)| *name == pass.name) {
        let _ = writeln!(out, "       {fate}");
    }
    for input in &pass.inputs {
        let names: Vec<&str> =
            input.members.iter().map(|(_, id)| &*plan.resources[id.0 as usize].name).collect();
        let past = if input.history.is_some() { "the history buffer of " } else { "" };
        let _ = writeln!(out, "       reads {} = {past}{}", input.port, names.join(", "));
    }
    for port in &pass.outputs {
        for (_, id) in &port.members {
            let resource = &plan.resources[id.0 as usize];
            let verb = if port.interface.is_empty() { "scratch" } else { "writes" };
            let object = if resource.persistent { " kept" } else { "" };
            let _ = writeln!(
                out,
                "       {verb} {}: {}, {}, object {}{object}",
                resource.name,
                resource.desc,
                human_bytes(resource.desc.bytes()),
                resource.allocation.0
            );
        }
        let ids = port.members.iter().map(|(_, id)| *id);
        for continued in pass.continues.iter().filter(|c| ids.clone().any(|id| id == c.resource)) {
            let name = |id: super::ResourceId| plan.resources[id.0 as usize].name.clone();
            let past = |history: super::HistoryId| name(plan.histories[history.0 as usize].resource);
            let from = match continued.from {
                Begins::InPlace(_) => "its own past, in place".to_owned(),
                Begins::CopyOfPast(history) => format!("a copy of the history buffer of {}", past(history)),
                Begins::Copy(id) => format!("a copy of {}", name(id)),
            };
            let _ = writeln!(out, "       continues {} as {from}", name(continued.resource));
        }
        for (member, id) in &port.handed {
            let dot = if member.is_empty() { "" } else { "." };
            let from = &plan.resources[id.0 as usize].name;
            let _ = writeln!(out, "       hands on {}.{}{dot}{member} = {from}", pass.name, port.port);
        }
    }
}
