//! What `lightloom tune` may change: parameters of a pipeline, and what its passes declare as exact.

use super::super::blame::{changed, declared};
use super::Args;
use crate::context::{Context, unknown};
use anyhow::{Result, anyhow, bail};
use blame::Player;
use frame_graph::{LinkContext, Overrides, Resolved, Settable, Value, ValueType};
use renderer::{Compiled, compile_options};
use shader_library::AUTO;
use tune::{Axis, Point};

/// The factors on the default of a number.
const LADDER: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Parameters that say what is rendered, or for how long: they change the reference, or are no trade.
const FIXED: [&str; 3] = ["bounces", "samples", "frames"];

/// What an axis changes.
#[derive(Clone, Debug)]
pub(super) enum Change {
    /// The value of a parameter or a setting: one of these.
    Values(Vec<Value>),
    /// Whether what a pass declares as exact stands in its place.
    Exact,
}

/// An axis with its name.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) change: Change,
    pub(super) axis: Axis,
}

/// The grid.
pub(super) struct Space {
    pub(super) axes: Vec<Named>,
    /// Values that are given for all points.
    fixed: Overrides,
}

impl Space {
    /// The parameters of a pipeline over their ranges, what its passes declare as exact, and what `--vary` says; without what
    /// `--fix` names.
    pub(super) fn new(context: &Context, args: &Args, link: &LinkContext) -> Result<Space> {
        let fixed = args.values.overrides();
        let own = compiled(context, args, &fixed, link)?;
        let settable = own.resolved.settable(&*context.catalog);
        let is_given = |path: &str| fixed.0.iter().any(|(given, _)| given == path);
        let mut axes = Vec::new();
        for settable in settable.iter().filter(|settable| !settable.path.contains('.')) {
            let is_fixed = FIXED.contains(&settable.path.as_str()) || is_given(&settable.path);
            if !is_fixed && !args.vary.iter().any(|(path, _)| *path == settable.path) {
                axes.extend(ladder(settable));
            }
        }
        for (path, values) in &args.vary {
            let Some(settable) = settable.iter().find(|settable| settable.path == *path) else {
                let known: Vec<String> = settable.into_iter().map(|settable| settable.path).collect();
                return Err(unknown(
                    "parameter or setting",
                    path,
                    &known,
                    &format!("pipelines {}", args.pipeline),
                ));
            };
            axes.push(varied(settable, values)?);
        }
        let alternatives = players(context, &own, &args.output)?;
        let alternatives = alternatives.into_iter().filter(Player::is_rendered).map(|player| Named {
            name: player.name,
            change: Change::Exact,
            axis: Axis { values: 2, start: 0, ordered: false },
        });
        axes.extend(alternatives);
        for name in &args.fix {
            let Some(at) = axes.iter().position(|axis| axis.name == *name) else {
                let known: Vec<String> = axes.iter().map(|axis| axis.name.clone()).collect();
                bail!("--fix {name}: there is no such axis; there are {}", known.join(", "));
            };
            axes.remove(at);
        }
        Ok(Space { axes, fixed })
    }

    /// Returns the number of points.
    pub(super) fn points(&self) -> usize {
        self.axes.iter().fold(1, |points, axis| points.saturating_mul(axis.axis.values))
    }

    /// Returns the values of a point.
    pub(super) fn overrides(&self, point: &Point) -> Overrides {
        let values = self.axes.iter().zip(point).filter_map(|(axis, at)| match &axis.change {
            Change::Values(values) => Some((axis.name.clone(), values[*at].clone())),
            Change::Exact => None,
        });
        Overrides(self.fixed.0.iter().cloned().chain(values).collect())
    }

    /// Returns what is exact at a point.
    fn exact(&self, point: &Point) -> Vec<&str> {
        let axes = self.axes.iter().zip(point);
        let exact = axes.filter(|(axis, at)| matches!(axis.change, Change::Exact) && **at == 1);
        exact.map(|(axis, _)| axis.name.as_str()).collect()
    }

    /// Returns whether a point is a pipeline with other values and nothing else.
    pub(super) fn is_plain(&self, point: &Point) -> bool {
        self.exact(point).is_empty()
    }

    /// Returns a point in words: each axis with its value.
    pub(super) fn words(&self, point: &Point) -> Vec<(String, String)> {
        let word = |(axis, at): (&Named, &usize)| {
            let value = match &axis.change {
                Change::Values(values) => values[*at].to_argument(),
                Change::Exact => if *at == 1 { "exact" } else { "approximate" }.to_owned(),
            };
            (axis.name.clone(), value)
        };
        self.axes.iter().zip(point).map(word).collect()
    }

    /// Returns the pipeline of a point; `None` where it is none that can be: values that do not fit, and what is exact where nothing
    /// is approximated.
    pub(super) fn pipeline(
        &self,
        context: &Context,
        args: &Args,
        point: &Point,
        link: &LinkContext,
    ) -> Result<Option<(Overrides, Resolved)>> {
        let overrides = self.overrides(point);
        let Ok(own) = compiled(context, args, &overrides, link) else { return Ok(None) };
        let exact = self.exact(point);
        if exact.is_empty() {
            return Ok(Some((overrides, (*own.resolved).clone())));
        }
        let players = players(context, &own, &args.output)?;
        let chosen: Vec<&Player> = players
            .iter()
            .filter(|player| player.is_rendered() && exact.contains(&player.name.as_str()))
            .collect();
        if chosen.len() < exact.len() {
            return Ok(None);
        }
        Ok(Some((overrides, changed(&own.resolved, chosen))))
    }
}

fn compiled(context: &Context, args: &Args, overrides: &Overrides, link: &LinkContext) -> Result<Compiled> {
    Compiled::new(&context.catalog, &args.pipeline, overrides, link, &compile_options())
        .map_err(|errors| anyhow!("{errors}"))
}

fn players(context: &Context, own: &Compiled, output: &str) -> Result<Vec<Player>> {
    if own.plan.output(output).is_none() {
        let known: Vec<&str> = own.plan.outputs.iter().map(|output| &*output.name).collect();
        bail!("there is no output `{output}`; there are {}", known.join(", "));
    }
    Ok(declared(context, own, output)?.players)
}

/// Returns the axis of a parameter: all values that it may have, or some around its default; `None` where there is no other.
fn ladder(settable: &Settable) -> Option<Named> {
    let (setting, own) = (&settable.setting, &settable.value);
    if own.as_text() == Some(AUTO) {
        // The scene and the adapter choose best.
        return None;
    }
    let mut values: Vec<Value> = Vec::new();
    let (min, max) = (setting.min.unwrap_or(f64::NEG_INFINITY), setting.max.unwrap_or(f64::INFINITY));
    match (&setting.one_of[..], setting.ty) {
        ([], ValueType::Bool) => values.extend([Value::Bool(false), Value::Bool(true)]),
        ([], ValueType::U32) => {
            let own = f64::from(own.as_u32()?);
            let at = LADDER.map(|factor| (own * factor).round().clamp(min.max(1.0), max) as u32);
            values.extend(at.map(Value::U32));
        }
        ([], ValueType::F32) => {
            let own = f64::from(own.as_f32()?);
            values.extend(LADDER.map(|factor| Value::F32((own * factor).clamp(min, max) as f32)));
        }
        (choices, _) => values.extend(choices.iter().cloned()),
    }
    values.dedup();
    let start = values.iter().position(|value| value == own)?;
    let ordered = matches!(setting.ty, ValueType::U32 | ValueType::F32);
    (values.len() > 1).then(|| Named {
        name: settable.path.clone(),
        axis: Axis { values: values.len(), start, ordered },
        change: Change::Values(values),
    })
}

/// Returns the axis of values that are given.
fn varied(settable: &Settable, given: &[Value]) -> Result<Named> {
    let setting = &settable.setting;
    let checked = |value: &Value| {
        let value = value.clone().convert(setting.ty);
        let value = value.and_then(|value| setting.check(value).ok());
        value.ok_or_else(|| anyhow!("--vary {}: one of the values is none that it may have", settable.path))
    };
    let values: Vec<Value> = given.iter().map(checked).collect::<Result<_>>()?;
    let start = values.iter().position(|value| *value == settable.value).unwrap_or(values.len() / 2);
    let ordered = matches!(setting.ty, ValueType::U32 | ValueType::F32);
    let axis = Axis { values: values.len(), start, ordered };
    Ok(Named { name: settable.path.clone(), change: Change::Values(values), axis })
}
