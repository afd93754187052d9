//! The inputs that a test gives to the pass under test: a pass type for each.

use crate::TestPass;
use frame_graph::{Extent, Facts, OutputDesc, ResourceDesc, TextureDesc, Usage};
use interfaces::INTERFACES;

/// An input that a test gives: a pass of one output port, of the input's name, whose resources hold given bytes.
pub(crate) struct Given {
    pub(crate) port: String,
    pub(crate) interface: String,
    pub(crate) facts: Facts,
    pub(crate) members: Vec<GivenMember>,
    /// For an input that reads the past: how many frames it has lasted.
    pub(crate) age: Option<u32>,
}

/// One resource of an input, and its bytes.
pub(crate) struct GivenMember {
    pub(crate) name: String,
    pub(crate) desc: ResourceDesc,
    pub(crate) bytes: Vec<u8>,
}

impl Given {
    /// Returns the name of the pass, and of its pass type.
    pub(crate) fn pass(&self) -> String {
        format!("given-{}", self.port)
    }

    /// Returns the name of a member's resource in the plan.
    pub(crate) fn resource(&self, member: &str) -> String {
        let dot = if member.is_empty() { "" } else { "." };
        format!("{}.{}{dot}{member}", self.pass(), self.port)
    }

    /// Adds the members that the interface requires and the test leaves out, as large as the first texture and full of
    /// NaN: no producer would leave them out.
    pub(crate) fn add_required_members(&mut self) {
        let known = INTERFACES.iter().find(|known| known.name == self.interface);
        let size = self.members.iter().find_map(|member| member.desc.texture()).cloned();
        let members = known.into_iter().flat_map(|known| known.members);
        for member in members.filter(|member| !member.optional) {
            if self.members.iter().any(|given| given.name == member.name) {
                continue;
            }
            let desc = match (member.content.format(), &size) {
                (None, _) => ResourceDesc::buffer(16),
                (Some(format), Some(like)) => ResourceDesc::Texture(TextureDesc { format, ..like.clone() }),
                (Some(format), None) => ResourceDesc::texture_2d(format, (1, 1)),
            };
            let bytes = vec![0xff; desc.bytes() as usize];
            self.members.push(GivenMember { name: member.name.to_owned(), desc, bytes });
        }
    }

    /// The facts: those that the interface does not declare are read by the module alone.
    fn facts_of_port(&self) -> Facts {
        let Some(mut module) = self.facts.module().cloned() else { return self.facts.clone() };
        let interface = INTERFACES.iter().find(|interface| interface.name == self.interface);
        let mut facts = Facts::default();
        for (name, value) in self.facts.iter() {
            if interface.is_some_and(|interface| interface.fact(name).is_some()) {
                facts.insert(name, value.clone());
            } else {
                module = module.fact(name, value.clone());
            }
        }
        facts.set_module(module);
        facts
    }

    /// Returns the pass type.
    pub(crate) fn pass_type(&self) -> TestPass {
        let members = self.members.iter();
        let output = OutputDesc {
            members: members
                .map(|member| (member.name.clone(), of_fixed_size(&member.desc), Usage::Overwrites))
                .collect(),
            facts: self.facts_of_port(),
            ..OutputDesc::one(&self.port, ResourceDesc::buffer(16))
        };
        // Names of pass types are static; a process of tests has few of them.
        TestPass::new(self.pass().leak()).output_of(&self.interface, output)
    }
}

fn of_fixed_size(desc: &ResourceDesc) -> ResourceDesc<Extent> {
    match desc {
        ResourceDesc::Buffer(buffer) => ResourceDesc::Buffer(buffer.clone()),
        ResourceDesc::Texture(texture) => ResourceDesc::Texture(TextureDesc {
            format: texture.format,
            size: Extent::Fixed(texture.size.0, texture.size.1),
            layers: texture.layers,
            array: texture.array,
        }),
    }
}
