"""The command line: ``wayfield`` or ``python -m wayfield``, without the app."""

import signal
import sys

from . import _native


def main() -> int:
    """Runs the command line and returns the exit status."""
    # The command line handles Ctrl-C itself: a training run is saved first.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["wayfield", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
