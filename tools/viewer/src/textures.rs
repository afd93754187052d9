//! Pictures on the device of the window.

use crate::engine::SideId;
use eframe::egui::{ColorImage, Context, TextureFilter, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::sync::Arc;

/// The content of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shown {
    /// The picture of a side.
    Side(SideId),
    /// The picture of differences.
    Map,
    /// A picture that was kept.
    Snapshot,
    /// The resource of the inspector.
    Looked,
}

/// The textures, each with the version that it holds.
#[derive(Default)]
pub(crate) struct Textures(HashMap<Shown, (u64, TextureHandle)>);

/// Pixels are seen as they are; a picture larger than its place is averaged.
const OPTIONS: TextureOptions = TextureOptions {
    magnification: TextureFilter::Nearest,
    minification: TextureFilter::Linear,
    ..TextureOptions::LINEAR
};

impl Textures {
    /// Returns the texture of a picture, which is uploaded where its version is not the one before.
    pub(crate) fn of(
        &mut self,
        context: &Context,
        shown: Shown,
        version: u64,
        picture: &Arc<ColorImage>,
    ) -> TextureHandle {
        let load = || context.load_texture(format!("{shown:?}"), Arc::clone(picture), OPTIONS);
        let (known, texture) = self.0.entry(shown).or_insert_with(|| (version, load()));
        if *known != version || texture.size() != picture.size {
            texture.set(Arc::clone(picture), OPTIONS);
            *known = version;
        }
        texture.clone()
    }
}
