//! Runs a program within a time, and kills it with its children otherwise.

use crate::error::Failure;
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The most bytes of a program's output that are read: its end.
const MOST_OUTPUT: u64 = 4 << 20;

/// The process that runs, 0 for none: it leads a group of its own, which does not end with this program by itself.
static RUNNING: Mutex<u32> = Mutex::new(0);

fn running() -> MutexGuard<'static, u32> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How a program ended.
#[derive(Debug)]
pub struct Ended {
    /// Its exit code or signal.
    pub status: ExitStatus,
    /// The time that it took.
    pub wall: Duration,
    /// Its standard output and standard error, as they came.
    pub output: String,
}

/// Runs a program, with its arguments, in a folder, and waits for its end.
///
/// # Errors
/// [`Failure::TimedOut`] where it was killed, with its children, after the time limit; the reason why it cannot be started.
pub fn run(words: &[String], folder: &Path, limit: Duration) -> Result<Ended, Failure> {
    let failed = |error: io::Error| Failure::render(format!("cannot start `{}`: {error}", words[0]));
    // A file, not a pipe: a program that writes much must not wait for a reader.
    let output = tempfile::NamedTempFile::new().map_err(failed)?;
    let file = output.reopen().map_err(failed)?;
    let mut command = command(words, folder);
    command.stdin(Stdio::null()).stdout(file.try_clone().map_err(failed)?).stderr(file);
    let begun = Instant::now();
    // Under the lock no signal finds a program that has begun and is not yet known.
    let mut known = running();
    let mut child = command.spawn().map_err(failed)?;
    *known = child.id();
    drop(known);
    let status = loop {
        match child.try_wait() {
            Ok(None) if begun.elapsed() < limit => std::thread::sleep(Duration::from_millis(1)),
            Ok(Some(status)) => break Ok(status),
            Ok(None) | Err(_) => {
                kill(&mut child);
                break Err(Failure::TimedOut(limit));
            }
        }
    };
    let wall = begun.elapsed();
    *running() = 0;
    Ok(Ended { status: status?, wall, output: end_of(output.path()).map_err(failed)? })
}

/// Returns the command of words. A program that is named by a path is in the folder.
fn command(words: &[String], folder: &Path) -> Command {
    let program = Path::new(&words[0]);
    let is_path = program.components().count() > 1;
    let mut command = if is_path { Command::new(folder.join(program)) } else { Command::new(program) };
    command.args(&words[1..]).current_dir(folder);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// Kills a program with its children.
fn kill(child: &mut Child) {
    kill_group(child.id());
    // It may have ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Kills the program that runs, with its children, before this one ends by a signal: no other is started from then on.
pub fn kill_running() {
    let leader = running();
    if *leader != 0 {
        kill_group(*leader);
    }
    std::mem::forget(leader);
}

#[cfg(unix)]
fn kill_group(leader: u32) {
    #[expect(unsafe_code, reason = "the standard library kills no groups")]
    // SAFETY: it takes two numbers; the group is that of a child which was not yet waited for.
    unsafe {
        libc::kill(-leader.cast_signed(), libc::SIGKILL);
    }
}

#[cfg(not(unix))]
fn kill_group(_: u32) {}

/// Returns the end of a file, as text.
fn end_of(path: &Path) -> io::Result<String> {
    use std::io::{Read as _, Seek as _, SeekFrom};
    let mut file = std::fs::File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(MOST_OUTPUT)))?;
    let mut bytes = Vec::new();
    file.take(MOST_OUTPUT).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
