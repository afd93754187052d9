//! The times of phases from the start of the process to its first picture.
//!
//! A phase is a span of `tracing` whose target is `phase`, in whatever crate it happens. Phases that run side by side
//! on several threads overlap.

use crate::output::stdout;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;

/// The target of the spans that are phases.
pub(crate) const TARGET: &str = "phase";

/// The time that a phase took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Phase {
    /// Time from the start of the process to when it first began.
    from: Duration,
    /// To when it last ended.
    to: Duration,
    /// Time spent in it, on all threads together, without that of phases inside it.
    busy: Duration,
}

/// Records phases. Clones share what is recorded.
#[derive(Clone, Debug)]
pub(crate) struct Phases {
    main: Instant,
    /// Time from the start of the process to `main`.
    before: Duration,
    recorded: Arc<Mutex<BTreeMap<&'static str, Phase>>>,
    /// Time from the start of the process to the first picture.
    first: Arc<OnceLock<Duration>>,
}

thread_local! {
    /// The phases that this thread is in: when each was entered, and the time of the phases inside it so far.
    static ENTERED: RefCell<Vec<(Instant, Duration)>> = const { RefCell::new(Vec::new()) };
}

impl Phases {
    /// Begins to count, as the first statement of `main`.
    pub(crate) fn begin() -> Phases {
        let before = process_age().unwrap_or_default();
        let recorded =
            BTreeMap::from([("program", Phase { from: Duration::ZERO, to: before, busy: before })]);
        Phases {
            main: Instant::now(),
            before,
            recorded: Arc::new(Mutex::new(recorded)),
            first: Arc::default(),
        }
    }

    /// Returns the time from the start of the process to the first picture, which is now; `None` where there was one.
    pub(crate) fn first_picture(&self) -> Option<Duration> {
        let whole = self.before + self.main.elapsed();
        self.first.set(whole).ok().map(|()| whole)
    }

    /// Prints the phases in the order in which they began; `whole` is the time to the first picture.
    pub(crate) fn print(&self, whole: Duration) {
        stdout!("{:<40} {:>10} {:>10} {:>10}", "start", "from ms", "to ms", "busy ms");
        for (name, phase) in self.in_order() {
            let [from, to, busy] = [phase.from, phase.to, phase.busy].map(ms);
            stdout!("{name:<40} {from:>10.1} {to:>10.1} {busy:>10.1}");
        }
        stdout!("{:<40} {:>10} {:>10.1}", "first picture", "", ms(whole));
    }

    /// Returns the same for programs.
    pub(crate) fn to_json(&self, whole: Duration) -> Value {
        let phases = self.in_order().into_iter().map(|(name, phase)| {
            json!({
                "phase": name,
                "from_ms": ms(phase.from),
                "to_ms": ms(phase.to),
                "busy_ms": ms(phase.busy),
            })
        });
        json!({ "first_picture_ms": ms(whole), "phases": phases.collect::<Vec<_>>() })
    }

    fn in_order(&self) -> Vec<(&'static str, Phase)> {
        let mut phases: Vec<_> = self.lock().iter().map(|(name, phase)| (*name, *phase)).collect();
        phases.sort_by_key(|(_, phase)| phase.from);
        phases
    }

    /// Adds one stay in a phase, as far as it lies before the first picture.
    fn add(&self, name: &'static str, stay: Phase) {
        let end = self.first.get().map_or(stay.to, |&first| stay.to.min(first));
        if end < stay.from {
            return;
        }
        let stay = Phase { to: end, busy: stay.busy.min(end - stay.from), ..stay };
        let mut recorded = self.lock();
        let phase = recorded.entry(name).or_insert(Phase { busy: Duration::ZERO, ..stay });
        phase.from = phase.from.min(stay.from);
        phase.to = phase.to.max(stay.to);
        phase.busy += stay.busy;
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<&'static str, Phase>> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<S: tracing::Subscriber + for<'a> LookupSpan<'a>> Layer<S> for Phases {
    fn on_enter(&self, _: &tracing::span::Id, _: Context<'_, S>) {
        ENTERED.with_borrow_mut(|entered| entered.push((Instant::now(), Duration::ZERO)));
    }

    fn on_exit(&self, id: &tracing::span::Id, context: Context<'_, S>) {
        let Some((start, inside)) = ENTERED.with_borrow_mut(Vec::pop) else { return };
        let (Some(span), now) = (context.span(id), Instant::now()) else { return };
        let whole = now - start;
        ENTERED.with_borrow_mut(|entered| {
            if let Some((_, inside)) = entered.last_mut() {
                *inside += whole;
            }
        });
        let since = |instant: Instant| self.before + instant.saturating_duration_since(self.main);
        let stay = Phase { from: since(start), to: since(now), busy: whole.saturating_sub(inside) };
        self.add(span.name(), stay);
    }
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// Returns how long ago the process was started, to a hundredth of a second; `None` where the system does not say.
fn process_age() -> Option<Duration> {
    // proc(5): the name in brackets may contain spaces; the start time is the 20th value after it, in ticks of 10 ms
    // since the system started.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let started: f64 = stat.rsplit_once(')')?.1.split_whitespace().nth(19)?.parse().ok()?;
    let uptime = std::fs::read_to_string("/proc/uptime").ok()?;
    let now: f64 = uptime.split_whitespace().next()?.parse().ok()?;
    Duration::try_from_secs_f64(now - started / 100.0).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracing_subscriber::layer::SubscriberExt as _;

    #[test]
    fn a_phase_does_not_count_what_is_inside_it() {
        let phases = Phases::begin();
        let wait = Duration::from_millis(20);
        tracing::subscriber::with_default(tracing_subscriber::registry().with(phases.clone()), || {
            for _ in 0..2 {
                let _outer = tracing::info_span!(target: TARGET, "outer").entered();
                let _inner = tracing::info_span!(target: TARGET, "inner").entered();
                std::thread::sleep(wait);
            }
        });
        let found = phases.in_order();
        assert_eq!(found.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["program", "outer", "inner"]);
        let [program, outer, inner] = [0, 1, 2].map(|i| found[i].1);
        assert!(inner.busy >= 2 * wait, "{inner:?}");
        // All that it does itself is to begin and to end.
        assert!(outer.busy < wait, "{outer:?}");
        assert!(program.to <= outer.from && outer.from <= inner.from && inner.to <= outer.to, "{found:?}");
    }

    #[test]
    fn phases_end_at_the_first_picture() {
        let phases = Phases::begin();
        let first = phases.first_picture().unwrap();
        let stay = |from, to| Phase { from, to, busy: to - from };
        let ms = Duration::from_millis;
        phases.add("around", stay(Duration::ZERO, first + ms(5)));
        phases.add("after", stay(first + ms(1), first + ms(2)));
        assert_eq!(phases.lock().get("around"), Some(&stay(Duration::ZERO, first)));
        assert_eq!(phases.lock().get("after"), None);
        assert_eq!(phases.first_picture(), None);
    }
}
