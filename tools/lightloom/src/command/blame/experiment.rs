//! What `lightloom blame` renders.

use super::Args;
use crate::context::Context;
use anyhow::{Context as _, Result, anyhow, bail};
use blame::{Declared, Game, Owing, Pictures, Player, Subset};
use frame_graph::plan::PlannedPass;
use frame_graph::{
    CompileOptions, LinkContext, Name, Overrides, Plan, Resolved, Use, Value, name_in_united, original_name,
};
use indicatif::ProgressBar;
use metrics::Image;
use renderer::{Compiled, FrameOptions, Renderer, SharedScene, compile_options};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The pipeline that references are rendered by.
const REFERENCE: &str = "reference";
/// The most approximations of which all subsets are rendered.
const MOST_EXACT: usize = 6;
/// Seeds of the two halves of a reference: far from those of pictures.
const REFERENCE_SEEDS: [u32; 2] = [0x5eed_0001, 0x5eed_0002];
/// The output of irradiance, and the one that is made of it and of what the surfaces reflect.
pub(super) const IRRADIANCE: &str = "irradiance";
const INDIRECT: &str = "indirect";

/// The halves of a reference, by output.
pub(super) type Halves = BTreeMap<String, [Image; 2]>;

/// The variants of a pipeline that are rendered, and what follows from them.
pub(super) struct Experiment {
    overrides: Overrides,
    pub(super) players: Vec<Player>,
    /// What stands in for each of the passes that are left, one after the other.
    pub(super) stages: Vec<Player>,
    pub(super) owing: Owing,
    /// The passes that owe each stage.
    pub(super) owing_stages: Vec<Vec<String>>,
    /// The passes that make the picture of irradiance, and those that they read beside it.
    pub(super) reflectance: Vec<String>,
    pub(super) game: Game,
    /// The pipeline with each subset of the rendered players exact that the game needs, the first the pipeline itself; then the one
    /// in which all are exact, with one stage after the other replaced.
    variants: Vec<Resolved>,
    /// The index of the variant of each subset of the rendered players.
    of_rendered: BTreeMap<Subset, usize>,
    /// The subsets of players by which references differ; the first is empty.
    pub(super) references: Vec<Subset>,
    /// The outputs that are looked at: that of the picture, and irradiance, where what is left is told apart by it.
    pub(super) outputs: Vec<String>,
    has_progress: bool,
    remembers: bool,
    bounces: Value,
}

impl Experiment {
    pub(super) fn new(context: &Context, args: &Args, link: &LinkContext) -> Result<Experiment> {
        let catalog = &context.catalog;
        let overrides = args.values.overrides();
        let compiled = |pipeline: &str, overrides: &Overrides| {
            Compiled::new(catalog, pipeline, overrides, link, &compile_options())
                .map_err(|errors| anyhow!("{errors}"))
        };
        let own = compiled(&args.pipeline, &overrides)?;
        let reference = compiled(REFERENCE, &Overrides::default())?;
        for (name, compiled) in [(args.pipeline.as_str(), &own), (REFERENCE, &reference)] {
            if compiled.plan.output(&args.output).is_none() {
                let known: Vec<&str> = compiled.plan.outputs.iter().map(|output| &*output.name).collect();
                bail!("`{name}` has no output `{}`; it has {}", args.output, known.join(", "));
            }
        }
        let declared = declared(context, &own, &args.output)?;
        let base = feeding(&own.plan, &args.output);
        // Passes that reflect light may read direct light too, for another output: irradiance depends on nothing of that.
        let irradiance = |compiled: &Compiled| compiled.plan.output(IRRADIANCE).is_some();
        let by_irradiance = args.output == INDIRECT && irradiance(&own) && irradiance(&reference);
        let looked_at = if by_irradiance { IRRADIANCE } else { args.output.as_str() };
        let single = |player: &Player| with_exact(context, (args, looked_at), &own.resolved, player, link);
        let (mut players, mut owing) = (Vec::new(), Owing::default());
        for player in declared.players {
            let left_out = if player.is_rendered() { single(&player)? } else { Some(Vec::new()) };
            // What makes no difference is exact already.
            if let Some(left_out) = left_out {
                owing.players.push(in_order(&base, player.passes.iter().chain(&left_out)));
                players.push(player);
            }
        }
        let (mut stages, mut owing_stages) = (Vec::new(), Vec::new());
        for stage in declared.stages.into_iter().filter(|_| by_irradiance) {
            if let Some(left_out) = single(&stage)? {
                owing_stages.push(in_order(&base, stage.passes.iter().chain(&left_out)));
                stages.push(stage);
            }
        }
        let rendered = players.iter().filter(|player| player.is_rendered()).count();
        let game = Game::new(players.len(), if rendered > MOST_EXACT { 0 } else { players.len() }, 0);
        let (mut variants, mut of_rendered, mut references) = (Vec::new(), BTreeMap::new(), Vec::new());
        for subset in game.subsets() {
            let of_reference = among(&players, subset, |player| !player.reference.is_empty());
            if !references.contains(&of_reference) {
                references.push(of_reference);
            }
            of_rendered.entry(among(&players, subset, Player::is_rendered)).or_insert_with_key(|exact| {
                variants.push(changed(&own.resolved, exact_players(&players, *exact)));
                variants.len() - 1
            });
        }
        for count in 1..=stages.len() {
            variants.push(changed(&own.resolved, players.iter().chain(&stages[..count])));
        }
        let last = changed(&own.resolved, players.iter().chain(&stages));
        let plan = united(context, &[(*own.resolved).clone(), last], link, looked_at)?;
        let left = feeding(&plan, &name_in_united(looked_at, 1));
        owing.rest = names(base.iter().filter(|pass| left.contains(pass)));
        let of_irradiance = feeding(&own.plan, IRRADIANCE);
        let reflectance = reflecting(&own.plan, &base, &of_irradiance, &args.output);
        let outputs = std::iter::once(args.output.as_str()).chain(by_irradiance.then_some(IRRADIANCE));
        Ok(Experiment {
            overrides,
            players,
            stages,
            owing,
            owing_stages,
            reflectance,
            game,
            variants,
            of_rendered,
            references,
            outputs: outputs.map(str::to_owned).collect(),
            has_progress: own.plan.output("progress").is_some(),
            remembers: !own.plan.histories.is_empty(),
            bounces: bounces(context, &own.resolved),
        })
    }

    /// Returns how often `render` and `reference` advance a progress bar.
    pub(super) fn steps(&self, args: &Args) -> u64 {
        u64::from(args.seeds) + 1 + (self.references.len() * REFERENCE_SEEDS.len()) as u64
    }

    /// Renders the references, in the order of `references`.
    pub(super) fn render_references(
        &self,
        context: &Context,
        args: &Args,
        scene: &SharedScene,
        bar: &ProgressBar,
    ) -> Result<Vec<Halves>> {
        let mut references = Vec::new();
        for subset in &self.references {
            let own =
                exact_players(&self.players, *subset).flat_map(|player| player.reference.iter().cloned());
            let set = reference_values(self.bounces.clone(), args.samples);
            let overrides = Overrides(set.into_iter().chain(own).collect());
            let mut halves: BTreeMap<String, Vec<Image>> = BTreeMap::new();
            for seed in REFERENCE_SEEDS {
                let frame = (args.size, args.frame, seed);
                let pictures = reference(context, scene, frame, &overrides, &self.outputs)?;
                for (output, picture) in self.outputs.iter().zip(pictures) {
                    halves.entry(output.clone()).or_default().push(picture);
                }
                bar.inc(1);
            }
            let halves = halves.into_iter().map(|(output, halves)| {
                Ok((output, halves.try_into().map_err(|_| anyhow!("a reference has two halves"))?))
            });
            references.push(halves.collect::<Result<Halves>>()?);
        }
        Ok(references)
    }

    /// Renders all variants in one graph, once for each seed. Returns their pictures by output; those of irradiance are of the
    /// variant in which all is exact, and of those after it.
    pub(super) fn render(
        &self,
        context: &Context,
        args: &Args,
        scene: &SharedScene,
        bar: &ProgressBar,
    ) -> Result<BTreeMap<String, Vec<Pictures>>> {
        let mut names: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        let subsets = self.of_rendered.len();
        let of_subsets = (0..subsets).map(|variant| name_in_united(&args.output, variant));
        names.insert(&args.output, of_subsets.collect());
        if self.outputs.len() > 1 {
            let exact = self.variant(self.all());
            let left = std::iter::once(exact).chain(subsets..self.variants.len());
            names.insert(IRRADIANCE, left.map(|variant| name_in_united(IRRADIANCE, variant)).collect());
        }
        let mut renderer = Renderer::with_scene(Arc::clone(&context.catalog), scene, args.size);
        let progress = self.has_progress.then(|| "progress".to_owned());
        let outputs = names.values().flatten().cloned().chain(progress).collect();
        renderer.set_variants(&args.pipeline, &self.overrides, self.variants.clone(), outputs)?;
        let plan = Arc::clone(renderer.plan().context("no plan is loaded")?);
        renderer.set_frame_options(FrameOptions { timed: true, ..FrameOptions::default() });
        let feeding: BTreeMap<&str, Vec<bool>> =
            names.values().flatten().map(|name| (name.as_str(), plan.feeding(name))).collect();
        let empty = |names: &Vec<String>| vec![Pictures::default(); names.len()];
        let mut pictures: BTreeMap<String, Vec<Pictures>> =
            names.iter().map(|(output, names)| ((*output).to_owned(), empty(names))).collect();
        // The first time includes what the driver compiles; its pictures are not looked at.
        for seed in 0..=args.seeds {
            if self.remembers {
                renderer.set_shared_scene(scene)?;
            }
            renderer.set_seed(seed);
            renderer.set_frame_index(args.frame.saturating_sub(args.warm_up));
            for _ in 0..args.warm_up {
                renderer.frame()?;
            }
            renderer.run_everything();
            let times = if self.has_progress {
                renderer.frame_until_done(|_, _| ControlFlow::Continue(()))?.times.clone()
            } else {
                renderer.frame()?.times.clone()
            };
            bar.inc(1);
            if seed == 0 {
                continue;
            }
            for (output, pictures) in &mut pictures {
                for (name, of) in names[output.as_str()].iter().zip(pictures) {
                    of.images.push(renderer.output(name)?);
                    if !times.is_empty() {
                        let own = times.iter().zip(&feeding[name.as_str()]).filter(|(_, feeds)| **feeds);
                        of.ms.push(own.map(|(ms, _)| ms).sum());
                    }
                }
            }
        }
        Ok(pictures)
    }

    /// The subset of all players.
    pub(super) fn all(&self) -> Subset {
        (1 << self.players.len()) - 1
    }

    /// The index of the variant of a subset.
    pub(super) fn variant(&self, subset: Subset) -> usize {
        self.of_rendered[&among(&self.players, subset, Player::is_rendered)]
    }

    /// The index of the reference of a subset.
    pub(super) fn reference_of(&self, subset: Subset) -> usize {
        let wanted = among(&self.players, subset, |player| !player.reference.is_empty());
        self.references.iter().position(|known| *known == wanted).unwrap_or_default()
    }
}

/// Returns the names of passes in the order of all of them, each once.
fn in_order<'n>(all: &[Fed], passes: impl Iterator<Item = &'n String>) -> Vec<String> {
    let passes: Vec<&String> = passes.collect();
    all.iter().map(|(pass, _)| pass).filter(|pass| passes.contains(pass)).cloned().collect()
}

/// Returns the passes that make a picture of irradiance, and those that its last pass reads.
fn reflecting(plan: &Plan, all: &[Fed], of_irradiance: &[Fed], output: &str) -> Vec<String> {
    let producer = |output: &str| {
        let (_, id) = plan.output(output)?.members.first()?;
        Some(plan.producer(*id))
    };
    let last = producer(output).map(|pass| &plan.passes[pass.0 as usize]);
    let read = last.into_iter().flat_map(|pass| &pass.inputs).map(|input| input.producer);
    let read = read.filter(|pass| Some(*pass) != producer(IRRADIANCE));
    let read: Vec<&str> = read.map(|pass| &*plan.passes[pass.0 as usize].name).collect();
    let makes = |pass: &&Fed| read.contains(&pass.0.as_str()) || !of_irradiance.contains(pass);
    names(all.iter().filter(makes))
}

fn names<'f>(passes: impl Iterator<Item = &'f Fed>) -> Vec<String> {
    passes.map(|(name, _)| name.clone()).collect()
}

/// Returns the part of a subset that is of some players.
fn among(players: &[Player], subset: Subset, of: impl Fn(&Player) -> bool) -> Subset {
    let bits = players.iter().enumerate().filter(|(_, player)| of(player)).map(|(at, _)| 1 << at);
    subset & bits.fold(0, |mask, bit: Subset| mask | bit)
}

fn exact_players(players: &[Player], subset: Subset) -> impl Iterator<Item = &Player> {
    players.iter().enumerate().filter(move |(at, _)| subset & 1 << at != 0).map(|(_, player)| player)
}

/// Returns the bounces of indirect light that a pipeline renders.
pub(crate) fn bounces(context: &Context, own: &Resolved) -> Value {
    let settable = own.settable(&*context.catalog);
    let bounces = settable.into_iter().find(|settable| settable.path == "bounces");
    bounces.map_or(Value::U32(1), |settable| settable.value)
}

/// Returns the values with which a reference is rendered.
pub(crate) fn reference_values(bounces: Value, samples: u32) -> Vec<(String, Value)> {
    vec![("bounces".to_owned(), bounces), ("samples".to_owned(), Value::U32(samples))]
}

/// Renders a frame, of this size, number and seed, by path tracing; returns its outputs.
pub(crate) fn reference(
    context: &Context,
    scene: &SharedScene,
    (size, frame, seed): ((u32, u32), u32, u32),
    values: &Overrides,
    outputs: &[String],
) -> Result<Vec<Image>> {
    let mut renderer = Renderer::with_scene(Arc::clone(&context.catalog), scene, size);
    renderer.set_seed(seed);
    renderer.set_frame_index(frame);
    let wanted = outputs.iter().cloned().chain(["progress".to_owned()]).collect();
    renderer.set_compile_options(CompileOptions { outputs: wanted, ..compile_options() })?;
    renderer.set_pipeline(REFERENCE, values)?;
    renderer.frame_until_done(|_, _| ControlFlow::Continue(()))?;
    Ok(outputs.iter().map(|output| renderer.output(output)).collect::<Result<_, _>>()?)
}

/// Returns what the passes of a pipeline declare that an output depends on.
pub(crate) fn declared(context: &Context, own: &Compiled, output: &str) -> Result<Declared> {
    let exact = |pass: &PlannedPass| {
        let (kind, shader) = (&*pass.kind, pass.shader.as_deref());
        let use_ = Use { kind, shader, inputs: &[], outputs: &pass.overrides };
        context.catalog.exact(use_, &pass.settings)
    };
    blame::players(&own.plan, output, own.is_sampled(), exact).map_err(|error| anyhow!("{}", error.message))
}

/// Returns a pipeline in which some players are exact.
pub(crate) fn changed<'p>(own: &Resolved, players: impl IntoIterator<Item = &'p Player>) -> Resolved {
    let changes = players.into_iter().flat_map(|player| &player.changes);
    own.changed(changes.map(|(pass, change)| (pass.as_str(), change)))
}

/// Returns the plan of an output of two variants.
fn united(context: &Context, variants: &[Resolved; 2], link: &LinkContext, output: &str) -> Result<Plan> {
    let outputs = [0, 1].map(|variant| name_in_united(output, variant)).to_vec();
    let options = CompileOptions { outputs, ..compile_options() };
    let compiled = Compiled::united(&context.catalog, variants, link, &options);
    Ok(Arc::unwrap_or_clone(compiled.map_err(|errors| anyhow!("{errors}"))?.plan))
}

/// Returns the passes that an output needs no longer where a player alone is exact; `None` where that makes no difference.
fn with_exact(
    context: &Context,
    (args, output): (&Args, &str),
    own: &Resolved,
    player: &Player,
    link: &LinkContext,
) -> Result<Option<Vec<String>>> {
    let variants = [own.clone(), changed(own, [player])];
    let plan = united(context, &variants, link, output).with_context(|| {
        let passes = player.passes.join(" and ");
        format!(
            "what {passes} declares as exact in place of `{}` does not fit `{}`",
            player.name, args.pipeline
        )
    })?;
    let [own, exact] = [0, 1].map(|variant| name_in_united(output, variant));
    let members = |name: &str| plan.output(name).map(|output| &output.members);
    if members(&own) == members(&exact) {
        return Ok(None);
    }
    let left = feeding(&plan, &exact);
    Ok(Some(names(feeding(&plan, &own).iter().filter(|pass| !left.contains(pass)))))
}

/// A pass as the pipeline names it, and its type.
type Fed = (String, Name);

/// Returns the passes that an output depends on, in the order of the plan.
fn feeding(plan: &Plan, output: &str) -> Vec<Fed> {
    let feeding = plan.feeding(output);
    let passes = plan.passes.iter().zip(feeding).filter(|(_, feeds)| *feeds);
    passes.map(|(pass, _)| (original_name(&pass.name).to_owned(), pass.kind.clone())).collect()
}
