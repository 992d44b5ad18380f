"""Entry point: check the operating system before importing modules that some systems lack."""

import gc
import sys


def main() -> None:
    """Run the command line. On Windows, print how to run thbridge there, and exit."""
    if sys.platform == "win32":
        sys.exit(
            "thbridge runs on Linux and macOS. On Windows, install WSL 2 (`wsl --install` in PowerShell), then install "
            "thbridge in it. Its windows appear on the Windows desktop."
        )
    # Almost all objects of a start live until the end of the program. With Python's default, 700, looking for garbage
    # would take a tenth of the start.
    gc.set_threshold(10_000)
    from ui.cli import main as run  # noqa: PLC0415 - its imports do not exist on Windows

    run()
