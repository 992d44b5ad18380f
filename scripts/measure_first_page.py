"""Measure the first page of a participant in Chromium, on a slow line.

Run this script from the project's folder: `.venv/bin/python scripts/measure_first_page.py`. It starts `thbridge serve`
with a study of one game for each visitor, and then with a whole study. Chromium opens each several times as a new
visitor, with an empty cache, over a line of 400 kbit/s with a latency of 300 ms. For each study, the script prints
medians: the times from the start of the navigation to the first page's text on the screen and to its button, and the
requests and bytes until then. The exit code is 1 if a text needs 1 s or more.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.support.programs.chromium import Chromium  # noqa: E402 - it is next to the tests

PROGRAM = [sys.executable, "-c", "from ui.cli import main; main()"]
LATENCY, RATE = 300, 400_000 / 8
"""Milliseconds from a request to the beginning of its answer, and bytes per second."""
BOUND = 1000.0
"""Greatest time to the text of the first page, milliseconds."""
WATCH = """
window.measured = {};
function look() {
  const moment = () => performance.now();
  const seen = { text: "main .prose", button: "main footer button" };
  for (const [name, selector] of Object.entries(seen)) {
    const found = document.querySelector(selector);
    if (found && found.getClientRects().length) measured[name] ??= moment();
  }
  if (!measured.button) requestAnimationFrame(look);
}
requestAnimationFrame(look);
"""
"""JavaScript that notes when parts of the page are laid out for a frame, in milliseconds since the navigation."""


@contextmanager
def served(folder: Path, *served: str) -> Iterator[str]:
    """Run `thbridge serve`; yield the address of the page."""
    server = subprocess.Popen(
        [*PROGRAM, "serve", *served, "--port", "0"],
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    try:
        for line in server.stdout or ():
            if line.startswith("Open http"):
                yield line.split()[1]
                break
        else:
            raise SystemExit("thbridge serve did not start")
    finally:
        server.terminate()
        server.wait(60)


def visit(browser: Chromium, address: str) -> dict[str, float]:
    """Open the page as a new visitor; return times in milliseconds, requests and bytes."""
    browser.command("Network.clearBrowserCache")
    browser.command("Page.navigate", url="about:blank")
    browser.until("location.protocol === 'about:'")
    browser.messages.clear()
    line = {"latency": LATENCY, "downloadThroughput": RATE, "uploadThroughput": RATE}
    browser.command("Network.emulateNetworkConditions", offline=False, **line)
    browser.open(address, before=WATCH)
    browser.until("window.measured.button && performance.getEntriesByName('first-contentful-paint').length")
    times = browser.evaluate(
        "({ ...measured, paint: performance.getEntriesByName('first-contentful-paint')[0].startTime })"
    )
    ended = [each["params"] for each in browser.messages if each["method"] == "Network.loadingFinished"]
    return {**times, "requests": len(ended), "bytes": sum(each["encodedDataLength"] for each in ended)}


def main() -> None:
    """Measure, print, and exit with 1 above the bound."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--visits", type=int, default=7, help="visits of each study")
    visits = parser.parse_args().visits
    late = False
    with tempfile.TemporaryDirectory() as folder, Chromium() as browser:
        subprocess.run([*PROGRAM, "study", "new", "whole"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        for name, arguments in {"One game": (), "Whole study": ("whole",)}.items():
            with served(Path(folder), *arguments) as address:
                seen = [visit(browser, address) for _ in range(visits)]
            middle = {key: statistics.median(each[key] for each in seen) for key in seen[0]}
            late |= max(middle["paint"], middle["text"]) >= BOUND
            print(
                f"{name}: first paint {middle['paint']:.0f} ms, text {middle['text']:.0f} ms, "
                f"button {middle['button']:.0f} ms; {middle['requests']:.0f} requests, {middle['bytes'] / 1000:.0f} kB"
            )
    raise SystemExit(late)


if __name__ == "__main__":
    main()
