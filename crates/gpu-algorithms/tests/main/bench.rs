//! A pass with any steps.

use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, UseContext, input, output,
};
use pass_test::{Harness, Outputs};

/// Buffers of words, and what is done with them.
#[derive(Default)]
pub(crate) struct Bench {
    inputs: Vec<(&'static str, Vec<u32>)>,
    outputs: Vec<(&'static str, usize)>,
    scratch: Vec<OutputDesc>,
    steps: Vec<Compute>,
}

impl Bench {
    /// An input of these words.
    pub(crate) fn input(mut self, name: &'static str, words: &[u32]) -> Bench {
        self.inputs.push((name, words.to_vec()));
        self
    }

    /// An output of this many words.
    pub(crate) fn output(mut self, name: &'static str, words: usize) -> Bench {
        self.outputs.push((name, words));
        self
    }

    /// Scratch memory and steps.
    pub(crate) fn steps(
        mut self,
        scratch: impl IntoIterator<Item = OutputDesc>,
        steps: impl IntoIterator<Item = Compute>,
    ) -> Bench {
        self.scratch.extend(scratch);
        self.steps.extend(steps);
        self
    }

    /// `None` where there is no adapter.
    pub(crate) fn run(&self) -> Option<Outputs> {
        let mut harness = Harness::new(self);
        for (name, words) in &self.inputs {
            // No buffer is empty.
            let bytes = 4 * words.len().max(1) as u64;
            let member = ("", pass_test::buffer(bytes), bytemuck::cast_slice(words).to_vec());
            harness = harness.input(name, "Buffer", &[], vec![member]);
        }
        harness.run()
    }
}

impl Pass for Bench {
    fn info(&self) -> Info {
        Info { kind: "bench", about: "Any steps.", paper: "", shaders: &[] }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: self.inputs.iter().map(|(name, _)| input(name, "Buffer", "Words.")).collect(),
            outputs: self.outputs.iter().map(|(name, _)| output(name, "Buffer", "Words.")).collect(),
            ..Ports::default()
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let buffer = |(name, words): &(&str, usize)| {
            OutputDesc::one(name, ResourceDesc::buffer(4 * (*words).max(1) as u64))
        };
        Ok(self.outputs.iter().map(buffer).chain(self.scratch.iter().cloned()).collect())
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::of(self.steps.clone()))
    }
}
