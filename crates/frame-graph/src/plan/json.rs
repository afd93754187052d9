//! The plan as JSON.

use super::{Begins, Fate, Plan, PlannedPass, ResourceId};
use crate::port::SceneBindings;
use data_file::{Name, Value};
use serde_json::{Map, Value as Json, json};

/// Returns a value as JSON has it.
pub(crate) fn value(value: &Value) -> Json {
    match value {
        Value::Bool(b) => json!(b),
        Value::U32(n) => json!(n),
        Value::I32(n) => json!(n),
        Value::F32(x) => json!(x),
        Value::Text(text) => json!(text),
        Value::Vector(v) => json!(v),
    }
}

fn names(list: &[Name]) -> Json {
    list.iter().map(|name| name.as_str()).collect()
}

impl SceneBindings {
    /// Returns the names of what is in it.
    pub fn names(self) -> Vec<&'static str> {
        let all = [
            (SceneBindings::SCENE, "scene"),
            (SceneBindings::CAMERA, "camera"),
            (SceneBindings::LIGHTS, "lights"),
            (SceneBindings::FRAME, "frame"),
            (SceneBindings::SAMPLE, "sample"),
            (SceneBindings::PREVIOUS, "previous positions"),
            (SceneBindings::SEED, "seed"),
        ];
        all.into_iter().filter(|(bit, _)| self.contains(*bit)).map(|(_, name)| name).collect()
    }
}

pub(super) fn json(plan: &Plan) -> Json {
    let name_of = |id: &ResourceId| plan.resources[id.0 as usize].name.as_str();
    let members = |list: &[(Name, ResourceId)]| -> Json {
        list.iter().map(|(name, id)| (name.to_string(), json!(name_of(id)))).collect::<Map<_, _>>().into()
    };
    let pass = |pass: &PlannedPass| {
        let settings: Map<_, _> = pass.settings.0.iter().map(|(name, v)| (name.clone(), value(v))).collect();
        let inputs = pass.inputs.iter().map(|input| {
            json!({
                "port": &*input.port, "interface": &*input.interface, "past": input.history.is_some(),
                "resources": members(&input.members),
            })
        });
        let outputs = pass.outputs.iter().map(|port| {
            json!({
                "port": &*port.port, "interface": &*port.interface, "connected": port.connected,
                "resources": members(&port.members), "hands_on": members(&port.handed),
            })
        });
        let continues = pass.continues.iter().map(|continued| {
            let (from, past) = match continued.from {
                Begins::InPlace(history) | Begins::CopyOfPast(history) => {
                    (plan.histories[history.0 as usize].resource, true)
                }
                Begins::Copy(id) => (id, false),
            };
            let in_place = matches!(continued.from, Begins::InPlace(_));
            json!({
                "resource": name_of(&continued.resource), "input": &*continued.input, "from": name_of(&from),
                "past": past, "in_place": in_place,
            })
        });
        json!({
            "name": &*pass.name, "kind": &*pass.kind, "shader": pass.shader.as_deref(), "settings": settings,
            "scene_bindings": pass.scene_bindings.names(), "depends_on": pass.depends_on.names(), "remembers": pass.remembers,
            "inputs": inputs.collect::<Json>(), "outputs": outputs.collect::<Json>(),
            "continues": continues.collect::<Json>(),
        })
    };
    let resource = |r: &super::PlannedResource| {
        json!({
            "name": &*r.name, "desc": r.desc.to_string(), "bytes": r.desc.bytes(), "object": r.allocation.0,
            "lifetime": [r.lifetime.0, r.lifetime.1], "persistent": r.persistent,
        })
    };
    let fate = |(name, fate): &(Name, Fate)| match fate {
        Fate::Kept { readers } => json!({ "pass": &**name, "fate": "kept", "readers": names(readers) }),
        Fate::Culled { readers } => json!({ "pass": &**name, "fate": "culled", "readers": names(readers) }),
        Fate::Off { why, instead } => {
            json!({ "pass": &**name, "fate": "off", "why": why, "instead": instead })
        }
    };
    let history = |h: &super::History| {
        json!({
            "resource": name_of(&h.resource),
            "reset": h.reset.iter().map(ToString::to_string).collect::<Vec<_>>(), "rest": h.rest, "catches_up": h.catches_up,
        })
    };
    let output = |o: &super::PlannedOutput| {
        json!({
            "name": &*o.name, "from": &*o.from, "interface": &*o.interface, "resources": members(&o.members),
        })
    };
    let memory = plan.memory;
    json!({
        "id": plan.id.to_string(),
        "frame": [plan.frame.0, plan.frame.1],
        "passes": plan.passes.iter().map(pass).collect::<Json>(),
        "resources": plan.resources.iter().map(resource).collect::<Json>(),
        "objects": plan.allocations.iter().map(|a| json!({
            "desc": a.desc.to_string(), "bytes": a.desc.bytes(),
            "resources": a.resources.iter().map(name_of).collect::<Vec<_>>(),
        })).collect::<Json>(),
        "histories": plan.histories.iter().map(history).collect::<Json>(),
        "outputs": plan.outputs.iter().map(output).collect::<Json>(),
        "fates": plan.fates.iter().map(fate).collect::<Json>(),
        "memory": {
            "unshared": memory.unshared, "shared": memory.shared, "bound": memory.bound,
            "objects": memory.objects, "persistent": memory.persistent,
        },
    })
}
