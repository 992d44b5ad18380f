"""Measure games in browsers: many people at once, over real WebSockets.

Run this script from the project's folder: `.venv/bin/python scripts/measure_browser_games.py --games 42 --minutes 20`.
It starts `thbridge serve` with a study of one game for each person. Programs in place of people play: every 3 to 8
seconds, each one does an act that its page offers. The script prints the time from an act to the page with its effect,
errors, stalls, memory and processor time. With `--find`, it looks for the greatest number of games within the bound, in
trials of `--minutes` each. The exit code is 1 if there is an error or a stall, or if the time is above the bound.

With `--seats`, several people play each game, and each of them commands some of the robots.

With `--browsers`, some of these people use Debian's Chromium, on the same machine. For them, the time ends after the
page is painted.
"""

import argparse
import asyncio
import os
import random
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.support.programs.browser_client import BrowserClient  # noqa: E402 - it is next to the tests
from tests.support.programs.chromium import Chromium  # noqa: E402
from ui.web.pool.running_games import RunningGames  # noqa: E402

PROGRAM = [sys.executable, "-c", "from ui.cli import main; main()"]
STUDY = """\
title: Games in browsers
base: {{map: {map}, robots: {robots}, server.port: 0}}
quota: 100000
consent_elsewhere: People agreed before.
steps:
  - {{step: instructions, text: welcome.txt}}
  - {{step: trial, name: game, max_seconds: {seconds}}}
"""
TEAM = """\
map: {map}
robots: {robots}
server: {{port: 0}}
seats:
{seats}
"""
"""Study file of games with several people."""
BOUND = 0.1
"""Greatest 95th percentile of the time from an act to the page with its effect, seconds."""
STALL = 2.0
"""An act without a page within this many seconds counts as a stall."""
THINKING = (3.0, 8.0)
"""Shortest and longest time between two acts of a person, seconds."""
START_SECONDS = 300.0
LEAVING = {
    *("DeclineConsentAct", "GoOnFromGame", "EndGameAct", "CloseWindow", "PlayAgainAct", "ShowSettings", "ShowHelp"),
    *("EnlargePicture", "FollowRobot", "FitMap", "SwitchSound"),
}
"""Acts that end the game, or that change nothing in it."""
MEGABYTE = 1 << 20
TICKS = os.sysconf("SC_CLK_TCK")


@dataclass
class Measured:
    """Measurements of all people.

    Attributes:
        times: seconds from each act to the page with its effect.
        stalls: number of acts without a page within `STALL`.
        errors: errors, and the number of each.
        acts: number of acts.
        playing: number of people in a game.
        games: number of games that ended.
    """

    times: list[float] = field(default_factory=list)
    stalls: int = 0
    errors: dict[str, int] = field(default_factory=dict)
    acts: int = 0
    playing: int = 0
    games: int = 0

    def add(self, seconds: float) -> None:
        """Count an act, and the time to the page with its effect."""
        self.acts += 1
        if seconds < STALL:
            self.times.append(seconds)
        else:
            self.stalls += 1

    def blame(self, error: BaseException) -> None:
        """Count an error."""
        name = f"{type(error).__name__}: {error}"[:80]
        self.errors[name] = self.errors.get(name, 0) + 1


WATCH_REPLIES = """
window.replies = 0;
const Plain = window.WebSocket;
window.WebSocket = class extends Plain {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data }) => {
      if (String(data).includes('"reply":true')) requestAnimationFrame(() => setTimeout(() => (window.replies += 1)));
    });
  }
};
"""
"""JavaScript that counts the painted pages with the effect of an act."""
ACT = """
(async () => {
  const shown = (selector) => [...document.querySelectorAll(selector)].filter(
    (each) => each.checkVisibility() && !each.disabled && each.getAttribute("aria-disabled") !== "true");
  const offered = [
    "dialog.question[open] footer button", ".names [role=option][aria-selected=false]", ".pops footer button",
    ".waiting button", ".tile, .card .face[aria-pressed=false]"].map(shown).find((each) => each.length);
  if (!offered) return null;
  const before = window.replies, began = performance.now();
  offered[Math.floor(CHOICE * offered.length)].click();
  while (window.replies === before && performance.now() - began < STALL)
    await new Promise((done) => setTimeout(done, 2));
  return (performance.now() - began) / 1000;
})()
"""
"""JavaScript that presses a button, and returns the seconds until its effect is painted; null without a button."""


class ChromiumPerson:
    """Person in Chromium, in a thread of this program, who plays one game; arguments as for `Person`."""

    def __init__(self, port: int, chosen: random.Random, measured: "Measured") -> None:
        self._port, self._chosen, self._measured = port, chosen, measured
        self._left = threading.Event()

    async def play(self) -> None:
        """Play until cancelled."""
        playing = asyncio.create_task(asyncio.to_thread(self._play))
        try:
            await asyncio.shield(playing)
        finally:
            self._left.set()
            await playing

    def _play(self) -> None:
        try:
            with Chromium() as browser:
                browser.open(f"http://127.0.0.1:{self._port}/", WATCH_REPLIES)
                main = "document.querySelector('.reading button.main:not([disabled])')"
                while not browser.evaluate("document.querySelector('.tile') !== null"):
                    browser.evaluate(f"{main}?.click()")
                    self._left.wait(0.5)
                self._measured.playing += 1
                while not self._left.wait(self._chosen.uniform(*THINKING)):
                    act = ACT.replace("CHOICE", f"{self._chosen.random()}").replace("STALL", f"{1000 * STALL}")
                    took = browser.evaluate(act)
                    if took is not None:
                        self._measured.add(took)
        except (OSError, RuntimeError, TimeoutError) as error:
            self._measured.blame(error)


class Person:
    """Program that plays one game after the other, each time as another person.

    Args:
        port: port of the server.
        chosen: source of random numbers.
        measured: measurements of all people.
        pages: number of pages before the game.
    """

    def __init__(self, port: int, chosen: random.Random, measured: Measured, pages: int) -> None:
        self._port, self._chosen, self._measured, self._pages = port, chosen, measured, pages

    async def play(self) -> None:
        """Play until cancelled."""
        while True:
            browser = BrowserClient(self._port)
            try:
                await asyncio.to_thread(browser.load)
                await browser.open()
                await self._take_part(browser)
            except (OSError, TimeoutError, LookupError, AssertionError) as error:
                self._measured.blame(error)
                await asyncio.sleep(1.0)
            finally:
                await browser.close()

    async def _take_part(self, browser: BrowserClient) -> None:
        for _ in range(self._pages):
            await browser.press_button()
        await browser.until(lambda: browser.tree.get("phase") == "playing", START_SECONDS)
        self._measured.playing += 1
        try:
            while browser.tree.get("phase") == "playing":
                await asyncio.sleep(self._chosen.uniform(*THINKING))
                await self._act(browser)
        finally:
            self._measured.playing -= 1
        self._measured.games += 1
        if ending := browser.tree.get("ending"):
            await asyncio.sleep(1.0)  # An answer right after a change of the page is not accepted.
            await browser.act(ending["buttons"][0]["act"])
            await asyncio.sleep(1.0)

    async def _act(self, browser: BrowserClient) -> None:
        """Do one act, and measure the time to the page with its effect."""
        offered = [each for each in offers(front(browser.tree)) if each["act"] not in LEAVING]
        if not offered:
            return
        replies, began = browser.replies, time.monotonic()
        browser.texts.clear()
        await browser.act(self._chosen.choice(offered))
        while browser.replies == replies and time.monotonic() - began < STALL:
            await browser.received()
        self._measured.add(time.monotonic() - began)


def front(tree: Mapping[str, object]) -> object:
    """Return the part of a page that a person would use now: a pop-up if there is one."""
    return tree["question"] or tree["treasure"] or tree["dialogue"] or [tree["cards"], tree["tiles"], tree["waiting"]]


def offers(part: object) -> Iterator[dict[str, object]]:
    """Yield the acts of all buttons that are enabled."""
    if isinstance(part, dict):
        if part.get("enabled") and not part.get("pending") and isinstance(part.get("act"), dict):
            yield part["act"]
        elif isinstance(part.get("pick"), dict) and not part.get("picked"):
            yield part["pick"]
        for each in part.values():
            yield from offers(each)
    elif isinstance(part, list):
        for each in part:
            yield from offers(each)


@contextmanager
def server(study: Path, recorded: Path, games: int) -> Iterator[int]:
    """Start a server; yield its port. All its games end with it.

    Args:
        study: folder of the study, or study file.
        recorded: folder of the recordings.
        games: greatest number of games.
    """
    log = study.parent / "server.txt"
    with log.open("wb") as output:
        program = subprocess.Popen(
            [*PROGRAM, "serve", str(study), "--port", "0", "--games", str(games), "--bags", str(recorded)],
            stdout=output,
            stderr=output,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"},
        )
        try:
            while (found := re.search(r"Open http://127\.0\.0\.1:(\d+)/", log.read_text())) is None:
                if program.poll() is not None:
                    sys.exit(f"The server did not start: {log.read_text()}")
                time.sleep(0.1)
            yield int(found[1])
        finally:
            program.terminate()
            program.wait()
            for process in processes(recorded):
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)


def processes(recorded: Path) -> list[int]:
    """Return the processes of all running games of the server with this folder of recordings."""
    games = RunningGames.of(recorded)
    return [address.process for key in games if (address := games.address(key)) is not None]


def family(process: int) -> Iterator[int]:
    """Yield a process and its descendants, such as the copies of a worker."""
    yield process
    with suppress(OSError):
        for child in Path(f"/proc/{process}/task/{process}/children").read_text().split():
            yield from family(int(child))


def cpu_seconds(process: int) -> float:
    """Return the processor time of a process."""
    with suppress(OSError):
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS
    return 0.0


def memory(process: int) -> int:
    """Return the memory of a process and its descendants in bytes; shared memory is divided among its users."""
    total = 0
    for each in family(process):
        with suppress(OSError):
            text = Path(f"/proc/{each}/smaps_rollup").read_text()
            found = re.search(r"^Pss:\s+(\d+) kB", text, re.MULTILINE)
            total += 0 if found is None else int(found[1]) * 1024
    return total


@dataclass(frozen=True)
class Trial:
    """Result of one trial.

    Attributes:
        games: number of games at the same time.
        seats: number of people in each game.
        measured: measurements of the people.
        cores: processor time per second of a game, of the gateway, and of the people's programs.
        game_memory: bytes of a game.
        gateway_memory: bytes of the gateway.
    """

    games: int
    seats: int
    measured: Measured
    cores: tuple[float, float, float]
    game_memory: float
    gateway_memory: int

    @property
    def p95(self) -> float:
        """95th percentile of the time from an act to the page with its effect, seconds."""
        times = self.measured.times
        return statistics.quantiles(times, n=20, method="inclusive")[-1] if len(times) > 1 else float("inf")

    @property
    def holds(self) -> bool:
        """True if the time is within the bound, and there is no error and no stall."""
        return self.p95 < BOUND and not self.measured.errors and not self.measured.stalls

    def rows(self) -> Iterator[tuple[str, str]]:
        """Yield the rows of a table."""
        measured, (game, gateway, people) = self.measured, self.cores
        times = sorted(measured.times) or [float("inf")]
        yield "games at the same time", f"{self.games}"
        yield "people in each game", f"{self.seats}"
        yield "acts", f"{measured.acts}"
        yield "act to page, median", f"{1000 * statistics.median(times):.0f} ms"
        yield "act to page, 95 %", f"{1000 * self.p95:.0f} ms (bound: {1000 * BOUND:.0f} ms)"
        yield "act to page, longest", f"{1000 * times[-1]:.0f} ms"
        yield "stalls", f"{measured.stalls}"
        yield "errors", ", ".join(f"{name} ({count})" for name, count in measured.errors.items()) or "0"
        yield "games ended", f"{measured.games}"
        yield "memory of a game", f"{self.game_memory / MEGABYTE:.0f} MB"
        yield "memory of the gateway", f"{self.gateway_memory / MEGABYTE:.0f} MB"
        yield "processor time of a game", f"{100 * game:.1f} % of a core"
        yield "processor time of the gateway", f"{100 * gateway:.1f} % of a core"
        yield "processor time of the people's programs", f"{100 * people:.1f} % of a core"
        share = game + gateway / self.games
        for cores in (2, 16, 64):
            yield f"games on {cores} cores at 80 % of their time", f"{int(0.8 * cores / share) if share else 0}"


async def trial(study: Path, recorded: Path, port: int, games: int, options: argparse.Namespace) -> Trial:
    """Let people play for some time."""
    measured, people, seconds = Measured(), games * options.seats, 60 * options.minutes
    pages = 2 if options.seats == 1 else 1
    visitors: list[ChromiumPerson | Person] = []
    for each in range(people):
        chosen = random.Random(options.seed + each)
        in_browser = each < options.browsers
        visitors.append(ChromiumPerson(port, chosen, measured) if in_browser else Person(port, chosen, measured, pages))
    players = [asyncio.create_task(each.play()) for each in visitors]
    began = time.monotonic()
    while measured.playing < people and time.monotonic() - began < START_SECONDS:
        await asyncio.sleep(0.1)
    # Only the time in which everybody plays is measured.
    measured.times.clear()
    measured.acts = measured.stalls = 0
    workers, gateway = processes(recorded), gateway_of(study)
    before, began, own = (
        {each: cpu_seconds(each) for each in (*workers, gateway)},
        time.monotonic(),
        time.process_time(),
    )
    await asyncio.sleep(seconds)
    passed = time.monotonic() - began
    spent = {each: cpu_seconds(each) - cpu for each, cpu in before.items() if cpu_seconds(each) > cpu}
    programs = (time.process_time() - own) / passed
    game = statistics.fmean([spent[each] for each in workers if each in spent] or [0.0]) / passed
    now = processes(recorded)
    result = Trial(
        games,
        options.seats,
        measured,
        (game, spent.get(gateway, 0.0) / passed, programs),
        statistics.fmean(map(memory, now)) if now else 0.0,
        memory(gateway),
    )
    for player in players:
        player.cancel()
    await asyncio.gather(*players, return_exceptions=True)
    return result


def gateway_of(study: Path) -> int:
    """Return the process of the server of a study, which its parent process starts again if it dies."""
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            words = path.read_bytes().split(b"\0")
            parent = int(path.with_name("stat").read_text().rpartition(")")[2].split()[1])
            if b"serve" in words and str(study).encode() in words and parent != os.getpid():
                return int(path.parent.name)
    raise LookupError("the server has ended")


def write_study(folder: Path, options: argparse.Namespace) -> tuple[Path, Path]:
    """Write the study; return its path, and the folder of its recordings."""
    if options.seats > 1:
        study = folder / "team.yaml"
        robots = [[*range(each + 1, options.robots + 1, options.seats)] for each in range(options.seats)]
        seats = "\n".join(f"  - {{name: person-{each + 1}, robots: {own}}}" for each, own in enumerate(robots))
        study.write_text(TEAM.format(map=options.map, robots=options.robots, seats=seats))
        return study, folder / "served"
    study = folder / "study"
    study.mkdir()
    (study / "welcome.txt").write_text("You play one game.\n")
    seconds = int(60 * options.minutes) + 600
    text = STUDY.format(map=options.map, robots=options.robots, seconds=seconds)
    (study / "experiment.yaml").write_text(text)
    return study, study


def try_games(options: argparse.Namespace, games: int) -> Trial:
    """Measure one number of games, and print the table."""
    with tempfile.TemporaryDirectory(prefix="thbridge-trial-", dir=options.folder) as folder:
        study, recorded = write_study(Path(folder), options)
        with server(study, recorded, games) as port:
            result = asyncio.run(trial(study, recorded, port, games, options))
    rows = [*result.rows()]
    width = max(len(name) for name, _ in rows)
    print("\n".join(f"{name:{width}}  {value}" for name, value in rows), flush=True)
    print(flush=True)
    return result


def find(options: argparse.Namespace) -> bool:
    """Print the greatest number of games within the bound; return False if there is none."""
    good, bad = 0, None
    games = options.games
    while bad is None or bad - good > max(good // 10, 1):
        if try_games(options, games).holds:
            good = games
        else:
            bad = games
        games = 2 * good if bad is None else (good + bad) // 2
        if games == 0:
            break
    print(f"This machine holds {good} games: thbridge serve --games {good}")
    return good > 0


def main() -> None:
    """Run the trials."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--games", type=int, default=42, help="number of games; with --find, of the first trial")
    parser.add_argument("--seats", type=int, default=1, help="people in each game")
    parser.add_argument("--browsers", type=int, default=0, help="number of people who use Chromium")
    parser.add_argument("--minutes", type=float, default=5.0, help="minutes in which all people play")
    parser.add_argument("--find", action="store_true", help="find the greatest number of games within the bound")
    parser.add_argument("--map", default="arena8", help="map of the games")
    parser.add_argument("--robots", type=int, default=3, help="robots in each game")
    parser.add_argument("--seed", type=int, default=1, help="seed of the people's choices")
    parser.add_argument("--folder", help="folder for the recordings, which are deleted")
    options = parser.parse_args()
    sys.exit(0 if (find(options) if options.find else try_games(options, options.games).holds) else 1)


if __name__ == "__main__":
    main()
