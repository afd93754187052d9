//! The results of frames: outputs, pictures of any resource, and progress.

use crate::{Progress, RenderError, Renderer, picture};
use executor::Object;
use executor::wgpu;
use frame_graph::plan::{PlannedOutput, ResourceId};
use frame_graph::{CompileOptions, Name, Value};
use metrics::{Display, Image, Tonemap};

impl Renderer {
    /// Returns an output of the pipeline as a picture: the first layer of its first texture. Of light at several samples of each pixel, it
    /// is their mean.
    ///
    /// # Errors
    /// There is no such output, it is no picture, or the device is gone.
    pub fn output(&self, name: &str) -> Result<Image, RenderError> {
        let picture = self.resource_picture(self.find_output(name)?, 0)?;
        let is_light = matches!(self.planned_output(name)?.interface.as_str(), "Irradiance" | "Radiance");
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let side = picture.width() / width.max(1);
        let is_sampled = side > 1 && (picture.width(), picture.height()) == (side * width, side * height);
        let mean = (is_light && is_sampled).then(|| picture.mean_of_squares(side).ok()).flatten();
        Ok(mean.unwrap_or(picture))
    }

    /// Returns a picture by name: an output of the pipeline, or any resource as [`Renderer::keep`] takes it. A resource
    /// that was not kept may hold another one that shares its memory.
    ///
    /// # Errors
    /// As [`Renderer::output`].
    pub fn picture(&self, name: &str, layer: u32) -> Result<Image, RenderError> {
        if layer == 0 && self.planned_output(name).is_ok() {
            return self.output(name);
        }
        self.resource_picture(self.find(name)?, layer)
    }

    /// Returns how the pipeline shows light on a screen: the last pass that has the settings `tonemap`, `white` and
    /// `exposure`, and what they say. `None` where no pass has them.
    pub fn display(&self) -> Option<(Name, Display)> {
        self.plan()?.passes.iter().rev().find_map(|pass| {
            let number = |name: &str| pass.settings.get(name).and_then(Value::as_f32);
            let curve = pass.settings.get("tonemap").and_then(Value::as_text)?;
            let tonemap = Tonemap::of_settings(curve, number("white")?)?;
            Some((pass.name.clone(), Display { tonemap, exposure: number("exposure")? }))
        })
    }

    /// Keeps a resource for reading back: no other resource shares its object, and the pass that writes it is not
    /// culled. The name is `pass`, `pass.port`, `pass.member` or `pass.port.member`; outputs of the pipeline are kept
    /// in any case.
    ///
    /// # Errors
    /// There is no such resource; and as [`Renderer::set_pipeline`].
    pub fn keep(&mut self, name: &str) -> Result<(), RenderError> {
        let mut kept = self.options.keep.clone();
        kept.extend(self.to_keep(name)?);
        self.set_kept(kept)
    }

    /// Keeps these resources for reading back, as [`Renderer::keep`] does, and no longer what was kept before.
    ///
    /// # Errors
    /// As [`Renderer::keep`]; what was kept before is kept then.
    pub fn keep_only<'n>(&mut self, names: impl IntoIterator<Item = &'n str>) -> Result<(), RenderError> {
        let kept: Result<Vec<Option<String>>, RenderError> =
            names.into_iter().map(|name| self.to_keep(name)).collect();
        let mut kept: Vec<String> = kept?.into_iter().flatten().collect();
        kept.dedup();
        self.set_kept(kept)
    }

    fn set_kept(&mut self, kept: Vec<String>) -> Result<(), RenderError> {
        if kept == self.options.keep {
            return Ok(());
        }
        self.set_compile_options(CompileOptions { keep: kept, ..self.options.clone() })
    }

    /// The full name of a resource that is to be kept; `None` for an output, which is kept in any case.
    fn to_keep(&self, name: &str) -> Result<Option<String>, RenderError> {
        if self.planned_output(name).is_ok() {
            return Ok(None);
        }
        let plan = self.plan().ok_or(RenderError::NoPipeline)?;
        match self.find(name) {
            Ok(id) => Ok(Some(plan.resources[id.0 as usize].name.to_string())),
            Err(missing) => {
                // A pass that was culled has no resources in the plan; the graph knows what it would make.
                let pass = name.split_once('.').map_or(name, |(pass, _)| pass);
                if plan.pass(pass).is_some() || plan.fates.iter().all(|(known, _)| known != pass) {
                    return Err(missing);
                }
                Ok(Some(name.to_owned()))
            }
        }
    }

    /// Returns the resource of that name, as [`Renderer::keep`] takes it: of several that fit, the first that the pass
    /// offers.
    ///
    /// # Errors
    /// There is none.
    pub fn find(&self, name: &str) -> Result<ResourceId, RenderError> {
        let plan = self.plan().ok_or(RenderError::NoPipeline)?;
        let (pass, rest) = name.split_once('.').unwrap_or((name, ""));
        let fits = |full: &str| {
            let mut parts = full.split('.');
            let same_pass = parts.next() == Some(pass);
            full == name || (same_pass && (rest.is_empty() || parts.any(|part| part == rest)))
        };
        let found = plan.resources.iter().position(|resource| fits(&resource.name));
        let found = found.map(|index| ResourceId(index as u32));
        let handed = || plan.handed().find(|(full, _)| fits(full)).map(|(_, id)| id);
        found.or_else(handed).ok_or_else(|| {
            let outputs = plan.outputs.iter().map(|output| &output.name);
            self.no_output(name, outputs.chain(plan.resources.iter().map(|resource| &resource.name)))
        })
    }

    /// Returns the resource of an output of the pipeline: the first of its interface.
    ///
    /// # Errors
    /// There is no such output, or it has no resource.
    pub fn find_output(&self, name: &str) -> Result<ResourceId, RenderError> {
        let output = self.planned_output(name)?;
        output.members.first().map(|(_, resource)| *resource).ok_or_else(|| RenderError::NoPicture {
            resource: output.from.to_string(),
            what: "an interface without resources".to_owned(),
        })
    }

    /// Returns the bytes of a resource of the plan: rows and layers without padding.
    ///
    /// # Errors
    /// There is none, or the device is gone.
    pub fn resource_bytes(&self, id: ResourceId) -> Result<Vec<u8>, RenderError> {
        Ok(self.executor.read(id)?)
    }

    /// Returns a layer of a texture of the plan as a picture.
    ///
    /// # Errors
    /// The resource is no texture or has no such layer, or the device is gone.
    pub fn resource_picture(&self, id: ResourceId, layer: u32) -> Result<Image, RenderError> {
        let plan = self.plan().ok_or(RenderError::NoPipeline)?;
        let resource = &plan.resources[id.0 as usize];
        if resource.desc.texture().is_none() {
            let what = format!("a buffer of {} bytes", resource.desc.bytes());
            return Err(RenderError::NoPicture { resource: resource.name.to_string(), what });
        }
        let picture = picture::from_bytes(resource, &self.executor.read(id)?, layer)?;
        let encoded = plan.passes.iter().flat_map(|pass| &pass.outputs).any(|port| {
            port.interface.as_str() == "Display" && port.members.iter().any(|(_, member)| *member == id)
        });
        Ok(if encoded { picture::decoded(picture) } else { picture })
    }

    /// Returns the progress of a result that takes several frames: the content of the pipeline's output `progress`.
    /// `None` where it has none, and so is complete after every frame. Waits for the GPU.
    ///
    /// # Errors
    /// The output is no buffer of a struct Progress (crates/interfaces/progress), or the device is gone.
    pub fn progress(&self) -> Result<Option<Progress>, RenderError> {
        let Some(output) = self.plan().and_then(|plan| plan.output("progress")) else { return Ok(None) };
        let Some((_, resource)) = output.members.first() else { return Ok(None) };
        let bytes = self.executor.read(*resource)?;
        Progress::from_bytes(&bytes)
            .map(Some)
            .ok_or_else(|| RenderError::NoProgress { resource: output.from.to_string(), bytes: bytes.len() })
    }

    /// Returns the texture of an output, for an application that draws with it.
    ///
    /// # Errors
    /// There is no such output, or it is no texture.
    pub fn output_texture(&self, name: &str) -> Result<&wgpu::TextureView, RenderError> {
        let output = self.planned_output(name)?;
        match output.members.first().and_then(|(_, resource)| self.executor.object(*resource)) {
            Some(Object::Texture { view, .. }) => Ok(view),
            _ => {
                Err(RenderError::NoPicture { resource: output.from.to_string(), what: "a buffer".to_owned() })
            }
        }
    }

    fn planned_output(&self, name: &str) -> Result<&PlannedOutput, RenderError> {
        let plan = self.plan().ok_or(RenderError::NoPipeline)?;
        plan.output(name).ok_or_else(|| self.no_output(name, plan.outputs.iter().map(|output| &output.name)))
    }

    fn no_output<'a>(&self, name: &str, has: impl Iterator<Item = &'a Name>) -> RenderError {
        let has: Vec<&str> = has.map(|name| name.as_str()).collect();
        // One that is near is meant; all of a large pipeline's resources would hide it.
        let has = match frame_graph::nearest_of_few(name, has.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                let all: Vec<String> = has.iter().map(|name| format!("`{name}`")).collect();
                format!("it has {}", all.join(", "))
            }
        };
        RenderError::NoOutput { pipeline: self.pipeline_name().to_owned(), output: name.to_owned(), has }
    }
}
