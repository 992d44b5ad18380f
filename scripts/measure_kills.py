"""Measure how fast a person is back in a game after the server, the process of the game, or the browser is killed.

Run this script from the project's folder: `.venv/bin/python scripts/measure_kills.py`. It needs Debian's Chromium. It
starts `thbridge serve` with a study, and plays in Chromium. It kills each program again and again with SIGKILL in the
middle of the game. The time ends when the page shows the effect of an act that the person does after the kill. The
exit code is 1 if a line of the history is lost, or if a time is above the bound.

The time after a kill of the browser includes its start.
"""

import argparse
import os
import random
import signal
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.support.programs.chromium import Chromium  # noqa: E402 - it is next to the tests
from tests.support.studies.served_program import ServedProgram, write_study  # noqa: E402

BOUND = 5.0
"""Greatest time in seconds."""
READING = 0.5
"""Seconds for which a person looks at a page before acting, because pages ignore earlier presses."""
SPREAD = 3.0
"""Greatest random time before a kill, seconds."""
COUNT_PAGES = """
window.complete = 0;
const Plain = window.WebSocket;
window.WebSocket = class extends Plain {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data }) => {
      window.complete += String(data).includes('"p":{"v":');
    });
  }
};
"""
"""JavaScript that counts the complete pages of a game: the page receives one when it comes back to the game."""
TWO_FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
"""JavaScript that waits until the page is painted: keys before that have no effect."""
PLAYING = "document.querySelector('.game .playing .tile')?.checkVisibility()"
RULES = "!!document.querySelector('dialog.help')?.open"
HISTORY = "[...document.querySelectorAll('.history li')].map((line) => line.textContent)"
TALK = "document.querySelector('.pops > section:not([hidden]) header button:not([hidden])')"


class Player:
    """Person who plays in Chromium, in a profile that survives the browser."""

    def __init__(self, port: int, profile: Path) -> None:
        self._address, self._profile = f"http://127.0.0.1:{port}/", profile
        self._start_browser()

    def _start_browser(self) -> None:
        self.browser = Chromium(self._profile)
        # The page may load itself again.
        self.browser.command("Page.addScriptToEvaluateOnNewDocument", source=COUNT_PAGES)
        self.browser.come_back(self._address)

    def begin(self) -> None:
        """Go into the game, and wait until the browser has written its cookie, which takes some time."""
        while not self.browser.evaluate(PLAYING):
            self.browser.evaluate("document.querySelector('.reading button.main')?.click()")
            time.sleep(READING)
        cookies = self._profile / "Default" / "Cookies"
        while b"thbridge" not in (cookies.read_bytes() if cookies.exists() else b""):
            time.sleep(READING)

    def talk(self) -> None:
        """Ask the robot to go to a room, and put the dialogue aside."""
        if not self.browser.evaluate(f"!!{TALK}"):
            self._do("document.querySelector('.tile').click()", f"!!{TALK}")
        self._do(f"{TALK}?.click()", f"!{TALK}")

    def history(self) -> list[str]:
        """Return the lines of the history."""
        lines: list[str] = self.browser.evaluate(HISTORY)
        return lines

    def restart_browser(self) -> None:
        """Kill the browser, start it again and open the page."""
        self.browser.kill()
        self._start_browser()

    def seconds_after(self, kill: Callable[[], None]) -> float:
        """Kill something; return the seconds until an act after that has its effect."""
        self.browser.evaluate("window.complete = 0")
        began = time.monotonic()
        kill()
        self.browser.until(f"window.complete > 0 && {PLAYING}")
        self.browser.evaluate(TWO_FRAMES)
        self._do_key("F1", RULES)
        seconds = time.monotonic() - began
        self._do_key("F1", f"!({RULES})")
        return seconds

    def _do_key(self, key: str, effect: str) -> None:
        self._repeat(lambda: self.browser.press(key), effect)

    def _do(self, deed: str, effect: str) -> None:
        time.sleep(READING)
        self._repeat(lambda: self.browser.evaluate(deed), effect)

    def _repeat(self, deed: Callable[[], object], effect: str) -> None:
        while True:
            deed()
            try:
                self.browser.until(effect, 2.0)
            except TimeoutError:
                continue  # The page did not accept it, because it had just changed.
            return


def kill_all(*processes: int) -> None:
    """Kill processes."""
    for process in processes:
        os.kill(process, signal.SIGKILL)


def main() -> None:
    """Read the command line, and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20, help="number of kills of each program (default 20)")
    options = parser.parse_args()
    chosen, bad = random.Random(1), False
    with tempfile.TemporaryDirectory(prefix="kills-", ignore_cleanup_errors=True) as name:
        study = write_study(Path(name, "study"), seconds=3600)
        with ServedProgram(study) as served:
            player = Player(served.port, Path(name, "profile"))
            player.begin()
            kills: dict[str, Callable[[], None]] = {
                "server": lambda: kill_all(served.child),
                "game": lambda: kill_all(*served.workers.values()),
                "browser": player.restart_browser,
            }
            for program, kill in kills.items():
                seconds, lost = [], 0
                for _ in range(options.kills):
                    player.talk()
                    time.sleep(chosen.uniform(0.0, SPREAD))
                    before = player.history()
                    seconds.append(player.seconds_after(kill))
                    lost += player.history()[: len(before)] != before
                median, longest = statistics.median(seconds), max(seconds)
                print(f"{program}: median {median:.2f} s, longest {longest:.2f} s, histories not kept: {lost}")
                print("  " + " ".join(f"{each:.2f}" for each in seconds), flush=True)
                bad |= lost > 0 or longest > BOUND
            player.browser.kill()
    sys.exit(bad)


if __name__ == "__main__":
    main()
