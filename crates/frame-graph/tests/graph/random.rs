//! Random graphs: what must hold of any plan.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use super::naive::{Naive, Revisions, scheduled};
use frame_graph::plan::{Fate, Plan, ResourceId};
use frame_graph::{
    Change, CompileOptions, FrameState, LinkContext, Overrides, ResetCause, ResourceDesc, SceneBindings,
    compile, link, resolve,
};
use proptest::prelude::*;
use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;

/// A pass: its pass type, what it reads (by distance back, or forward through the past), its size.
#[derive(Clone, Debug)]
struct Drawn {
    source: usize,
    reads: Vec<(usize, bool)>,
    scale: u32,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let reads = prop::collection::vec((any::<prop::sample::Index>(), prop::bool::weighted(0.15)), 0..4);
    (0..5usize, reads, 1..4u32).prop_map(|(source, reads, scale)| Drawn {
        source,
        reads: reads.into_iter().map(|(index, past)| (index.index(1 << 16), past)).collect(),
        scale,
    })
}

/// Which history buffers rest: none, or those of some passes.
#[derive(Clone, Copy, PartialEq)]
enum Rest {
    None,
    Some,
}

/// Whether a pass hands on what it reads first, where that is of this frame.
fn hands_on(passes: &[Drawn], at: usize) -> bool {
    let pass = &passes[at];
    at > 0 && pass.source < 2 && pass.reads.first().is_some_and(|(_, past)| !past)
}

/// The text of a pipeline. Sources read scene bindings; other passes are `fullscreen` ones, which take
/// any inputs. Every pass reads only earlier ones, but for the past, so that it is valid.
fn text(passes: &[Drawn], outputs: &[usize], blank: &str, rest: Rest) -> String {
    let mut out = format!("Pipeline({blank}passes: {{");
    for (i, pass) in passes.iter().enumerate() {
        let mut links: Vec<String> = pass
            .reads
            .iter()
            .enumerate()
            .filter_map(|(input, (at, past))| match past {
                true => Some(format!("\"i{input}\": \"prev p{}\"", at % passes.len())),
                false if i > 0 => Some(format!("\"i{input}\": \"p{}\"", at % i)),
                false => None,
            })
            .collect();
        let size = format!("(64, {})", 16 * pass.scale);
        let rest = if rest == Rest::Some && i % 3 == 1 { ", rest: 2, catches_up: true" } else { "" };
        let history = format!("history: (reset: [Cut]{rest})");
        let _ = match (links.is_empty(), pass.source) {
            (true, 0) => write!(out, "\"p{i}\":{blank}Pass(kind: \"noise\", {history}),"),
            (true, 1) => write!(out, "\"p{i}\": Pass(kind: \"pair\", {history}), "),
            (true, 2) => write!(out, "\"p{i}\": Pass(kind: \"gbuffer\", {history}),{blank}"),
            _ if hands_on(passes, i) => write!(
                out,
                "\"p{i}\": Pass(kind: \"fullscreen\", shader: \"hand.wgsl\", in: {{ {} }}, out: {{ \"out\": Out({}) }}, {history}),",
                links.join(", "),
                if pass.source == 0 { "" } else { "interface: \"GBuffer\"" }
            ),
            // These write on in their own past.
            (_, 3) => {
                links.push(format!("\"own\": \"prev p{i}\""));
                write!(
                    out,
                    "\"p{i}\": Pass(kind: \"fullscreen\", shader: \"go-on.wgsl\", in: {{ {} }}, out: {{ \"out\": Out(size: {size}) }}, {history}),",
                    links.join(", ")
                )
            }
            _ => write!(
                out,
                "\"p{i}\": Pass(kind: \"fullscreen\", shader: \"a.wgsl\", in: {{ {} }}, out: {{ \"out\": Out(size: {size}) }}, {history}),",
                links.join(", ")
            ),
        };
    }
    let outputs: Vec<String> =
        outputs.iter().enumerate().map(|(i, at)| format!("\"o{i}\": \"p{}\"", at % passes.len())).collect();
    let _ = write!(out, "}},{blank}outputs: {{ {} }})", outputs.join(", "));
    // A pass with two outputs is linked by the first of them.
    out.replace("kind: \"pair\"", "kind: \"fullscreen\", shader: \"b.wgsl\"")
}

fn plan(text: &str, sharing: bool) -> Plan {
    plan_of(&MemoryFiles::new(&[("random.ron", text)]), text, sharing)
}

fn plan_of(files: &MemoryFiles, text: &str, sharing: bool) -> Plan {
    let resolved = resolve("random.ron", files, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
    let context = LinkContext { frame: (64, 64), traits: traits() };
    let graph = link(&resolved, &TestPassTypes::new(), &context).unwrap_or_else(|e| panic!("{e}\n{text}"));
    compile(&graph, &CompileOptions { sharing, ..CompileOptions::default() })
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Positions at which a resource is alive, worked out from the passes alone.
fn alive(plan: &Plan, id: ResourceId) -> Vec<usize> {
    let at = |pass: &frame_graph::plan::PlannedPass| {
        let writes = pass.outputs.iter().flat_map(|port| &port.members).any(|(_, other)| *other == id);
        let reads = pass
            .inputs
            .iter()
            .any(|i| i.history.is_none() && i.members.iter().any(|(_, other)| *other == id));
        writes || reads
    };
    let touched: Vec<usize> = (0..plan.passes.len()).filter(|i| at(&plan.passes[*i])).collect();
    match (touched.first(), touched.last()) {
        (Some(first), Some(last)) => (*first..=*last).collect(),
        _ => Vec::new(),
    }
}

fn check(plan: &Plan) -> Result<(), TestCaseError> {
    // The order respects data, and nothing is read that was not written.
    let mut written: HashSet<ResourceId> = HashSet::new();
    for pass in &plan.passes {
        for input in pass.inputs.iter().filter(|input| input.history.is_none()) {
            for (_, id) in &input.members {
                prop_assert!(written.contains(id), "{} reads {id:?} before it is written", pass.name);
            }
        }
        for (_, id) in pass.outputs.iter().flat_map(|port| &port.members) {
            prop_assert!(written.insert(*id), "{id:?} is written twice");
        }
        // What is handed on is what an input of this frame reads.
        for (_, id) in pass.outputs.iter().flat_map(|port| &port.handed) {
            let now = pass.inputs.iter().filter(|input| input.history.is_none());
            let mut read = now.flat_map(|input| &input.members);
            prop_assert!(read.any(|(_, other)| other == id), "{} hands on what it does not read", pass.name);
        }
    }
    // Nothing shares an object with what is alive at the same time, nor with what outlives the frame.
    let mut most = 0;
    for allocation in &plan.allocations {
        let mut used = HashSet::new();
        for id in &allocation.resources {
            let resource = &plan.resources[id.0 as usize];
            prop_assert!(allocation.resources.len() == 1 || !resource.persistent);
            prop_assert!(allocation.desc.bytes() >= resource.desc.bytes());
            for at in alive(plan, *id) {
                prop_assert!(used.insert(at), "two resources are alive at {at} in one object");
            }
        }
        most = most.max(used.len());
    }
    // What is shown of a lifetime is from the producer to the last reader, also of what outlives the frame.
    for (index, resource) in plan.resources.iter().enumerate() {
        let at = alive(plan, ResourceId(index as u32));
        let shown = resource.lifetime.0 as usize..=resource.lifetime.1 as usize;
        prop_assert_eq!(at, shown.collect::<Vec<_>>(), "{}", resource.name);
    }
    // The bound is what is alive at once, and sharing lies between it and no sharing.
    let transient: Vec<ResourceId> = (0..plan.resources.len() as u32)
        .map(ResourceId)
        .filter(|id| !plan.resources[id.0 as usize].persistent)
        .collect();
    let bytes = |id: &ResourceId| plan.resources[id.0 as usize].desc.bytes();
    let at = |position: usize| {
        transient.iter().filter(|id| alive(plan, **id).contains(&position)).map(bytes).sum::<u64>()
    };
    let bound = (0..plan.passes.len()).map(at).max().unwrap_or(0);
    prop_assert_eq!(plan.memory.bound, bound);
    prop_assert_eq!(plan.memory.unshared, transient.iter().map(bytes).sum::<u64>());
    prop_assert!(plan.memory.bound <= plan.memory.shared && plan.memory.shared <= plan.memory.unshared);
    // Of each shape there are as many objects as are alive at once.
    let mut shapes: BTreeMap<String, Vec<ResourceId>> = BTreeMap::new();
    for id in &transient {
        if let ResourceDesc::Texture(t) = &plan.resources[id.0 as usize].desc {
            shapes.entry(format!("{t:?}")).or_default().push(*id);
        }
    }
    let mut objects = 0;
    for ids in shapes.values() {
        objects += (0..plan.passes.len())
            .map(|p| ids.iter().filter(|id| alive(plan, **id).contains(&p)).count())
            .max()
            .unwrap_or(0);
    }
    let buffers = plan.allocations.iter().filter(|a| a.desc.texture().is_none()).count();
    prop_assert_eq!(plan.memory.objects as usize, objects + buffers);
    Ok(())
}

/// What is needed, worked out from the text of the fates alone: outputs and all that they read.
fn check_culling(plan: &Plan, passes: &[Drawn], outputs: &[usize]) -> Result<(), TestCaseError> {
    let mut needed: HashSet<usize> = HashSet::new();
    let mut open: Vec<usize> = outputs.iter().map(|at| at % passes.len()).collect();
    while let Some(i) = open.pop() {
        if needed.insert(i) {
            for (at, past) in &passes[i].reads {
                match past {
                    true => open.push(at % passes.len()),
                    false if i > 0 => open.push(at % i),
                    false => {}
                }
            }
        }
    }
    for (i, (name, fate)) in plan.fates.iter().enumerate() {
        prop_assert_eq!(name, &format!("p{i}"));
        prop_assert_eq!(matches!(fate, Fate::Kept { .. }), needed.contains(&i), "{}", name);
        let planned = plan.passes.iter().any(|pass| pass.name == *name);
        prop_assert_eq!(planned, needed.contains(&i));
    }
    Ok(())
}

/// A change of one frame, by numbers.
#[derive(Clone, Debug)]
struct Step {
    scene_bindings: u8,
    pass: Option<prop::sample::Index>,
    event: Option<u8>,
    /// The output for which alone passes run.
    only: Option<prop::sample::Index>,
}

fn step() -> impl Strategy<Value = Step> {
    (
        prop_oneof![3 => Just(0u8), 1 => 1..8u8],
        prop::option::weighted(0.3, any::<prop::sample::Index>()),
        prop::option::weighted(0.2, 0..4u8),
        prop::option::weighted(0.3, any::<prop::sample::Index>()),
    )
        .prop_map(|(scene_bindings, pass, event, only)| Step { scene_bindings, pass, event, only })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1024, ..ProptestConfig::default() })]

    #[test]
    fn any_valid_graph_has_a_sound_plan(
        passes in prop::collection::vec(drawn(), 1..40),
        outputs in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
    ) {
        let outputs: Vec<usize> = outputs.iter().map(|index| index.index(1 << 16)).collect();
        let text = text(&passes, &outputs, " ", Rest::None);
        let shared = plan(&text, true);
        check(&shared)?;
        check_culling(&shared, &passes, &outputs)?;
        let unshared = plan(&text, false);
        prop_assert_eq!(unshared.memory.shared, unshared.memory.unshared);
        prop_assert_eq!(unshared.memory.bound, shared.memory.bound);
    }

    #[test]
    fn the_name_of_a_plan_is_stable(
        passes in prop::collection::vec(drawn(), 1..20),
        outputs in prop::collection::vec(any::<prop::sample::Index>(), 1..3),
        changed in any::<prop::sample::Index>(),
    ) {
        let outputs: Vec<usize> = outputs.iter().map(|index| index.index(1 << 16)).collect();
        let id = plan(&text(&passes, &outputs, " ", Rest::None), true).id;
        let blank = "\n\t/* a /* nested */ comment */ // to the end\n";
        prop_assert_eq!(id, plan(&text(&passes, &outputs, blank, Rest::None), true).id);
        // A pass that an output shows, made by another shader or kind, gives another plan.
        let at = outputs[changed.index(outputs.len())] % passes.len();
        let mut other = passes.clone();
        other[at].source = 4;
        other[at].scale += 10;
        prop_assert_ne!(id, plan(&text(&other, &outputs, " ", Rest::None), true).id);
    }

    #[test]
    fn the_flattened_file_of_a_chain_of_parts_is_the_same_pipeline(
        passes in prop::collection::vec(drawn(), 1..12),
        outputs in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        count in 1..5usize,
        prior in prop::bool::ANY,
    ) {
        let outputs: Vec<usize> = outputs.iter().map(|index| index.index(1 << 16)).collect();
        // What would read the first pass reads the input of the part.
        let part = text(&passes, &outputs, " ", Rest::None)
            .replace("\": \"p0\"", "\": \"in.x\"")
            .replacen("Pipeline(", "Pipeline( inputs: { \"x\": \"Any\" },", 1);
        let last = format!("c{}", count - 1);
        let shown: Vec<String> = (0..outputs.len()).map(|i| format!("\"o{i}\": \"{last}.o{i}\"")).collect();
        // What comes in is of this frame, or what the last part made in the frame before.
        let seed = match prior {
            true => format!("\"seed\": Pass(kind: \"fullscreen\", shader: \"a.wgsl\", in: {{ \"past\": \"prev {last}.o0\" }}), "),
            false => "\"seed\": Pass(kind: \"noise\"), ".to_owned(),
        };
        let chain: String = (0..count).map(|i| {
            let from = if i == 0 { "seed".to_owned() } else { format!("c{}.o0", i - 1) };
            format!("\"c{i}\": Sub(file: \"part.ron\", in: {{ \"x\": \"{from}\" }}), ")
        }).collect();
        let whole = format!("Pipeline(passes: {{ {seed}{chain} }}, outputs: {{ {} }})", shown.join(", "));
        let files = MemoryFiles::new(&[("random.ron", &whole), ("part.ron", &part)]);
        let found = plan_of(&files, &whole, true);
        check(&found)?;
        let flat = resolve("random.ron", &files, &Overrides::default()).unwrap_or_else(|e| panic!("{e}")).to_ron(&TestPassTypes::new(), true);
        prop_assert_eq!(plan(&flat, true).id, found.id);
    }

    #[test]
    fn passes_that_are_skipped_are_not_missed(
        passes in prop::collection::vec(drawn(), 1..24),
        outputs in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        steps in prop::collection::vec(step(), 1..16),
        rests in any::<bool>(),
    ) {
        let outputs: Vec<usize> = outputs.iter().map(|index| index.index(1 << 16)).collect();
        let text = text(&passes, &outputs, " ", if rests { Rest::Some } else { Rest::None });
        let plan = plan(&text, true);
        let mut state = FrameState::new(&plan);
        let mut naive = Naive::new(&plan);
        let mut objects = vec![0; plan.allocations.len()];
        let mut revisions = Revisions::default();
        let mut lacking = vec![true; plan.histories.len()];
        for (number, step) in steps.iter().enumerate() {
            let frame = number as u64 + 1;
            for bit in 0..3 {
                if step.scene_bindings & (1 << bit) != 0 {
                    revisions.scene_bindings[bit] = frame;
                }
            }
            revisions.scene_bindings[3] = frame;
            let reported = step.pass.map(|index| index.index(plan.passes.len().max(1)) as u32);
            let reported: Vec<_> = reported.into_iter().filter(|_| !plan.passes.is_empty()).collect();
            for pass in &reported {
                revisions.passes.insert(*pass, frame);
            }
            let all = [ResetCause::Resize, ResetCause::Cut, ResetCause::Scene, ResetCause::Reload];
            let events: Vec<ResetCause> = step.event.map(|e| all[e as usize]).into_iter().collect();
            // Both ways to change make what reads them run; only what moves resets. Where all rests, a sample is not taken.
            let (moved, resampled) = if rests || number % 2 == 0 {
                (SceneBindings(step.scene_bindings), SceneBindings::NONE)
            } else {
                (SceneBindings::NONE, SceneBindings(step.scene_bindings))
            };
            let wanted = step.only.filter(|_| !rests).map(|only| &plan.outputs[only.index(plan.outputs.len())]);
            let only = wanted.map_or_else(Vec::new, |output| plan.feeding(&output.name));
            // Every way to name a pass makes it run.
            let reported: Vec<_> = reported.into_iter().map(frame_graph::plan::PassId).collect();
            let change = Change {
                scene_bindings: moved,
                resampled,
                passes: if number % 4 == 0 { reported.clone() } else { Vec::new() },
                values: if number % 4 == 1 { reported.clone() } else { Vec::new() },
                again: if number % 4 == 2 { reported.clone() } else { Vec::new() },
                reseeded: if number % 4 == 3 { reported } else { Vec::new() },
                events: events.clone(),
                all: false,
                only: only.clone(),
            };
            let schedule = state.begin(&plan, &change);
            // What is to be reset while its producer waits is reset when that runs.
            for (lacks, h) in lacking.iter_mut().zip(&plan.histories) {
                *lacks |= h.reset.iter().any(|r| events.contains(r));
            }
            let waits = |h: usize| only.get(plan.resources[plan.histories[h].resource.0 as usize].producer.0 as usize) == Some(&false);
            let resets: Vec<bool> = (0..lacking.len()).map(|h| !waits(h) && std::mem::take(&mut lacking[h])).collect();
            prop_assert!(schedule.runs.iter().zip(&only).all(|(runs, may_run)| !runs || *may_run));
            for (slot, reset) in schedule.histories.iter().zip(&resets) {
                prop_assert_eq!(slot.reset.is_some(), *reset);
                prop_assert_eq!(slot.age == 0, *reset);
            }
            let expected = naive.frame(&plan, &revisions, &resets, &only);
            let found = scheduled(&plan, schedule, &revisions, &mut objects);
            for (i, reads) in found.iter().enumerate() {
                if let Some(reads) = reads {
                    prop_assert_eq!(reads, &expected[i], "{} in frame {}", &plan.passes[i].name, number);
                }
            }
            for output in plan.outputs.iter().filter(|output| wanted.is_none_or(|wanted| wanted.name == output.name)) {
                for (_, id) in &output.members {
                    let resource = &plan.resources[id.0 as usize];
                    let object = match resource.history {
                        Some(h) => plan.histories[h.0 as usize].copies[schedule.histories[h.0 as usize].current],
                        None => resource.allocation,
                    };
                    prop_assert_eq!(objects[object.0 as usize], naive.contents[id.0 as usize], "{}", &output.name);
                }
            }
        }
    }
}
