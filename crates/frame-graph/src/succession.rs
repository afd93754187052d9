//! What continues when one plan replaces another.

use crate::frame::ResetCause;
use crate::plan::{HistoryId, PassId, Plan, PlannedInput, PlannedPass};
use rustc_hash::FxHashMap;

/// What a plan has in common with the one before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Succession {
    /// One entry per history buffer of the new plan: the history buffer of the old plan that it continues, or why it is
    /// reset.
    pub histories: Vec<Result<HistoryId, ResetCause>>,
    /// The passes of the new plan that are new, of another pass type, with other settings or another shader file, or
    /// that link to something else. A changed shader file is not noticed here.
    pub changed: Vec<PassId>,
}

impl Succession {
    /// Compares a plan with the one that it replaces. History buffers continue where their names and descriptions are
    /// the same, whatever else differs; their own `reset:` says what resets them.
    pub fn between(old: &Plan, new: &Plan) -> Succession {
        let name =
            |plan: &'_ Plan, h: usize| plan.resources[plan.histories[h].resource.0 as usize].name.clone();
        let known: FxHashMap<_, usize> = (0..old.histories.len()).map(|h| (name(old, h), h)).collect();
        let follow = |h: usize| {
            let Some(before) = known.get(&name(new, h)).copied() else { return Err(ResetCause::Reload) };
            let (a, b) = (&old.histories[before], &new.histories[h]);
            let desc = |plan: &Plan, id: crate::plan::ResourceId| plan.resources[id.0 as usize].desc.clone();
            if desc(old, a.resource) != desc(new, b.resource) {
                // With another frame it is the frame that gave it another size.
                let resized = old.frame != new.frame;
                return Err(if resized { ResetCause::Resize } else { ResetCause::Reload });
            }
            Ok(HistoryId(before as u32))
        };
        let passes: FxHashMap<_, &PlannedPass> = old.passes.iter().map(|pass| (&pass.name, pass)).collect();
        let is_changed = |pass: &PlannedPass| {
            passes.get(&pass.name).is_none_or(|before| !same_pass(old, before, new, pass))
        };
        let changed = new.passes.iter().enumerate().filter(|(_, pass)| is_changed(pass));
        Succession {
            changed: changed.map(|(i, _)| PassId(i as u32)).collect(),
            histories: (0..new.histories.len()).map(follow).collect(),
        }
    }
}

fn same_pass(old: &Plan, a: &PlannedPass, new: &Plan, b: &PlannedPass) -> bool {
    a.kind == b.kind
        && a.shader == b.shader
        && a.settings == b.settings
        && a.overrides == b.overrides
        && a.inputs.len() == b.inputs.len()
        && a.inputs.iter().zip(&b.inputs).all(|(a, b)| same_input(old, a, new, b))
}

/// Returns whether two inputs link to the same, by name.
fn same_input(old: &Plan, a: &PlannedInput, new: &Plan, b: &PlannedInput) -> bool {
    let producer = |plan: &'_ Plan, input: &PlannedInput| plan.passes[input.producer.0 as usize].name.clone();
    let member = |plan: &'_ Plan, (name, id): &(data_file::Name, crate::plan::ResourceId)| {
        let resource = &plan.resources[id.0 as usize];
        (name.clone(), resource.name.clone())
    };
    a.port == b.port
        && a.interface == b.interface
        && a.producer_port == b.producer_port
        && a.history.is_some() == b.history.is_some()
        && producer(old, a) == producer(new, b)
        && a.members.len() == b.members.len()
        && a.members.iter().zip(&b.members).all(|(a, b)| member(old, a) == member(new, b))
}
