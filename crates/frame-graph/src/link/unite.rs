//! One graph that computes what several graphs do, in which what is equal in them runs once.

use super::{Graph, GraphLink, GraphOutput, GraphPass, LinkSource};
use data_file::Name;
use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;
use rustc_hash::{FxHashMap, FxHashSet};

/// Separates the name of a pass from the number of a copy.
const COPY: char = '#';

/// What tells two passes of a class apart: the class, then each link with the class of its producer.
type Signature = (u32, Vec<(Name, u32, u32, Option<u32>, bool, bool)>);

/// Returns the name that a pass, or an output, has in the graph that it comes from: without the number of its copy.
pub fn original_name(name: &str) -> &str {
    name.split_once(COPY).map_or(name, |(name, _)| name)
}

/// Returns the name of an output of a graph of [`unite`], by the index of the graph that it comes from.
pub fn name_in_united(output: &str, graph: usize) -> String {
    if graph == 0 { output.to_owned() } else { format!("{output}{COPY}{graph}") }
}

/// Returns one graph that computes what several variants of a pipeline do.
///
/// Passes of the same name are one where their types, settings and all that they read are equal, through history buffers too.
/// Of others there are copies: `gather`, `gather#1`, …, which have the same random numbers. The outputs of the first graph keep
/// their names; of the others they are named by [`name_in_united`].
pub fn unite(graphs: &[Graph]) -> Graph {
    let classes = classes(graphs);
    let mut united = Graph { passes: DiGraph::new(), outputs: Vec::new(), ..graphs[0].clone() };
    let mut names: FxHashSet<Name> = FxHashSet::default();
    let mut of_class: FxHashMap<u32, NodeIndex> = FxHashMap::default();
    let mut added = Vec::new();
    for (graph, classes) in graphs.iter().zip(&classes) {
        for pass in graph.passes.node_indices() {
            of_class.entry(classes[pass.index()]).or_insert_with(|| {
                let node = &graph.passes[pass];
                let copies = (1..).map(|copy| Name::from(format!("{}{COPY}{copy}", node.name)));
                let mut free = std::iter::once(node.name.clone()).chain(copies);
                let name = free.find(|name| names.insert(name.clone())).unwrap_or_default();
                added.push((graph, classes, pass));
                united.passes.add_node(GraphPass { name, ..node.clone() })
            });
        }
    }
    let place = |classes: &[u32], source: &LinkSource| LinkSource {
        pass: of_class[&classes[source.pass.index()]],
        ..*source
    };
    for (graph, classes, pass) in added {
        // petgraph lists the newest edge first.
        let links: Vec<_> = graph.passes.edges_directed(pass, Incoming).collect();
        for link in links.into_iter().rev() {
            let from = place(classes, &link.weight().from);
            let producer = of_class[&classes[link.source().index()]];
            let reader = of_class[&classes[pass.index()]];
            united.passes.add_edge(producer, reader, GraphLink { from, ..link.weight().clone() });
        }
    }
    for (index, (graph, classes)) in graphs.iter().zip(&classes).enumerate() {
        united.outputs.extend(graph.outputs.iter().map(|output| GraphOutput {
            name: Name::from(name_in_united(&output.name, index)),
            from: place(classes, &output.from),
        }));
    }
    united
}

/// Returns a number for each pass of each graph: equal ones for passes that compute the same. Passes are taken as equal as long
/// as nothing tells them apart, so that loops through history buffers are compared too.
fn classes(graphs: &[Graph]) -> Vec<Vec<u32>> {
    let mut of_name: FxHashMap<&Name, Vec<(&GraphPass, u32)>> = FxHashMap::default();
    let mut count = 0;
    let mut classes: Vec<Vec<u32>> = Vec::with_capacity(graphs.len());
    for graph in graphs {
        let class = graph.passes.node_weights().map(|pass| {
            let known = of_name.entry(&pass.name).or_default();
            if let Some((_, class)) = known.iter().find(|(other, _)| is_same(other, pass)) {
                return *class;
            }
            known.push((pass, count));
            count += 1;
            count - 1
        });
        classes.push(class.collect());
    }
    loop {
        let mut signatures: FxHashMap<Signature, u32> = FxHashMap::default();
        let mut next = Vec::with_capacity(graphs.len());
        for (graph, classes) in graphs.iter().zip(&classes) {
            let refined = graph.passes.node_indices().map(|pass| {
                let mut links: Vec<_> = graph.passes.edges_directed(pass, Incoming).collect();
                links.sort_by(|a, b| a.weight().port.cmp(&b.weight().port));
                let links = links.into_iter().map(|link| {
                    let GraphLink { port, from, past } = link.weight();
                    (port.clone(), classes[link.source().index()], from.port, from.member, from.bare, *past)
                });
                let signature = (classes[pass.index()], links.collect());
                let fresh = signatures.len() as u32;
                *signatures.entry(signature).or_insert(fresh)
            });
            next.push(refined.collect());
        }
        let stable = signatures.len() as u32 == count;
        count = signatures.len() as u32;
        classes = next;
        if stable {
            return classes;
        }
    }
}

/// Whether two passes are equal, but for what they read.
fn is_same(a: &GraphPass, b: &GraphPass) -> bool {
    a.kind == b.kind
        && a.shader == b.shader
        && a.settings == b.settings
        && a.overrides == b.overrides
        && a.history == b.history
        && a.outputs == b.outputs
        && a.off.is_some() == b.off.is_some()
}
