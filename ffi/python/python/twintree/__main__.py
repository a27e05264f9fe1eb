"""The command line: `python -m twintree render scene.xml`."""

import sys

from ._native import main


def run() -> int:
    """Runs the command line with the words of this process; returns its exit code."""
    return main(["twintree", *sys.argv[1:]], [sys.executable, "-m", "twintree"])


if __name__ == "__main__":
    sys.exit(run())
