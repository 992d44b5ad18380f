"""Program of another environment: Chromium, killed again and again in a game, and started again with its profile.

Arguments: port of the gateway; number of kills; folder of the profile. It prints a JSON object: `seconds`, the times
from the start of Chromium until the game is shown; `lost`, lines of the history that were not shown again; `lines`, the
number of lines in the end.
"""

import json
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

from driven_chromium import CHANGES, DrivenChromium

STATE = """
const lines = [...document.querySelectorAll(".history li")].map((line) => line.textContent);
return document.querySelector(".tile") ? { lines } : null;
"""


def lines_of(person, begins):
    """Return an object with the lines of the history; None before the game. If `begins` is True, leave other pages."""
    if begins:
        press(person, ".reading button.main")
    return person.run(STATE)


def press(person, selector):
    """Press a button, unless the page changes."""
    with suppress(*CHANGES):
        person.press_first(selector)


def keeps(cookies):
    """Return True once Chromium has written the cookie to its profile, which takes some time; None before."""
    return True if cookies.exists() and b"thbridge" in cookies.read_bytes() else None


def main():
    port, kills, profile = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    seconds, lost, before = [], [], []
    for number in range(kills + 1):
        began = time.monotonic()
        person = DrivenChromium(profile=profile)
        person.browser.get(f"http://127.0.0.1:{port}/")
        after = person.until(partial(lines_of, person, number == 0))["lines"]
        seconds.append(round(time.monotonic() - began, 2))
        lost += [line for line in before if line not in after]
        person.until(partial(keeps, profile / "Default" / "Cookies"))
        press(person, ".tile")
        time.sleep(1.0)
        press(person, ".pops .answers button")
        time.sleep(1.0)
        before = lines_of(person, False)["lines"]
        person.kill()
    print(json.dumps({"seconds": seconds[1:], "lost": lost, "lines": len(before)}))


main()
