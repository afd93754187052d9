//! A plan for other values of settings, without linking what they do not reach.

use super::{PassId, Plan, PlannedInput};
use crate::compile::identity;
use crate::description::{Formula, PassDecl};
use crate::interface::check_facts;
use crate::link::LinkContext;
use crate::port::{Facts, InputDesc, Module, OutputContext, OutputDesc, PassTypes};
use crate::resolve::{Node, Resolved};
use data_file::{Setting, Settings, Value};
use std::sync::Arc;

/// Facts can go round through history buffers: after so many questions for each pass, linking decides.
const MAX_QUESTIONS: usize = 4;

impl Plan {
    /// Returns this plan with the settings of another description; `None` where it must be linked instead.
    ///
    /// `old` is the description that this plan was compiled from, and `new` the same files with other values. The pass
    /// types are asked again of the passes whose settings differ, and of those that such a pass gives other facts. Where
    /// the ports and resources of these stay the same, so does everything else, and the result equals the plan that linking
    /// and compiling `new` in the same context gives. It must be linked where files, switches, sizes or resources differ,
    /// where a pass with other settings is off or culled, and where something is wrong: linking then reports what.
    pub fn with_values(
        &self,
        old: &Resolved,
        new: &Resolved,
        pass_types: &dyn PassTypes,
        context: &LinkContext,
    ) -> Option<Plan> {
        if self.frame != context.frame || !old.same_files(new) || old.nodes.len() != new.nodes.len() {
            return None;
        }
        let mut exchange =
            Exchange { old: self, new, plan: self.clone(), pass_types, context, waiting: Vec::new() };
        for (old, new) in old.nodes.iter().zip(&new.nodes) {
            if old.name != new.name || !same_but_settings(&old.decl, &new.decl) {
                return None;
            }
            if !same_settings(&old.decl, &new.decl) {
                exchange.set(new)?;
            }
        }
        for _ in 0..self.passes.len() * MAX_QUESTIONS {
            let Some(pass) = exchange.waiting.pop() else {
                let mut plan = exchange.plan;
                (plan.structure, plan.id) = identity::of(&plan);
                return Some(plan);
            };
            exchange.ask(pass)?;
        }
        None
    }
}

/// The work of exchanging values. Its functions return `None` where the plan must be linked.
struct Exchange<'a> {
    old: &'a Plan,
    new: &'a Resolved,
    plan: Plan,
    pass_types: &'a dyn PassTypes,
    context: &'a LinkContext,
    /// The passes that have other settings, or other facts in an input, and have not been asked since.
    waiting: Vec<PassId>,
}

impl Exchange<'_> {
    /// Sets the settings of a pass, where its ports are the same with them.
    fn set(&mut self, node: &Node) -> Option<()> {
        let pass = self.plan.pass(&node.name)?;
        let use_ = node.decl.use_of(&node.decl.link_names)?;
        let settings = complete(&node.decl, &self.pass_types.settings(use_).ok()?)?;
        let planned = &mut self.plan.passes[pass.0 as usize];
        let ports = |settings: &Settings| self.pass_types.ports(use_, settings).ok();
        if ports(&settings)? != ports(&planned.settings)? {
            return None;
        }
        planned.settings = Arc::new(settings);
        self.waiting.push(pass);
        Some(())
    }

    /// Asks for the outputs of a pass. They may differ from those before in facts alone, which go on to its readers.
    fn ask(&mut self, pass: PassId) -> Option<()> {
        let node = &self.new.nodes[*self.new.index.get(&self.old.passes[pass.0 as usize].name)? as usize];
        let (before, after) = (self.outputs(node, self.old, pass)?, self.outputs(node, &self.plan, pass)?);
        if before.len() != after.len() || !before.iter().zip(&after).all(|(a, b)| same_but_facts(a, b)) {
            return None;
        }
        for OutputDesc { port, facts, .. } in after {
            let outputs = &mut self.plan.passes[pass.0 as usize].outputs;
            let planned = outputs.iter_mut().find(|planned| planned.port == *port)?;
            if *planned.facts == facts {
                continue;
            }
            let interface =
                self.pass_types.interfaces().iter().find(|known| planned.interface == *known.name);
            if interface.is_some_and(|interface| check_facts(interface, &port, &facts).is_err()) {
                return None;
            }
            if !same_code(&planned.facts, &facts) {
                return None;
            }
            let facts = Arc::new(facts);
            planned.facts = Arc::clone(&facts);
            for (reader, planned) in self.plan.passes.iter_mut().enumerate() {
                let reader = PassId(reader as u32);
                for input in &mut planned.inputs {
                    if input.producer == pass && input.producer_port == *port {
                        input.facts = Arc::clone(&facts);
                        self.waiting.retain(|waiting| *waiting != reader);
                        self.waiting.push(reader);
                    }
                }
            }
        }
        Some(())
    }

    /// What the pass type says of the outputs of a pass as a plan has it.
    fn outputs(&self, node: &Node, plan: &Plan, pass: PassId) -> Option<Vec<OutputDesc>> {
        let planned = &plan.passes[pass.0 as usize];
        let inputs: Vec<InputDesc> = planned.inputs.iter().map(|input| describe(plan, input)).collect();
        let context = OutputContext {
            use_: node.decl.use_of(&node.decl.link_names)?,
            settings: &planned.settings,
            inputs: &inputs,
            frame: self.context.frame,
            traits: &self.context.traits,
        };
        self.pass_types.outputs(&context).ok()
    }
}

/// Returns an input as its pass type is asked with it.
fn describe(plan: &Plan, input: &PlannedInput) -> InputDesc {
    let members = input.members.iter();
    InputDesc {
        name: input.port.to_string(),
        interface: input.interface.to_string(),
        members: members
            .map(|(name, id)| (name.to_string(), plan.resources[id.0 as usize].desc.clone()))
            .collect(),
        facts: Arc::clone(&input.facts),
    }
}

/// Returns whether two passes of the same files differ in settings at most.
fn same_but_settings(a: &PassDecl, b: &PassDecl) -> bool {
    // All else of a pass cannot hold a parameter.
    let values = |when: &Option<Formula>| {
        let mut origins = Vec::new();
        when.iter().for_each(|when| when.expr.origins(&mut origins));
        origins.into_iter().map(|(name, value, _)| (name, value)).collect::<Vec<_>>()
    };
    a.overrides == b.overrides && values(&a.when) == values(&b.when)
}

fn same_settings(a: &PassDecl, b: &PassDecl) -> bool {
    fn given(decl: &PassDecl) -> impl Iterator<Item = (&str, Option<&Value>)> {
        decl.set.iter().map(|set| (set.name.value.as_str(), set.value.get()))
    }
    given(a).eq(given(b))
}

fn same_but_facts(a: &OutputDesc, b: &OutputDesc) -> bool {
    (&a.port, a.scratch, &a.members, &a.handed) == (&b.port, b.scratch, &b.members, &b.handed)
}

/// Returns whether readers import the same module, with whatever options.
fn same_code(a: &Facts, b: &Facts) -> bool {
    let code = |module: &Module| (module.path.clone(), module.scene_bindings);
    a.module().map(code) == b.module().map(code)
}

/// Returns the defaults with the values that are given; `None` where one of these is wrong.
pub(crate) fn complete(decl: &PassDecl, schema: &[Setting]) -> Option<Settings> {
    let mut settings = Settings::defaults(schema);
    for set in &decl.set {
        let setting = schema.iter().find(|setting| set.name.value == *setting.name)?;
        // A parameter without a value has that of the setting.
        let Some(value) = set.value.get() else { continue };
        settings.0.insert(setting.name.clone(), setting.check(value.clone()).ok()?);
    }
    Some(settings)
}
