"""The command ``afmsweep``; also ``python -m afmsweep``."""

import os
import signal
import sys

from . import _afmsweep


def main() -> None:
    """Runs the command with the arguments of the process, and exits as it does."""
    # The command hears signals itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    code = _afmsweep.command(sys.argv[1:])
    sys.stdout.flush()
    # Nothing of Python's is left to be done.
    os._exit(code)


if __name__ == "__main__":
    main()
