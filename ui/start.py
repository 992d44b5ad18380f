"""The program's beginning: what it cannot run on is told before anything is imported that needs more."""

import sys


def main() -> None:
    """Run the command line, or tell where it runs."""
    if sys.platform == "win32":
        sys.exit(
            "thbridge runs on Linux and macOS. On Windows, install WSL 2 (`wsl --install` in PowerShell), and install "
            "thbridge in there; its windows are shown on this desktop."
        )
    from ui.cli import main as run  # noqa: PLC0415 - what it imports is not there on Windows

    run()
