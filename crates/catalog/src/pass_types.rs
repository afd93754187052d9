//! What the frame graph asks of passes, answered by the catalog.

use crate::assets::{Assets, PipelineFiles, ShaderAssets};
use frame_graph::port::{OutputContext, OutputDesc, PassTypes};
use frame_graph::{Interface, PassTypeError, Ports, Setting, Settings, Use};
use pass::{Library, Pass, UseContext};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// All pass types with the shaders by which they know their ports.
pub struct Catalog {
    assets: Assets,
    pipelines: PipelineFiles,
    shaders: Arc<Library>,
    /// Schemas of pass types that take no shader: asked for at every link, and never different.
    settings: Mutex<HashMap<String, Arc<[Setting]>>>,
}

impl Catalog {
    /// Creates the catalog of these files.
    pub fn new(assets: Assets) -> Catalog {
        let shaders = library(&assets);
        Catalog::with_shaders(assets, shaders)
    }

    /// Creates the catalog of these files whose compute shaders run their threads in another order, which `seed`
    /// chooses ([`Library::with_thread_order`]): for tests that pictures depend on no order.
    pub fn with_thread_order(assets: Assets, seed: u32) -> Catalog {
        let shaders = library(&assets).with_thread_order(seed);
        Catalog::with_shaders(assets, shaders)
    }

    fn with_shaders(assets: Assets, shaders: Library) -> Catalog {
        Catalog {
            pipelines: PipelineFiles(assets.clone()),
            assets,
            shaders: Arc::new(shaders),
            settings: Mutex::default(),
        }
    }

    /// Returns the files.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Pipelines by name.
    pub fn pipelines(&self) -> &PipelineFiles {
        &self.pipelines
    }

    /// Returns all WGSL.
    pub fn shaders(&self) -> &Arc<Library> {
        &self.shaders
    }

    fn find(&self, kind: &str) -> Result<&'static dyn Pass, PassTypeError> {
        crate::find(kind).ok_or_else(|| PassTypeError::new(format!("there is no pass type `{kind}`")))
    }
}

fn library(assets: &Assets) -> Library {
    // Imports are looked for beside the importing file, then among the shared modules.
    Library::new(Arc::new(ShaderAssets(assets.clone()))).with_roots(["shaders", ""])
}

impl std::fmt::Debug for Catalog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Catalog").field("root", &self.assets.root()).finish_non_exhaustive()
    }
}

impl PassTypes for Catalog {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = crate::PASSES.iter().map(|pass| pass.info().kind.to_owned()).collect();
        names.sort();
        names
    }

    fn interfaces(&self) -> &[Interface] {
        pass::interfaces::INTERFACES
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        crate::find(kind).map(Pass::takes_shader)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        let pass = self.find(use_.kind)?;
        let context = UseContext { use_, shaders: &self.shaders };
        if pass.takes_shader() {
            return Ok(pass.settings(&context)?.into());
        }
        let mut known = self.settings.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(settings) = known.get(use_.kind) {
            return Ok(Arc::clone(settings));
        }
        let settings: Arc<[Setting]> = pass.settings(&context)?.into();
        known.insert(use_.kind.to_owned(), Arc::clone(&settings));
        Ok(settings)
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.find(use_.kind)?.ports(&UseContext { use_, shaders: &self.shaders }, settings).map(Arc::new)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let cx = UseContext { use_: context.use_, shaders: &self.shaders };
        let mut outputs = self.find(context.use_.kind)?.outputs(&cx, context)?;
        pass::scene_bindings::find_of_modules(&mut outputs, &self.shaders);
        Ok(outputs)
    }
}
