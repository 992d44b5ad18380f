"""Draw the pictures of the player: `docs/pictures/player-light.png` and `player-dark.png`, in Debian's Chromium.

Run this script from the project's folder: `.venv/bin/python scripts/draw/player.py`. It records a hunt of three robots
with a simulated participant. `--bag` uses another recording, and `--into` sets the output folder.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
SIZE = (1440, 1500)
"""Width and height of the page, pixels."""
MOMENT = 25
"""Moment of the recording that the pictures show, seconds."""
LOOKS = {"light": "1", "dark": "0"}
"""Chromium's numbers of the color schemes."""
_THBRIDGE = (sys.executable, "-c", "from ui.cli import main; main()")


def main() -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--into", type=Path, default=PICTURES, help="output folder (default docs/pictures)")
    parser.add_argument("--bag", type=Path, help="recording to draw; default: a new hunt")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bag, page = options.bag or Path(folder) / "hunt.bag", Path(folder) / "player.html"
        if options.bag is None:
            _run(*_THBRIDGE, "play", "--headless", "--robots", "3", "--seed", "4", "--no-report", "--bag", str(bag))
        _run(*_THBRIDGE, "report", "--player", str(bag), "--to", str(page))
        for look, number in LOOKS.items():
            _run(
                "chromium",
                "--headless=new",
                "--no-sandbox",
                "--hide-scrollbars",
                "--disable-dev-shm-usage",
                "--log-level=3",
                f"--blink-settings=preferredColorScheme={number}",
                f"--window-size={SIZE[0]},{SIZE[1]}",
                "--virtual-time-budget=3000",
                f"--screenshot={options.into / f'player-{look}.png'}",
                f"file://{page}#t={MOMENT}",
            )


def _run(*command: str) -> None:
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
