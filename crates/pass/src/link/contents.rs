//! The layout of a buffer of a plan, by the shaders that bind it.

use super::{LinkedSteps, Source};
use frame_graph::plan::ResourceId;
use shader_library::GlobalKind;
use shader_library::decode::BufferLayout;
use std::cmp::Reverse;
use std::ops::Range;

/// The declaration of a buffer of a plan by a shader that binds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundLayout {
    /// The layout of its bytes.
    pub layout: BufferLayout,
    /// The bytes of the buffer that have this layout; `None` for all.
    pub window: Option<Range<u64>>,
    /// The name of the global in WGSL.
    pub global: String,
    /// Whether that shader writes the buffer.
    pub writes: bool,
}

/// Returns the layout of a buffer, from the linked steps of all passes of a plan; `None` where no shader binds it as
/// `var<storage>`.
///
/// Where several do, one that sees the whole buffer comes before one that sees a part, one that declares structs before
/// one that declares words, and one that writes it before one that reads it; then the first.
pub fn layout_of(steps: &[LinkedSteps], resource: ResourceId) -> Option<BoundLayout> {
    let steps = steps.iter().flatten();
    let bound = steps.flat_map(|step| step.bindings.iter().map(move |bound| (&step.shader.interface, bound)));
    let of_resource = bound.filter(|(_, bound)| bound.source == Source::Resource(resource));
    let declared = of_resource.filter_map(|(interface, bound)| {
        let global = interface.globals.get(bound.global)?;
        let GlobalKind::Storage { writable, layout } = &global.kind else { return None };
        let element = layout.element.as_ref().is_some_and(|(ty, _)| interface.layout(ty).is_some());
        let named = element || interface.layout(&layout.ty).is_some();
        Some((interface, layout, bound, &global.name, named, *writable))
    });
    let (interface, layout, bound, global, _, writes) = declared
        .min_by_key(|(.., bound, _, named, writes)| (bound.window.is_some(), Reverse((*named, *writes))))?;
    let (window, global) = (bound.window.clone(), global.clone());
    Some(BoundLayout { layout: BufferLayout::new(interface, layout), window, global, writes })
}
