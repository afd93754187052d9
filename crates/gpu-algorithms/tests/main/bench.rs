//! A pass with any steps.

use pass::{Compute, OutputDesc, ResourceDesc, Step};
use pass_test::{Harness, Outputs, TestPass};

/// Buffers of words, and what is done with them.
#[derive(Default)]
pub(crate) struct Bench {
    inputs: Vec<(&'static str, Vec<u32>)>,
    outputs: Vec<(&'static str, usize)>,
    scratch: Vec<OutputDesc>,
    steps: Vec<Compute>,
}

impl Bench {
    /// Adds an input of these words.
    pub(crate) fn input(mut self, name: &'static str, words: &[u32]) -> Bench {
        self.inputs.push((name, words.to_vec()));
        self
    }

    /// Adds an output of this many words.
    pub(crate) fn output(mut self, name: &'static str, words: usize) -> Bench {
        self.outputs.push((name, words));
        self
    }

    /// Adds scratch memory and steps.
    pub(crate) fn steps(
        mut self,
        scratch: impl IntoIterator<Item = OutputDesc>,
        steps: impl IntoIterator<Item = Compute>,
    ) -> Bench {
        self.scratch.extend(scratch);
        self.steps.extend(steps);
        self
    }

    /// Runs the steps; `None` where there is no adapter.
    pub(crate) fn run(&self) -> Option<Outputs> {
        let mut pass = TestPass::new("bench");
        for (name, words) in &self.outputs {
            pass = pass.output(OutputDesc::one(name, ResourceDesc::buffer(4 * (*words).max(1) as u64)));
        }
        pass = self.scratch.iter().cloned().fold(pass, TestPass::output);
        pass = self.inputs.iter().fold(pass, |pass, (name, _)| pass.input(name, "Buffer"));
        let steps: Vec<Step> = self.steps.iter().cloned().map(Step::Compute).collect();
        let pass = pass.steps(move |_| steps.clone());
        let mut harness = Harness::new(&pass);
        for (name, words) in &self.inputs {
            // No buffer is empty.
            let bytes = 4 * words.len().max(1) as u64;
            let member = ("", pass_test::buffer(bytes), bytemuck::cast_slice(words).to_vec());
            harness = harness.input(name, "Buffer", &[], vec![member]);
        }
        harness.run()
    }
}
