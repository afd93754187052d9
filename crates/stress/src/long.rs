//! Long runs: thousands of frames of a pipeline that keeps something between frames, in which a light moves or nothing does.

use crate::case::{Case, Expect};
use crate::room::Room;
use metrics::Glance;
use serde::{Deserialize, Serialize};

/// Frames of a period of the light.
const PERIOD: u32 = 50;

/// The shortest run that can be evaluated: its tenths hold whole periods of the light.
pub const SHORTEST: u32 = 10 * PERIOD;

/// Greatest difference of the mean of the last tenth from that of the second, if periods differ by less.
const DRIFT: f64 = 0.02;

/// Standard errors within which that difference is chance.
const CHANCE: f64 = 4.0;

/// Growth that is allowed [bytes]: allocations that happen now and then.
const SLACK: f64 = 4.0 * 1024.0 * 1024.0;

/// Additional growth that is allowed for each frame [bytes].
const LEFT_BEHIND: f64 = 64.0;

/// Share of the fastest frames of a tenth whose time is compared: other work on the machine slows the rest.
const FASTEST: f64 = 0.05;

/// Greatest ratio of that time at the end to that at the beginning.
const SLOWER: f64 = 1.5;

/// The expectation of a long run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steady {
    /// The light moves: each period is as bright as the one before.
    Moving,
    /// Nothing moves: from some frame on, all are the same, bit by bit.
    Still,
    /// Nothing moves, but each frame is a sample of its own: they are as bright as each other.
    Sampled,
}

/// The line that `render --log` writes for a frame.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Line {
    /// Its time \[s\].
    pub seconds: f64,
    /// The memory of the program after it \[bytes\], if the system reports it.
    pub memory: Option<u64>,
    /// The objects on the device after it, if they are counted.
    pub objects: Option<u64>,
    /// The outputs.
    pub outputs: Outputs,
}

/// The outputs of a frame.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Outputs {
    /// Indirect light.
    pub indirect: Seen,
    /// The whole picture.
    pub image: Seen,
}

/// The properties of one picture.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Seen {
    /// Hash of its bits.
    pub hash: String,
    /// Mean and counts.
    #[serde(flatten)]
    pub glance: Glance,
}

/// The result of a long run: the last tenth against the second. The first may begin without history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Long {
    /// Number of frames.
    pub frames: usize,
    /// The mean luminance of the indirect light, as a share.
    pub energy: f64,
    /// The memory of the program: its growth \[bytes\].
    pub growth: Option<f64>,
    /// The objects on the device: their growth.
    pub objects: Option<f64>,
    /// The time of the fastest twentieth of frames, as a share.
    pub time: f64,
    /// The number of the frame from which on all are the same, bit by bit; `None` where the last two differ.
    pub same_from: Option<usize>,
    /// The unexpected findings; empty if there are none.
    pub wrong: Vec<String>,
}

/// Returns a long run in which the light moves, and one in which nothing does. `sampled` says that each frame is a sample of
/// its own.
pub fn long(frames: u32, sampled: bool) -> [Case; 2] {
    let round = f64::from(PERIOD) / 30.0;
    let key = |time: f64, at: [f64; 3]| {
        format!("Key(time: {time:?}, position: ({:?}, {:?}, {:?}))", at[0], at[1], at[2])
    };
    let (here, there) = ([0.13, 0.5, 0.1], [0.35, 0.45, 0.2]);
    let room = Room {
        about: "The light goes to and fro.".to_owned(),
        keyframes: Some(format!(
            "Keyframes(frames_per_second: 30, repeat: true, lights: {{ \"light 0\": [{}, {}, {}] }})",
            key(0.0, here),
            key(round / 2.0, there),
            key(round, here)
        )),
        ..Room::default()
    };
    let still = if sampled { Steady::Sampled } else { Steady::Still };
    let case = |name: &str, about: &str, steady| {
        let case =
            Case::new("long", name, format!("{frames} frames, in which {about}."), Expect::Steady(steady));
        // A picture that is the mean of several frames is rendered as such in each of them.
        Case { frames, set: vec![("frames".to_owned(), "2".to_owned())], ..case }
    };
    let moving = case("long-moving", "the light goes to and fro", Steady::Moving);
    [Case { scene: room.text(), ..moving }, case("long-still", "nothing moves", still)]
}

/// Reads the lines of `render --log`, up to the first incomplete one.
pub(crate) fn lines(text: &str) -> Vec<Line> {
    text.lines().map_while(|line| serde_json::from_str(line).ok()).collect()
}

/// Evaluates a run; `None` if it is too short.
pub(crate) fn evaluate(steady: Steady, lines: &[Line]) -> Option<Long> {
    if lines.len() < SHORTEST as usize {
        return None;
    }
    let rounds = lines.len() / PERIOD as usize;
    let tenth = rounds / 10 * PERIOD as usize;
    let early = &lines[tenth..2 * tenth];
    let late = &lines[lines.len() - tenth..];
    let mean = |part: &[Line]| {
        part.iter().map(|line| line.outputs.indirect.glance.mean).sum::<f64>() / part.len() as f64
    };
    let most = |part: &[Line], of: fn(&Line) -> Option<u64>| {
        part.iter().filter_map(of).max().map(|most| most as f64)
    };
    let growth = |of| most(late, of).zip(most(early, of)).map(|(late, early)| late - early);
    let time = |part: &[Line]| {
        let mut seconds: Vec<f64> = part.iter().map(|line| line.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        seconds[(seconds.len() as f64 * FASTEST) as usize]
    };
    let last = lines.last()?;
    let same = lines.iter().rev().take_while(|line| line.outputs == last.outputs).count();
    let mut long = Long {
        frames: lines.len(),
        energy: mean(late) / mean(early),
        growth: growth(|line| line.memory),
        objects: growth(|line| line.objects),
        time: time(late) / time(early),
        same_from: (same > 1).then(|| lines.len() - same),
        wrong: Vec::new(),
    };
    let mut wrong = |is: bool, what: String| {
        if is {
            long.wrong.push(what);
        }
    };
    let allowed = DRIFT.max(CHANCE * error_of_ratio(&lines[tenth..], tenth));
    wrong(
        !((1.0 - allowed)..=(1.0 + allowed)).contains(&long.energy),
        format!("the last tenth has {:.3} of the energy of the second", long.energy),
    );
    let allowed = SLACK + LEFT_BEHIND * (lines.len() - 2 * tenth) as f64;
    wrong(
        long.growth.is_some_and(|growth| growth > allowed),
        format!("the memory grew by {:.1} MiB", long.growth.unwrap_or(0.0) / (1024.0 * 1024.0)),
    );
    wrong(
        long.objects.is_some_and(|growth| growth > 0.0),
        format!("there are {} objects more on the device", long.objects.unwrap_or(0.0)),
    );
    wrong(long.time > SLOWER, format!("frames of the last tenth took {:.2} times as long", long.time));
    let settled = long.same_from.is_some_and(|from| from <= 2 * tenth);
    wrong(
        steady == Steady::Still && !settled,
        match long.same_from {
            None => "the last frames of a still scene differ".to_owned(),
            Some(from) => format!("frames of a still scene differ up to number {from}"),
        },
    );
    Some(long)
}

fn mean(lines: &[Line]) -> f64 {
    lines.iter().map(|line| line.outputs.indirect.glance.mean).sum::<f64>() / lines.len() as f64
}

/// Returns the standard error of the ratio of the means of two parts of `part` lines, from the differences of successive
/// periods: a slow drift changes these little.
fn error_of_ratio(lines: &[Line], part: usize) -> f64 {
    let rounds: Vec<f64> = lines.chunks_exact(PERIOD as usize).map(mean).collect();
    let steps: f64 = rounds.windows(2).map(|two| (two[1] - two[0]).powi(2)).sum();
    // Half the mean square of the steps is the variance of a round; a part is the mean of several rounds.
    let variance = steps / (2.0 * rounds.len().saturating_sub(1).max(1) as f64);
    let in_part = part as f64 / f64::from(PERIOD);
    (2.0 * variance / in_part).sqrt() / mean(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run whose frame `i` has this mean, memory, objects and seconds.
    fn run(count: usize, of: impl Fn(usize) -> (f64, u64, u64, f64)) -> Vec<Line> {
        let line = |i| {
            let (mean, memory, objects, seconds) = of(i);
            let glance = Glance { mean, not_finite: 0, negative: 0 };
            let seen = Seen { hash: format!("{mean}"), glance };
            let outputs = Outputs { indirect: seen.clone(), image: seen };
            Line { seconds, memory: Some(memory), objects: Some(objects), outputs }
        };
        (0..count).map(line).collect()
    }

    #[test]
    fn what_is_steady_holds() {
        let wave = |i: usize| 1.0 + 0.3 * (std::f64::consts::TAU * i as f64 / f64::from(PERIOD)).sin();
        let long = evaluate(Steady::Moving, &run(1030, |i| (wave(i), 1 << 27, 150, 0.01))).unwrap();
        assert!(long.wrong.is_empty() && (long.energy - 1.0).abs() < 1e-9, "{long:?}");
        assert_eq!(long.same_from, None);
        let long = evaluate(Steady::Still, &run(500, |i| (i.min(30) as f64, 0, 0, 0.01))).unwrap();
        assert!(long.same_from == Some(30) && long.wrong.is_empty(), "{long:?}");
        assert!(evaluate(Steady::Still, &run(499, |_| (1.0, 0, 0, 0.01))).is_none());
    }

    #[test]
    fn each_growth_is_reported() {
        let wrong = |steady, of: fn(usize) -> (f64, u64, u64, f64)| {
            let long = evaluate(steady, &run(1000, of)).unwrap();
            assert_eq!(long.wrong.len(), 1, "{long:?}");
            long.wrong[0].clone()
        };
        let message = wrong(Steady::Moving, |i| (1.0 + 1e-4 * i as f64, 0, 0, 0.01));
        assert!(message.contains("energy"), "{message}");
        let message = wrong(Steady::Moving, |i| (1.0, 20_000 * i as u64, 0, 0.01));
        assert!(message.contains("memory grew by"), "{message}");
        let message = wrong(Steady::Moving, |i| (1.0, 0, i as u64 / 400, 0.01));
        assert!(message.contains("2 objects more") || message.contains("1 objects more"), "{message}");
        let message = wrong(Steady::Moving, |i| (1.0, 0, 0, 0.01 + 1e-5 * i as f64));
        assert!(message.contains("took"), "{message}");
        let message = wrong(Steady::Still, |i| (1.0 + 1e-9 * (i % 2) as f64, 0, 0, 0.01));
        assert!(message.contains("differ"), "{message}");
    }

    #[test]
    fn other_work_on_the_machine_is_no_slow_down() {
        let of = |i: usize| (1.0, 0, 0, if i > 500 && !i.is_multiple_of(10) { 0.05 } else { 0.01 });
        assert!(evaluate(Steady::Still, &run(1000, of)).unwrap().wrong.is_empty());
    }

    #[test]
    fn differences_that_are_chance_are_none() {
        // Rounds that differ by 3 % at random: the tenth has two.
        let noise = |i: usize| ((i / PERIOD as usize) as u32).wrapping_mul(0x9e37_79b9) >> 16;
        let of = |i: usize| (1.0 + 0.1 * (f64::from(noise(i)) / 65536.0 - 0.5), 0, 0, 0.01);
        let long = evaluate(Steady::Moving, &run(1000, of)).unwrap();
        assert!(long.wrong.is_empty(), "{long:?}");
    }

    #[test]
    fn a_line_that_is_not_whole_ends_the_log() {
        let seen = r#"{"hash":"a","mean":1.0,"not_finite":0,"negative":0}"#;
        let line = format!(
            r#"{{"frame":0,"seconds":0.5,"memory":null,"objects":3,"outputs":{{"indirect":{seen},"image":{seen}}}}}"#
        );
        let read = lines(&format!("{line}\n{line}\n{}", &line[..20]));
        assert_eq!(read.len(), 2);
        assert_eq!((read[0].memory, read[0].objects), (None, Some(3)));
    }
}
