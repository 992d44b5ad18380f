"""Entry point: checks the operating system before it imports modules that not every system has."""

import sys


def main() -> None:
    """Run the command line; on Windows, print how to run it, and exit."""
    if sys.platform == "win32":
        sys.exit(
            "thbridge runs on Linux and macOS. On Windows, install WSL 2 (`wsl --install` in PowerShell), and install "
            "thbridge in it. Its windows appear on the Windows desktop."
        )
    from ui.cli import main as run  # noqa: PLC0415 - what it imports is not there on Windows

    run()
