//! The figures of passes: the numbers that report how a frame went.

use crate::{RenderError, Renderer};
use frame_graph::{Content, Figure, Interface, Name, Struct};
use pass::{Library, Request};

/// The figures of a port.
#[derive(Clone, Debug, PartialEq)]
pub struct PortFigures {
    /// `pass.port`.
    pub port: Name,
    /// The name of its interface.
    pub interface: &'static str,
    /// Each figure with its value.
    pub values: Vec<(Figure, f64)>,
}

impl PortFigures {
    /// Returns the value of the figure of that name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(figure, _)| figure.name == name).map(|(_, value)| *value)
    }
}

impl Renderer {
    /// Returns the figures of the last frame: those of every output of the plan whose interface has figures. Waits for
    /// the GPU.
    ///
    /// # Errors
    /// The device is gone.
    pub fn figures(&self) -> Result<Vec<PortFigures>, RenderError> {
        let Some(plan) = self.plan() else { return Ok(Vec::new()) };
        let mut all = Vec::new();
        for port in plan.passes.iter().flat_map(|pass| &pass.outputs) {
            let interface =
                self.catalog.interfaces().iter().find(|interface| interface.name == port.interface.as_str());
            let Some((interface, (_, id))) = interface.zip(port.members.first()) else { continue };
            if interface.figures.is_empty() {
                continue;
            }
            let name = plan.resources[id.0 as usize].name.clone();
            let values = read(interface, self.catalog.shaders(), &self.executor.read(*id)?);
            all.push(PortFigures { port: name, interface: interface.name, values });
        }
        Ok(all)
    }
}

/// The figures of an interface in the bytes of its first member. One that its struct does not have as a number is left
/// out; the tests of the interfaces show that there is none.
fn read(interface: &Interface, shaders: &Library, bytes: &[u8]) -> Vec<(Figure, f64)> {
    let Some(Content::Struct(Struct { file, name })) = interface.members.first().map(|member| member.content)
    else {
        return Vec::new();
    };
    let Ok(shader) = shaders.load(&Request::new(file)) else { return Vec::new() };
    let value = |figure: &Figure| {
        let member = shader.interface.member(name, figure.name)?;
        let start = member.offset as usize;
        let word: [u8; 4] = bytes.get(start..start + 4)?.try_into().ok()?;
        match member.ty.as_str() {
            "u32" => Some(f64::from(u32::from_le_bytes(word))),
            "f32" => Some(f64::from(f32::from_le_bytes(word))),
            _ => None,
        }
    };
    interface.figures.iter().filter_map(|figure| Some((*figure, value(figure)?))).collect()
}
