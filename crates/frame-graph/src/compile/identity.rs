//! The hash that identifies a plan.

use crate::plan::{Begins, Plan, PlanId, ResourceId};
use crate::port::Facts;
use crate::resource::{Clear, ResourceDesc};
use data_file::Value;
use xxhash_rust::xxh3::xxh3_128;

/// Incremented whenever the encoding changes, so that hashes of old plans never equal those of new ones.
const VERSION: u32 = 2;

/// Everything that identifies a plan, in one fixed encoding.
struct Encoder(Vec<u8>);

impl Encoder {
    fn u8(&mut self, n: u8) {
        self.0.push(n);
    }

    fn u32(&mut self, n: u32) {
        self.0.extend_from_slice(&n.to_le_bytes());
    }

    fn len(&mut self, n: usize) {
        self.u32(n as u32);
    }

    fn text(&mut self, text: &str) {
        self.len(text.len());
        self.0.extend_from_slice(text.as_bytes());
    }

    fn value(&mut self, value: &Value) {
        match value {
            Value::Bool(b) => self.0.extend_from_slice(&[0, u8::from(*b)]),
            Value::U32(n) => {
                self.u8(1);
                self.u32(*n);
            }
            Value::I32(n) => {
                self.u8(2);
                self.u32(n.cast_unsigned());
            }
            Value::F32(x) => {
                self.u8(3);
                self.f32(*x);
            }
            Value::Text(text) => {
                self.u8(4);
                self.text(text);
            }
            Value::Vector(v) => {
                self.u8(5);
                self.len(v.len());
                v.iter().for_each(|x| self.f32(*x));
            }
        }
    }

    /// Encodes the bits; −0 is encoded as 0.
    fn f32(&mut self, x: f32) {
        self.u32((x + 0.0).to_bits());
    }

    fn clear(&mut self, clear: &Clear) {
        match clear {
            Clear::Zero => self.u8(0),
            Clear::Color(color) => {
                self.u8(1);
                color.iter().for_each(|x| self.f32(*x));
            }
        }
    }

    fn desc(&mut self, desc: &ResourceDesc) {
        match desc {
            ResourceDesc::Texture(t) => {
                self.u8(0);
                self.u8(t.format as u8);
                self.u32(t.size.0);
                self.u32(t.size.1);
                self.u32(t.layers);
                self.u8(u8::from(t.array));
            }
            ResourceDesc::Buffer(b) => {
                self.u8(1);
                self.0.extend_from_slice(&b.bytes.to_le_bytes());
            }
        }
    }

    fn facts(&mut self, facts: &Facts) {
        self.len(facts.iter().len());
        for (name, value) in facts.iter() {
            self.text(name);
            self.value(value);
        }
        let Some(module) = facts.module() else { return self.text("") };
        self.text(&module.path);
        self.len(module.options.len());
        for (name, value) in &module.options {
            self.text(name);
            self.value(value);
        }
    }

    fn members<N: AsRef<str>>(&mut self, members: &[(N, ResourceId)]) {
        self.len(members.len());
        for (name, id) in members {
            self.text(name.as_ref());
            self.u32(id.0);
        }
    }
}

/// Returns the two hashes of a plan: of its structure, and of everything except the fates of passes that it
/// lacks.
pub(crate) fn of(plan: &Plan) -> (PlanId, PlanId) {
    let mut e = Encoder(Vec::with_capacity(plan.passes.len() * 192 + plan.resources.len() * 64));
    e.u32(VERSION);
    e.structure(plan);
    let structure = PlanId(xxh3_128(&e.0));
    e.values(plan);
    (structure, PlanId(xxh3_128(&e.0)))
}

impl Encoder {
    /// Encodes what objects, links and history buffers depend on.
    fn structure(&mut self, plan: &Plan) {
        let e = self;
        e.len(plan.passes.len());
        for pass in &plan.passes {
            e.text(&pass.name);
            e.text(&pass.kind);
            e.text(pass.shader.as_deref().unwrap_or(""));
            e.len(pass.inputs.len());
            for input in &pass.inputs {
                e.text(&input.port);
                e.text(&input.interface);
                e.members(&input.members);
                e.len(input.history.as_ref().map_or(0, Vec::len));
                input.history.iter().flatten().for_each(|h| e.u32(h.0));
            }
            e.len(pass.outputs.len());
            for port in &pass.outputs {
                e.text(&port.port);
                e.text(&port.interface);
                e.members(&port.members);
                e.members(&port.handed);
                e.u8(u8::from(port.connected));
            }
            e.len(pass.clears.len());
            for (id, clear) in &pass.clears {
                e.u32(id.0);
                e.clear(clear);
            }
            e.len(pass.continues.len());
            for continued in &pass.continues {
                e.u32(continued.resource.0);
                let (form, id) = match continued.from {
                    Begins::InPlace(history) => (0, history.0),
                    Begins::CopyOfPast(history) => (1, history.0),
                    Begins::Copy(resource) => (2, resource.0),
                };
                e.u8(form);
                e.u32(id);
            }
        }
        e.len(plan.resources.len());
        for resource in &plan.resources {
            e.desc(&resource.desc);
            e.u32(resource.allocation.0);
            e.u8(u8::from(resource.persistent));
        }
        e.len(plan.allocations.len());
        plan.allocations.iter().for_each(|allocation| e.desc(&allocation.desc));
        e.len(plan.histories.len());
        for history in &plan.histories {
            e.u32(history.resource.0);
            e.u32(history.rest.unwrap_or(0));
        }
    }

    /// Encodes the rest: what may differ between plans of the same structure.
    fn values(&mut self, plan: &Plan) {
        let e = self;
        e.u32(plan.frame.0);
        e.u32(plan.frame.1);
        for pass in &plan.passes {
            e.len(pass.settings.0.len());
            for (name, value) in &pass.settings.0 {
                e.text(name);
                e.value(value);
            }
            e.len(pass.overrides.len());
            for (port, said) in pass.overrides.iter() {
                // Format and size are encoded with the resources; a shader may use the rest.
                e.text(port);
                e.text(said.interface.as_deref().unwrap_or(""));
                e.u32(said.count.unwrap_or(0));
            }
            e.u8(pass.scene_bindings.0);
            pass.outputs.iter().for_each(|port| e.facts(&port.facts));
        }
        for history in &plan.histories {
            e.len(history.reset.len());
            history.reset.iter().for_each(|cause| e.u8(*cause as u8));
            e.u8(u8::from(history.catches_up));
        }
        e.len(plan.outputs.len());
        for output in &plan.outputs {
            e.text(&output.name);
            e.text(&output.interface);
            e.members(&output.members);
        }
    }
}
