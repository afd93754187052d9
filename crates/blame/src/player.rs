//! The approximations of a pipeline.

use crate::game::Subset;
use frame_graph::plan::{PassId, PlannedPass};
use frame_graph::{PassChange, Plan, Value};
use pass::{Exact, ExactBy};

/// The frames whose mean is taken where noise between frames is not to count.
pub const FRAMES: u32 = 16;

/// An approximation of a pipeline that can be taken back.
#[derive(Clone, Debug, PartialEq)]
pub struct Player {
    /// Its name.
    pub name: String,
    /// What is exact, in words.
    pub doc: String,
    /// The passes that declare it.
    pub passes: Vec<String>,
    /// Changes of passes, by their names.
    pub changes: Vec<(String, PassChange)>,
    /// Values of the reference that has the error too.
    pub reference: Vec<(String, Value)>,
    /// The frames of which the exact picture is the mean.
    pub frames: u32,
}

impl Player {
    /// The player whose counterpart is the mean of [`FRAMES`] frames, each with random numbers of its own.
    fn frames() -> Player {
        Player {
            name: "one frame".to_owned(),
            doc: format!("The mean of {FRAMES} frames, each with random numbers of its own."),
            frames: FRAMES,
            ..Player::named("")
        }
    }

    fn named(name: &str) -> Player {
        Player {
            name: name.to_owned(),
            doc: String::new(),
            passes: Vec::new(),
            changes: Vec::new(),
            reference: Vec::new(),
            frames: 1,
        }
    }

    /// Returns whether its exact picture is rendered; that of others follows from pictures of other subsets.
    pub fn is_rendered(&self) -> bool {
        !self.changes.is_empty()
    }
}

/// Returns the frames of which the picture of a subset of players is the mean.
pub(crate) fn frames(players: &[Player], subset: Subset) -> f64 {
    let exact = players.iter().enumerate().filter(|(player, _)| subset & 1 << player != 0);
    f64::from(exact.map(|(_, of)| of.frames).max().unwrap_or(1))
}

/// What the passes of a pipeline declare.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Declared {
    /// The approximations, in the order of the plan; last the single frame.
    pub players: Vec<Player>,
    /// What can be done by other means, in the order of the plan: these tell who owes what is left.
    pub stages: Vec<Player>,
}

/// Returns what the passes declare that an output depends on. `exact` returns what a pass declares.
///
/// Where every frame is another sample of the picture, a reference of other settings has no such error: these are left out.
///
/// # Errors
/// As `exact`.
pub fn players<E>(
    plan: &Plan,
    output: &str,
    is_sampled: bool,
    exact: impl Fn(&PlannedPass) -> Result<Vec<Exact>, E>,
) -> Result<Declared, E> {
    let feeding = plan.feeding(output);
    let mut found = Declared::default();
    // From the last pass to the first: of passes that one another feed, the last one stands for all.
    for (at, pass) in plan.passes.iter().enumerate().rev().filter(|(at, _)| feeding[*at]) {
        for declared in exact(pass)? {
            let all = match declared.by {
                ExactBy::Instead(_) => &mut found.stages,
                _ => &mut found.players,
            };
            let known = all.iter().position(|player| player.name == declared.name);
            let known = known.unwrap_or_else(|| {
                all.push(Player::named(&declared.name));
                all.len() - 1
            });
            let player = &mut all[known];
            match declared.by {
                ExactBy::Change(change) | ExactBy::Instead(change) => {
                    let is_replaced = matches!(change, PassChange::Replace { .. });
                    if is_replaced && feeds_any(plan, at, &player.passes) {
                        continue;
                    }
                    player.changes.push((pass.name.to_string(), change));
                }
                ExactBy::Reference(_) if is_sampled => continue,
                ExactBy::Reference(set) => player.reference.extend(set),
            }
            player.doc = declared.doc;
            player.passes.push(pass.name.to_string());
        }
    }
    found.players.retain(|player| !player.passes.is_empty());
    found.players.reverse();
    found.stages.reverse();
    found.players.push(Player::frames());
    Ok(found)
}

/// Whether one of the passes of these names reads what a pass makes, or what is made of it.
fn feeds_any(plan: &Plan, pass: usize, names: &[String]) -> bool {
    let of_names =
        plan.passes.iter().enumerate().filter(|(_, other)| names.contains(&other.name.to_string()));
    let mut ids = of_names.map(|(at, _)| PassId(at as u32));
    ids.any(|other| plan.upstream([other])[pass])
}
