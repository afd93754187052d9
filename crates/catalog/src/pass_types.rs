//! Implements the frame graph's trait for the passes of the catalog.

use crate::assets::{Assets, PipelineFiles, ShaderAssets};
use frame_graph::port::{OutputContext, OutputDesc, PassTypes};
use frame_graph::{Interface, PassTypeError, Ports, Setting, Settings, Use};
use interfaces::NameTaken;
use pass::{Library, Pass, UseContext};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

/// All pass types, with the shaders from which some of them derive their ports.
pub struct Catalog {
    assets: Assets,
    pipelines: PipelineFiles,
    passes: Vec<&'static dyn Pass>,
    interfaces: Vec<Interface>,
    shaders: Arc<Library>,
    settings: Mutex<KnownSettings>,
}

/// Settings of pass types that take no shader, which are queried at every link.
#[derive(Default)]
struct KnownSettings {
    /// The generation of the shaders that declare them.
    generation: u64,
    by_kind: HashMap<String, Arc<[Setting]>>,
}

impl Catalog {
    /// Creates the catalog of these files.
    pub fn new(assets: Assets) -> Catalog {
        Catalog::build(assets, crate::PASSES.to_vec(), None).unwrap_or_else(|taken| panic!("{taken}"))
    }

    /// Creates the catalog of these files with further passes, which may add interfaces: for applications that have
    /// passes of their own.
    ///
    /// # Errors
    /// Where two pass types, or two different interfaces, have the same name.
    pub fn with_passes(
        assets: Assets,
        passes: impl IntoIterator<Item = &'static dyn Pass>,
    ) -> Result<Catalog, NameTaken> {
        Catalog::build(assets, crate::PASSES.iter().copied().chain(passes).collect(), None)
    }

    /// Creates the catalog of these files whose compute shaders run their threads in another order, which `seed`
    /// chooses ([`Library::with_thread_order`]): for tests that pictures depend on no order.
    pub fn with_thread_order(assets: Assets, seed: u32) -> Catalog {
        Catalog::build(assets, crate::PASSES.to_vec(), Some(seed)).unwrap_or_else(|taken| panic!("{taken}"))
    }

    fn build(
        mut assets: Assets,
        passes: Vec<&'static dyn Pass>,
        thread_order: Option<u32>,
    ) -> Result<Catalog, NameTaken> {
        let mut names = HashSet::new();
        if let Some(name) = passes.iter().map(|pass| pass.kind()).find(|name| !names.insert(*name)) {
            return Err(NameTaken::PassType { name });
        }
        let interfaces = interfaces::with_those_of(passes.iter().copied())?;
        assets.embed("crates/interfaces", interfaces::FILES);
        for pass in &passes {
            assets.embed(&pass.folder(), pass.files());
        }
        let library = Library::new(Arc::new(ShaderAssets(assets.clone())));
        let library = interfaces::import_from(library, &interfaces);
        let shaders = Arc::new(match thread_order {
            Some(seed) => library.with_thread_order(seed),
            None => library,
        });
        let pipelines = PipelineFiles(assets.clone());
        Ok(Catalog { assets, pipelines, passes, interfaces, shaders, settings: Mutex::default() })
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
        self.pass(kind).ok_or_else(|| PassTypeError::new(format!("there is no pass type `{kind}`")))
    }

    /// Returns the pass type of that name.
    pub fn pass(&self, kind: &str) -> Option<&'static dyn Pass> {
        self.passes.iter().copied().find(|pass| pass.kind() == kind)
    }

    /// Returns the pass types, in the order of the documentation.
    pub fn passes(&self) -> &[&'static dyn Pass] {
        &self.passes
    }

    /// Returns the interfaces of the tree, and those that passes add.
    pub fn interfaces(&self) -> &[Interface] {
        &self.interfaces
    }

    /// Returns what a use with these settings approximates, with what is exact in its place: see [`Pass::exact`].
    ///
    /// # Errors
    /// A shader that is refused, and values that cannot be computed.
    pub fn exact(&self, use_: Use<'_>, settings: &Settings) -> Result<Vec<pass::Exact>, PassTypeError> {
        self.find(use_.kind)?.exact(&self.context(use_), settings)
    }

    fn context<'a>(&'a self, use_: Use<'a>) -> UseContext<'a> {
        UseContext { use_, shaders: &self.shaders, interfaces: &self.interfaces }
    }
}

impl std::fmt::Debug for Catalog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Catalog").field("root", &self.assets.root()).finish_non_exhaustive()
    }
}

impl PassTypes for Catalog {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.passes.iter().map(|pass| pass.kind().to_owned()).collect();
        names.sort();
        names
    }

    fn interfaces(&self) -> &[Interface] {
        &self.interfaces
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        self.pass(kind).map(Pass::takes_shader)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        let pass = self.find(use_.kind)?;
        let context = self.context(use_);
        if pass.takes_shader() {
            return Ok(pass.settings(&context)?.into());
        }
        let mut known = self.settings.lock().unwrap_or_else(PoisonError::into_inner);
        if known.generation != self.shaders.generation() {
            *known = KnownSettings { generation: self.shaders.generation(), ..KnownSettings::default() };
        }
        if let Some(settings) = known.by_kind.get(use_.kind) {
            return Ok(Arc::clone(settings));
        }
        let settings: Arc<[Setting]> = pass.settings(&context)?.into();
        known.by_kind.insert(use_.kind.to_owned(), Arc::clone(&settings));
        Ok(settings)
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.find(use_.kind)?.ports(&self.context(use_), settings).map(Arc::new)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let cx = self.context(context.use_);
        let mut outputs = self.find(context.use_.kind)?.outputs(&cx, context)?;
        pass::scene_bindings::find_of_modules(&mut outputs, &self.shaders);
        Ok(outputs)
    }
}
