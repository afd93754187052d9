//! The grammar of pipelines, as types that serde reads.

use crate::frame::ResetCause;
use data_file::grammar::{Entries, Number, Spanned};
use serde::Deserialize;

pub(super) const VALUE: &str =
    "a value: true or false, a number, text, two to four numbers, or \"$parameter\"";
pub(super) const SIZE: &str = "a size: \"frame\", \"frame / 4\", \"like(input) * 3 / 2\" or (width, height)";
pub(super) const SIDE: &str =
    "a side in texels: a whole number above zero, or an expression such as \"$map * 2\"";
pub(super) const COUNT: &str =
    "a count: a whole number above zero, or an expression such as \"$lights * 16\"";

pub(super) type Text = Spanned<String>;
pub(super) type Passes = Entries<Spanned<PassFile>>;
pub(super) type Links = Entries<LinkText>;
pub(super) type Values = Entries<Spanned<ValueFile>>;

#[derive(Deserialize)]
#[serde(rename = "Pipeline")]
pub(super) struct PipelineFile {
    pub(super) about: Option<Text>,
    pub(super) paper: Option<Text>,
    pub(super) extends: Option<Text>,
    pub(super) parameters: Entries<Spanned<ParameterFile>>,
    pub(super) inputs: Entries<InterfaceName>,
    pub(super) passes: Option<Passes>,
    pub(super) outputs: Links,
    pub(super) patch: Option<Spanned<Vec<PatchFile>>>,
}

#[derive(Deserialize)]
pub(super) enum ParameterFile {
    U32(ParameterFields),
    F32(ParameterFields),
    Bool(ParameterFields),
    Text(ParameterFields),
}

#[derive(Deserialize)]
pub(super) struct ParameterFields {
    pub(super) default: Option<Spanned<ValueFile>>,
    pub(super) min: Option<Spanned<Number>>,
    pub(super) max: Option<Spanned<Number>>,
    pub(super) one_of: Option<Vec<Spanned<ValueFile>>>,
    pub(super) unit: Option<String>,
    pub(super) doc: Option<String>,
}

#[derive(Deserialize)]
#[serde(expecting = "the name of an interface")]
pub(super) struct InterfaceName(pub(super) Text);

#[derive(Deserialize)]
#[serde(expecting = "a link: \"pass\", \"pass.port\" or \"pass.port.member\"")]
pub(super) struct LinkText(pub(super) Text);

#[derive(Deserialize)]
pub(super) enum PassFile {
    Pass {
        kind: PassType,
        shader: Option<ShaderPath>,
        r#in: Links,
        set: Values,
        out: Entries<OutFile>,
        history: Option<Spanned<HistoryFile>>,
        when: Option<Switch>,
        off: Option<Spanned<OffFile>>,
    },
    Sub {
        file: Option<PipelinePath>,
        inputs: Option<Spanned<Entries<InterfaceName>>>,
        r#in: Links,
        set: Values,
        passes: Option<Spanned<Passes>>,
        outputs: Option<Spanned<Links>>,
        when: Option<Switch>,
        off: Option<Spanned<OffFile>>,
    },
}

#[derive(Deserialize)]
#[serde(expecting = "the name of a pass type")]
pub(super) struct PassType(pub(super) Text);

#[derive(Deserialize)]
#[serde(expecting = "the path of a WGSL file")]
pub(super) struct ShaderPath(pub(super) Text);

#[derive(Deserialize)]
#[serde(expecting = "the path of a pipeline file")]
pub(super) struct PipelinePath(pub(super) Text);

#[derive(Deserialize)]
#[serde(expecting = "a switch as text, such as \"scene.glossy && $bounces > 1\"")]
pub(super) struct Switch(pub(super) Text);

#[derive(Deserialize)]
#[serde(rename = "history", expecting = "`(reset: […], rest: 64)`")]
pub(super) struct HistoryFile {
    pub(super) reset: Option<ResetFile>,
    pub(super) rest: Option<Spanned<Number>>,
    pub(super) catches_up: Option<bool>,
}

#[derive(Deserialize)]
#[serde(
    rename = "$shape",
    expecting = "`All` or a list of `Resize`, `Cut`, `Scene`, `Reload`, `Setting`, `Moved`, `MovedUpstream`"
)]
pub(super) enum ResetFile {
    Word(AllCauses),
    List(Vec<ResetCause>),
}

#[derive(Deserialize)]
pub(super) enum AllCauses {
    All,
}

#[derive(Deserialize)]
#[serde(rename = "$shape", expecting = "`Input(\"port\")` or a link such as \"pass.port\"")]
pub(super) enum OffFile {
    Form(OffInput),
    Text(Text),
}

#[derive(Deserialize)]
pub(super) enum OffInput {
    Input(Text),
}

#[derive(Deserialize)]
#[serde(rename = "Out")]
pub(super) struct OutFile {
    pub(super) interface: Option<InterfaceName>,
    pub(super) format: Option<FormatName>,
    pub(super) size: Option<Spanned<SizeFile>>,
    pub(super) count: Option<Spanned<Count>>,
    pub(super) facts: Entries<Spanned<Option<ValueFile>>>,
}

#[derive(Deserialize)]
#[serde(expecting = "a format such as \"rgba16float\"")]
pub(super) struct FormatName(pub(super) Text);

/// A value of a setting. The text of the expectation is [`VALUE`].
#[derive(Deserialize)]
#[serde(
    rename = "$shape",
    expecting = "a value: true or false, a number, text, two to four numbers, or \"$parameter\""
)]
pub(super) enum ValueFile {
    Bool(bool),
    Number(Number),
    Text(String),
    Tuple(Vec<Number>),
    List(Vec<Number>),
}

/// The text of the expectation is [`COUNT`].
#[derive(Deserialize)]
#[serde(expecting = "a count: a whole number above zero, or an expression such as \"$lights * 16\"")]
pub(super) struct Count(pub(super) DimFile);

/// The text of the expectation is [`SIDE`].
#[derive(Deserialize)]
#[serde(expecting = "a side in texels: a whole number above zero, or an expression such as \"$map * 2\"")]
pub(super) struct Side(pub(super) DimFile);

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum DimFile {
    Number(Number),
    Text(String),
}

/// The text of the expectation is [`SIZE`].
#[derive(Deserialize)]
#[serde(
    rename = "$shape",
    expecting = "a size: \"frame\", \"frame / 4\", \"like(input) * 3 / 2\" or (width, height)"
)]
pub(super) enum SizeFile {
    Text(String),
    Tuple([Spanned<Side>; 2]),
}

#[derive(Deserialize)]
#[serde(
    expecting = "`Replace(\"pass\", Pass(…))`, `Insert(name: \"pass\", pass: Pass(…), between: (\"a.port\", \"b.port\"))`, `Set(\"pass.setting\", value)` or `Remove(\"pass\")`"
)]
pub(super) enum PatchFile {
    Replace(Text, Spanned<PassFile>),
    Insert { name: Text, pass: Spanned<PassFile>, between: Between },
    Set(Text, Spanned<ValueFile>),
    Remove(Text),
}

#[derive(Deserialize)]
#[serde(expecting = "two ports: (\"a.port\", \"b.port\")")]
pub(super) struct Between(pub(super) [Text; 2]);
