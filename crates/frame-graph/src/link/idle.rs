//! Leaves out passes that are inherited, that nothing needs, and that do not fit what a variant changes.

use super::{Graph, LinkContext, link_all};
use crate::description::{At, Body, Off, PassDecl};
use crate::port::PassTypes;
use crate::resolve::Resolved;
use data_file::Diagnostics;
use std::sync::Arc;

/// How many idle passes are tried one by one: each costs a link of the whole.
const MAX_TRIALS: usize = 64;

/// Returns the inherited passes and sub-graphs that no output and no pass of the file itself needs, whatever is wrong with
/// them: those that are named by no link on the way.
fn idle(resolved: &Resolved) -> Vec<u32> {
    let nodes = &resolved.nodes;
    // The first file is the pipeline's own.
    let is_own = |i: &u32| nodes[*i as usize].place.file == 0;
    let all = || 0..nodes.len() as u32;
    let named = |name: &str| resolved.index.get(name.strip_suffix("/in").unwrap_or(name)).copied();
    let outputs = resolved.outputs.iter().filter_map(|output| named(&output.link.target.pass));
    let mut open: Vec<u32> = outputs.chain(all().filter(is_own)).collect();
    let mut needed = vec![false; nodes.len()];
    while let Some(node) = open.pop() {
        let node = node as usize;
        if std::mem::replace(&mut needed[node], true) {
            continue;
        }
        let decl = &nodes[node].decl;
        let inner = match &decl.body {
            Body::Group(group) => &group.outputs[..],
            _ => &[],
        };
        let instead = match &decl.off {
            Some(At { value: Off::Link(link), .. }) => Some(link),
            _ => None,
        };
        let links = decl.links.iter().chain(&decl.feed).chain(instead);
        let links = links.chain(inner.iter().map(|output| &output.link));
        open.extend(links.filter_map(|link| named(&link.target.pass)).chain(nodes[node].parent));
    }
    all().filter(|i| !needed[*i as usize]).collect()
}

/// Links a description, of which these are the errors, without those of its idle nodes with which it cannot be linked.
pub(super) fn link_without_idle(
    resolved: &Resolved,
    kinds: &dyn PassTypes,
    context: &LinkContext,
    errors: Diagnostics,
) -> Result<Graph, Diagnostics> {
    let mut left_out = idle(resolved);
    if left_out.is_empty() {
        return Err(errors);
    }
    let mut graph = match link_all(&without(resolved, &left_out), kinds, context) {
        Ok(graph) => graph,
        Err(others) => {
            let is_known = others.0.iter().all(|error| errors.0.contains(error));
            return Err(if is_known { others } else { errors });
        }
    };
    for node in left_out.iter().copied().take(MAX_TRIALS).collect::<Vec<_>>() {
        let fewer: Vec<u32> =
            left_out.iter().copied().filter(|other| !is_in(resolved, *other, node)).collect();
        if fewer.len() < left_out.len()
            && let Ok(found) = link_all(&without(resolved, &fewer), kinds, context)
        {
            (left_out, graph) = (fewer, found);
        }
    }
    let passes = left_out.into_iter().map(|node| &resolved.nodes[node as usize]);
    let passes = passes.filter(|node| matches!(node.decl.body, Body::Pass { .. }));
    Ok(Graph { left_out: passes.map(|node| node.name.clone()).collect(), ..graph })
}

/// Returns whether a node is another one, or in that sub-graph.
fn is_in(resolved: &Resolved, mut node: u32, whole: u32) -> bool {
    while node != whole {
        let Some(parent) = resolved.nodes[node as usize].parent else { return false };
        node = parent;
    }
    true
}

/// Returns a description without these nodes.
fn without(resolved: &Resolved, nodes: &[u32]) -> Resolved {
    let mut fewer = resolved.clone();
    for node in nodes {
        fewer.nodes[*node as usize].decl = Arc::new(PassDecl::new(Body::Removed));
    }
    fewer
}
