//! The engine: renders on a thread of its own, beside the interface.
//!
//! The interface sends [`Command`]s and reads what is [`Published`]; neither waits for the other. The engine has a device
//! of its own, so that a frame that takes a second does not hold up the drawing of the window: pictures cross as pixels.

mod jobs;
mod measure;
mod model;
mod session;
mod side;
mod statistics;
mod watch;

pub(crate) use jobs::Job;
pub(crate) use measure::{Map, Measures};
use model::Stage;
pub(crate) use model::{Command, Look, Looked, Published, SceneView, SideId, SideView};
pub(crate) use statistics::PassTimes;

use crate::terminal;
use renderer::Catalog;
use session::{Lost, Session};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The longest time for which a window that is closed waits for the engine.
const PATIENCE: Duration = Duration::from_secs(2);

/// The state in which a session begins.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Pipelines, scenes and shaders.
    pub(crate) catalog: Arc<Catalog>,
    /// The pipeline by name or path.
    pub(crate) pipeline: String,
    /// The scene by name or path.
    pub(crate) scene: String,
    /// Values for parameters and settings.
    pub(crate) overrides: frame_graph::Overrides,
    /// The size of the frame in pixels, until the window sets another.
    pub(crate) size: (u32, u32),
    /// Seed of all random numbers.
    pub(crate) seed: u32,
}

/// The thread that renders, and what it has published. It ends when this is dropped.
pub(crate) struct Engine {
    commands: Sender<Command>,
    /// The number of commands that were sent.
    sent: AtomicU64,
    /// The number of those that move something.
    moves: AtomicU64,
    /// The size of frames that is set before the next one that does.
    small: Mutex<Option<(u32, u32)>>,
    /// Set while a command waits.
    waits: Arc<AtomicBool>,
    /// Set once the window is closed.
    quits: Arc<AtomicBool>,
    published: Arc<Mutex<Published>>,
    thread: Option<JoinHandle<()>>,
}

impl Engine {
    /// Starts a session. `repaint` is called whenever something new is published.
    pub(crate) fn start(start: Start, repaint: impl Fn() + Send + 'static) -> Engine {
        let (commands, received) = channel();
        let published = Arc::new(Mutex::new(Published::default()));
        let shared = Arc::clone(&published);
        let waits = Arc::new(AtomicBool::new(false));
        let waiting = Arc::clone(&waits);
        let quits = Arc::new(AtomicBool::new(false));
        let quitting = Arc::clone(&quits);
        let thread = std::thread::Builder::new().name("engine".to_owned()).spawn(move || {
            give_way();
            let publisher = Publisher { published: shared, repaint: Box::new(repaint) };
            let mut next = Some(Lost { start, commands: Vec::new() });
            while let Some(Lost { start, commands }) = next.take() {
                match Session::open(start, &publisher) {
                    Ok(session) => next = session.run(commands, &received, (&waiting, &quitting), &publisher),
                    Err(error) => publisher.with(|published| {
                        terminal::complain(format_args!("error: {error}"));
                        published.stage = None;
                        published.fatal = Some(error.to_string());
                    }),
                }
            }
        });
        let (sent, moves) = (AtomicU64::new(0), AtomicU64::new(0));
        let small = Mutex::new(None);
        Engine { commands, sent, moves, small, waits, quits, published, thread: thread.ok() }
    }

    /// Sends a command. It is carried out before the next frame.
    pub(crate) fn send(&self, command: Command) {
        if command.moves() {
            self.moves.fetch_add(1, Ordering::Relaxed);
            if let Some(size) = self.small().take() {
                self.post(Command::Size(size));
            }
        }
        self.post(command);
    }

    fn post(&self, command: Command) {
        self.sent.fetch_add(1, Ordering::Relaxed);
        // A session that has ended has said why.
        let _ = self.commands.send(command);
        self.waits.store(true, Ordering::Release);
    }

    /// Returns the number of commands that were sent.
    pub(crate) fn sent(&self) -> u64 {
        self.sent.load(Ordering::Relaxed)
    }

    /// Returns the number of commands that move something.
    pub(crate) fn moves(&self) -> u64 {
        self.moves.load(Ordering::Relaxed)
    }

    /// Returns the size that frames have from the next command on that moves something; `None` for that which they have.
    pub(crate) fn small(&self) -> MutexGuard<'_, Option<(u32, u32)>> {
        self.small.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what is published now. The engine waits while this is held.
    pub(crate) fn published(&self) -> MutexGuard<'_, Published> {
        self.published.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lets the interface come first: what this thread starts, as the threads of a driver that renders on the processor, gets the
/// time that the window leaves.
fn give_way() {
    #[cfg(target_os = "linux")]
    // Where that is not allowed, all have the same share.
    let _ = rustix::process::nice(10);
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.quits.store(true, Ordering::Release);
        self.send(Command::Quit);
        let Some(thread) = self.thread.take() else { return };
        let begun = Instant::now();
        while !thread.is_finished() {
            if begun.elapsed() > PATIENCE {
                // It is in a frame that takes long, and holds nothing that is lost with it.
                return;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        // A panic of the engine has been printed.
        let _ = thread.join();
    }
}

/// Publishes the state of a session.
pub(crate) struct Publisher {
    published: Arc<Mutex<Published>>,
    repaint: Box<dyn Fn() + Send>,
}

impl Publisher {
    /// Changes what is published, and lets the window be drawn again.
    pub(crate) fn with(&self, change: impl FnOnce(&mut Published)) {
        change(&mut self.published.lock().unwrap_or_else(PoisonError::into_inner));
        (self.repaint)();
    }

    /// Publishes the step that takes long at the moment; `None` when it is done.
    pub(crate) fn stage(&self, stage: Option<String>) {
        self.with(|published| published.stage = stage.map(Stage::new));
    }
}
