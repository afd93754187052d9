//! What reference pages and `lightloom interfaces` state: the ports of pass types, and the WGSL that passes share.

use crate::Catalog;
use frame_graph::port::PassTypes as _;
use frame_graph::{Content, Member, PassTypeError, Ports, Settings, Use, Value};
use shader_library::Item;
use std::collections::BTreeMap;

/// A port of a pass type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The name.
    pub name: String,
    /// The name of its interface.
    pub interface: String,
    /// What it is for.
    pub doc: String,
    /// Whether it is an output.
    pub is_output: bool,
    /// `, optional`, or the setting with which there is such a port; empty without a condition.
    pub condition: String,
}

/// A WGSL file that passes import.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedFile {
    /// The name by which it is imported.
    pub name: String,
    /// The first paragraph of the comment with which it begins.
    pub about: String,
    /// The paper and its section; empty without these.
    pub paper: String,
    /// Its functions, without entry points, and its structs.
    pub items: Vec<Item>,
}

impl Catalog {
    /// Returns the ports that a pass type has by default, and those that it has with another value of one setting; none of
    /// one that takes them from a user's shader.
    ///
    /// # Errors
    /// Where the pass type's WGSL is broken.
    pub fn ports_of(&self, kind: &str) -> Result<Vec<Port>, PassTypeError> {
        if self.takes_shader(kind) == Some(true) {
            return Ok(Vec::new());
        }
        let outputs = BTreeMap::new();
        let use_ = Use { kind, shader: None, inputs: &[], outputs: &outputs };
        let settings = self.settings(use_)?;
        let with = |changed: Option<(&str, Value)>, condition: &str| {
            let mut values = Settings::defaults(&settings);
            values.0.extend(changed.map(|(name, value)| (name.to_owned(), value)));
            self.ports(use_, &values).map(|ports| listed(&ports, condition))
        };
        let mut all = with(None, "")?;
        for setting in settings.iter() {
            let values = match &setting.default {
                Value::Bool(on) => vec![Value::Bool(!on)],
                _ => setting.one_of.to_vec(),
            };
            for value in values {
                let condition = format!(", with `{}: {value}`", setting.name);
                let mut new = with(Some((&setting.name, value)), &condition)?;
                new.retain(|port| {
                    !all.iter().any(|known| known.name == port.name && known.is_output == port.is_output)
                });
                all.extend(new);
            }
        }
        Ok(all)
    }

    /// Returns the pass types that output an interface, or those that read it, in the order of the documentation.
    ///
    /// # Errors
    /// As [`Catalog::ports_of`].
    pub fn passes_with(&self, interface: &str, is_output: bool) -> Result<Vec<&'static str>, PassTypeError> {
        let mut found = Vec::new();
        for pass in self.passes() {
            let ports = self.ports_of(pass.kind())?;
            if ports.iter().any(|port| port.interface == interface && port.is_output == is_output) {
                found.push(pass.kind());
            }
        }
        Ok(found)
    }

    /// Returns the structs of the file of a member that holds one.
    pub fn structs_of(&self, member: &Member) -> Vec<Item> {
        let Content::Struct(of) = member.content else { return Vec::new() };
        let items = shader_library::items(&self.assets().text(of.file).unwrap_or_default());
        items.into_iter().filter(|item| item.keyword == "struct").collect()
    }

    /// Returns the WGSL that passes share: the files of `shaders/` without those of benchmarks and of precision, sorted by name.
    pub fn shared_files(&self) -> Vec<SharedFile> {
        let files = self.shaders().folder("shaders");
        let shared = files.iter().filter_map(|file| {
            let name = file.path.strip_prefix("shaders/")?.to_owned();
            if name.starts_with("bench/") || name.starts_with("precision/") {
                return None;
            }
            let mut items = shader_library::items(&self.assets().text(&file.path)?);
            items.retain(|item| !item.is_entry);
            Some(SharedFile { name, about: file.about.clone(), paper: file.paper.clone(), items })
        });
        shared.collect()
    }
}

fn listed(ports: &Ports, condition: &str) -> Vec<Port> {
    let inputs = ports.inputs.iter().map(|port| Port {
        name: port.name.clone(),
        interface: port.interface.clone(),
        doc: port.doc.clone(),
        is_output: false,
        condition: if port.optional { ", optional".to_owned() } else { condition.to_owned() },
    });
    let outputs = ports.outputs.iter().map(|port| Port {
        name: port.name.clone(),
        interface: port.interface.clone(),
        doc: port.doc.clone(),
        is_output: true,
        condition: condition.to_owned(),
    });
    inputs.chain(outputs).collect()
}
