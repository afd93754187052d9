//! The pipeline around the pass under test: a pass type for each input that a test gives, and the pass type under test.

use frame_graph::port::{OutputContext, PassTypes};
use frame_graph::{
    Extent, Facts, Interface, OutputDesc, OutputPort, PassTypeError, Ports, ResourceDesc, Setting, Settings,
    TextureDesc, Usage, Use,
};
use interfaces::INTERFACES;
use pass::{Content, Library, Pass, UseContext};
use std::sync::Arc;

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
            let desc = match (member.content, &size) {
                (Content::Struct(_) | Content::Buffer, _) => ResourceDesc::buffer(16),
                (Content::Texture(format), Some(like)) => {
                    ResourceDesc::Texture(TextureDesc { format, ..like.clone() })
                }
                (Content::Texture(format), None) => ResourceDesc::texture_2d(format, (1, 1)),
            };
            let bytes = vec![0xff; desc.bytes() as usize];
            self.members.push(GivenMember { name: member.name.to_owned(), desc, bytes });
        }
    }

    fn describe(&self) -> OutputDesc {
        let members = self.members.iter();
        OutputDesc {
            members: members
                .map(|member| (member.name.clone(), of_fixed_size(&member.desc), Usage::Overwrites))
                .collect(),
            facts: self.facts.clone(),
            ..OutputDesc::one(&self.port, ResourceDesc::buffer(16))
        }
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

/// The pass types of a test.
pub(crate) struct TestPassTypes<'a> {
    pub(crate) pass: &'a dyn Pass,
    pub(crate) given: &'a [Given],
    pub(crate) shaders: &'a Library,
}

impl TestPassTypes<'_> {
    fn is_tested(&self, kind: &str) -> bool {
        self.pass.info().kind == kind
    }

    fn given(&self, kind: &str) -> Result<&Given, PassTypeError> {
        let found = self.given.iter().find(|given| given.pass() == kind);
        found.ok_or_else(|| PassTypeError::new(format!("there is no pass type `{kind}`")))
    }
}

impl PassTypes for TestPassTypes<'_> {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.given.iter().map(Given::pass).collect();
        names.push(self.pass.info().kind.to_owned());
        names.sort();
        names
    }

    fn interfaces(&self) -> &[Interface] {
        INTERFACES
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        if self.is_tested(kind) {
            Some(self.pass.takes_shader())
        } else {
            self.given(kind).ok().map(|_| false)
        }
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        if !self.is_tested(use_.kind) {
            return Ok(Arc::new([]));
        }
        Ok(self.pass.settings(&UseContext { use_, shaders: self.shaders, interfaces: INTERFACES })?.into())
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        if self.is_tested(use_.kind) {
            return self
                .pass
                .ports(&UseContext { use_, shaders: self.shaders, interfaces: INTERFACES }, settings)
                .map(Arc::new);
        }
        let given = self.given(use_.kind)?;
        let output =
            OutputPort { name: given.port.clone(), interface: given.interface.clone(), doc: String::new() };
        Ok(Arc::new(Ports { outputs: vec![output], ..Ports::default() }))
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let use_ = context.use_;
        let mut outputs = if self.is_tested(use_.kind) {
            self.pass.outputs(&UseContext { use_, shaders: self.shaders, interfaces: INTERFACES }, context)?
        } else {
            vec![self.given(use_.kind)?.describe()]
        };
        pass::scene_bindings::find_of_modules(&mut outputs, self.shaders);
        Ok(outputs)
    }
}
