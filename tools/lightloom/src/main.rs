//! The program `lightloom`.
//!
//! Exit codes: 0 done, 1 failed, 2 wrong use.

use std::process::ExitCode;

/// Switches off Mesa's layer that chooses a device, which prints an error if there is no desktop.
fn quieten_mesa() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        #[expect(unsafe_code, reason = "no other thread runs yet that could read the environment")]
        // SAFETY: the first statement of `main`.
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}

/// Makes a write beyond the limit on the size of files an error like any other, which does not end the program with half a
/// file.
#[cfg(unix)]
fn survive_large_files() {
    #[expect(unsafe_code, reason = "the standard library has no signals")]
    // SAFETY: no handler is installed; the signal is ignored.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

fn main() -> ExitCode {
    quieten_mesa();
    #[cfg(unix)]
    survive_large_files();
    let program = std::env::current_exe().map(|path| vec![path.display().to_string()]);
    ExitCode::from(command_line::run(program.unwrap_or_default(), std::env::args_os()))
}
