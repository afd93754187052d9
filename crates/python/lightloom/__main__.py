"""The command line, `lightloom` or `python -m lightloom`."""

import signal
import sys

from . import _lightloom


def main() -> None:
    """Runs a command, and ends the process with its exit code."""
    # Ctrl-C ends the program; Python's own handler would wait until the command is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    program = [sys.executable, "-m", "lightloom"]
    sys.exit(_lightloom.run(program, ["lightloom", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
