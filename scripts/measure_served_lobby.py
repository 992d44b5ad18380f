"""Let a crowd take part in a served study with games of several people, and print a table of waiting times.

Run this script from the project's folder: `.venv/bin/python scripts/measure_served_lobby.py --size 4`.
It starts `thbridge serve` with a study: consent, a form, a game of 2 or 4 people, and a form. 90 people come within a
minute, each with a browser. A tenth of them leaves at any moment: half of these close the page, and half stop by the
button. Then the script checks the log, the pages of all people, the recordings and the export. It prints a sentence for
each fault, and the exit code is 1 if there is one.

`scripts/measure_lobby.py` simulates the same crowd without a server.
"""

import argparse
import asyncio
import hashlib
import random
import statistics
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.support.programs.browser_person import BrowserPerson, Manner  # noqa: E402 - it is next to the tests
from tests.support.programs.processes import run_thbridge  # noqa: E402
from tests.support.studies.served_program import ServedProgram  # noqa: E402
from thbridge.experiment.design.lobby import LeavingRule, WaitRule  # noqa: E402
from thbridge.experiment.folder import ExperimentFolder  # noqa: E402
from thbridge.experiment.groups import GroupGame  # noqa: E402
from thbridge.experiment.lobby import SeatHolder  # noqa: E402
from thbridge.experiment.progress import Progress, Run  # noqa: E402
from thbridge.experiment.rehearsal.people import SimulatedPeople  # noqa: E402
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState  # noqa: E402

ARRIVALS, STAY, READING = 60.0, 45.0, 3.0
"""Seconds: all people arrive within the first time; people who leave do so within the second time after their arrival;
the third is the longest time for a page."""
GRACE, PAGE_GRACE = 15.0, 30.0
"""Seconds for which a person may be absent from a game, and from a page."""
LONGEST = 420.0
"""Seconds after which all people must have reached the end."""
REPLAYED = 3
"""Number of games that are replayed."""
SEATS = ("driver", "namer", "guide", "scout")
STUDY = """\
title: A crowd in the lobby
seed: 3
base:
  map: practice
  templates: practice
  robots: {size}
  rate: {rate}
  server: {{port: 0}}
  seats: [{seats}]
  team: {{agreement: {{end: one}}}}
quota: {quota}
presence: {{grace: {grace}, page_grace: {page_grace}, then: end}}
lobby: {{wait: {wait}, then: {then}, leaving: {leaving}, incomplete_counts: true}}
recruiting: {{endings: {{complete: COMPLETE, no_group: NO-GROUP, ended_early: EARLY, timed_out: AWAY}}}}
steps:
  - {{step: consent, text: consent.txt}}
  - {{step: form, form: before.yaml, name: before}}
  - {{step: trial, name: game, max_seconds: {seconds}}}
  - {{step: form, form: after.yaml, name: after}}
"""
FORM = """\
title: {title}
items:
  - {{id: sure, text: How sure are you?, scale: likert, points: 7, low: not at all, high: very}}
"""


@dataclass
class Guest:
    """Person of the crowd.

    Attributes:
        name: id at the recruiting service.
        browser: the person at a browser.
        arrives: seconds until they come.
        leaves: seconds after which they leave, or None.
        stops: True to leave by the button, False to close the page.
        left_at: kind of the page on which they left; empty if they did not.
        last: heading of their last page; empty if they did not reach it.
    """

    name: str
    browser: BrowserPerson
    arrives: float
    leaves: float | None
    stops: bool
    left_at: str = field(default="", init=False)
    last: str = field(default="", init=False)

    async def take_part(self) -> None:
        """Come, go through the study, and leave if it is time."""
        await asyncio.sleep(self.arrives)
        going = asyncio.create_task(self.browser.go_through())
        try:
            if self.leaves is not None and not (await asyncio.wait((going,), timeout=self.leaves))[0]:
                self.left_at = self.browser.shown or "text"
                # The first page has no button to stop.
                self.stops = self.stops and self.browser.has_begun
                if not self.stops:
                    return
                await self.browser.stop()
            self.last = await going
        finally:
            going.cancel()
            with suppress(asyncio.CancelledError):
                await going
            await self.browser.lose_connection()


def write_study(folder: Path, options: argparse.Namespace) -> ExperimentFolder:
    """Write the study."""
    folder.mkdir()
    seats = ", ".join(f"{{name: {name}, robots: [{robot}]}}" for robot, name in enumerate(SEATS[: options.size], 1))
    (folder / "experiment.yaml").write_text(
        STUDY.format(
            size=options.size,
            rate=options.rate,
            seats=seats,
            quota=2 * options.people,
            grace=GRACE,
            page_grace=PAGE_GRACE,
            wait=options.wait,
            then=options.then,
            leaving=options.leaving,
            seconds=options.seconds * options.rate,
        )
    )
    (folder / "consent.txt").write_text("We record what you do.\n")
    for name, title in (("before", "Before the game"), ("after", "After the game")):
        (folder / f"{name}.yaml").write_text(FORM.format(title=title))
    return ExperimentFolder(folder)


def crowd(port: int, folder: ExperimentFolder, options: argparse.Namespace) -> list[Guest]:
    """Return all people. One of ten ends the game early; the others play until its time is up."""
    drawn, design = random.Random(options.seed), folder.read()
    leaving = {*drawn.sample(range(options.people), max(options.people // 10, 1))}
    faultless, guests = SimulatedPeople(drop_out=0.0), []
    for number in range(options.people):
        name = f"guest-{number}"
        manner = Manner(faultless, acts=8, ends=number % 10 == 0, reads=READING, says=f"I am {name}.")
        person = BrowserPerson(port, design, manner, options.seed + number, f"?PROLIFIC_PID={name}")
        leaves = drawn.uniform(0.0, STAY) if number in leaving else None
        guests.append(Guest(name, person, drawn.uniform(0.0, ARRIVALS), leaves, drawn.random() < 0.5))
    return guests


async def visit(guests: Sequence[Guest], folder: ExperimentFolder) -> None:
    """Let all people take part, and wait until the runs of those who closed the page have ended."""
    visits = [asyncio.create_task(guest.take_part()) for guest in guests]
    _, late = await asyncio.wait(visits, timeout=LONGEST)
    for each in late:
        each.cancel()
    for error in await asyncio.gather(*visits, return_exceptions=True):
        if isinstance(error, Exception):
            raise error
    end = time.monotonic() + 2.0 * PAGE_GRACE
    while time.monotonic() < end and any(run.state is RunState.UNDER_WAY for run in read(folder).runs.values()):
        await asyncio.sleep(1.0)


def read(folder: ExperimentFolder) -> Progress:
    """Return the progress of the study."""
    return Progress(folder.read()).after(folder.entries())


# Checks


def faults(folder: ExperimentFolder, guests: Sequence[Guest], options: argparse.Namespace) -> Iterator[str]:
    """Yield a sentence about each fault."""
    progress = read(folder)
    for guest in guests:
        yield from faults_of_guest(guest, progress, options.then)
    for game in progress.groups.values():
        yield from faults_of_holders(game, options)
    yield from faults_of_recordings(folder, progress, options.seed)
    yield from faults_of_export(folder, progress, guests)


def faults_of_guest(guest: Guest, progress: Progress, then: WaitRule) -> Iterator[str]:
    """Yield faults of a person's way through the study."""
    run = progress.run_of(guest.name)
    if run is None:
        if not guest.left_at:
            yield f"{guest.name} did not get a place; the last page was {guest.browser.pages[-1:]}."
        return
    who = f"{guest.name} ({run.participant}, {run.state})"
    if run.state is RunState.UNDER_WAY:
        yield f"{who} is still in step {run.step}; the page is {guest.browser.shown or 'unknown'}."
    if guest.left_at and not guest.stops:
        return
    if not guest.last:
        yield f"{who} did not reach the last page; the page is {guest.browser.shown or 'unknown'}."
    elif run.unmatched:
        if then is WaitRule.PROGRAM:
            yield f"{who} got no game although the rule is {then}."
        if (guest.browser.ending, guest.browser.code) != ("NO-GROUP", run.code) or not run.code:
            yield f"{who} waited in vain, and saw the codes {guest.browser.ending!r} and {guest.browser.code!r}."
    elif guest.left_at:
        if (run.state, guest.browser.ending) not in {(RunState.LEFT, "EARLY"), (RunState.COMPLETE, "COMPLETE")}:
            yield f"{who} stopped, and saw the code {guest.browser.ending!r}."
    elif run.state is not RunState.COMPLETE or (guest.browser.ending, guest.browser.code) != ("COMPLETE", run.code):
        yield f"{who} saw the codes {guest.browser.ending!r} and {guest.browser.code!r}: {run.reason}"
    elif not run.seats or [*run.scores] != [*run.seats]:
        yield f"{who} is complete without a game."


def faults_of_holders(game: GroupGame, options: argparse.Namespace) -> Iterator[str]:
    """Yield faults of the holders of a game's seats at the start."""
    holders = Counter(game.began.values())
    people, programs = holders[SeatHolder.PERSON], holders[SeatHolder.PROGRAM]
    least = {WaitRule.PAY: options.size, WaitRule.FEWER: 2, WaitRule.PROGRAM: 1}[options.then]
    if people < least or (programs > 0) != (options.then is WaitRule.PROGRAM and people < options.size):
        yield f"{game.group} began with {people} people and {programs} programs."


def faults_of_recordings(folder: ExperimentFolder, progress: Progress, seed: int) -> Iterator[str]:
    """Yield faults of the recordings, and of the log's events about them."""
    played: dict[str, list[LoggedEvent]] = {}
    for entry in folder.entries():
        if isinstance(entry, LoggedEvent) and entry.event.kind == EventKind.GAME_PLAYED:
            played.setdefault(str((entry.event.data or {})["group"]), []).append(entry)
    for game in progress.groups.values():
        events = played.get(game.group, [])
        remaining = [each for each in game.people.values() if progress.runs[each].state is not RunState.LEFT]
        logged = [event.event.participant for event in events]
        if len({*logged}) != len(logged) or not {*remaining} <= {*logged}:
            yield f"{game.group} was logged for {', '.join(logged)}, and had {', '.join(remaining)} at the end."
        if len({(str(data["bag"]), str(data["sha256"])) for event in events if (data := event.event.data)}) > 1:
            yield f"{game.group} has several recordings in the log."
        if game.played is not None:
            bag = folder.bag_named(game.played["bag"])
            if not bag.is_file() or hashlib.sha256(bag.read_bytes()).hexdigest() != game.played["sha256"]:
                yield f"{bag} is missing, or is not the file of the log."
    bags = [folder.bag_named(game.played["bag"]) for game in progress.groups.values() if game.played is not None]
    if len({*bags}) != len(bags):
        yield "Several groups have the same recording."
    for bag in random.Random(seed).sample(bags, min(REPLAYED, len(bags))):
        replayed = run_thbridge(folder.root, "replay", str(bag))
        if replayed.returncode != 0:
            yield f"{bag} is not replayed equally: {replayed.stdout} {replayed.stderr}"


def faults_of_export(folder: ExperimentFolder, progress: Progress, guests: Sequence[Guest]) -> Iterator[str]:
    """Yield faults of the exported tables: they must name each person in the seat and the group that they have seen."""
    export = folder.root / "exports" / "crowd"
    exported = run_thbridge(folder.root, "study", "export", ".", "--to", str(export))
    if exported.returncode != 0:
        yield f"The study cannot be exported: {exported.stderr}"
        return
    seats = pd.read_parquet(export / "tables" / "seats.parquet")
    rows = {(row.participant, row.group, row.seat) for row in seats[seats.participant.notna()].itertuples()}
    logged = {
        (run.participant, taken.group, taken.seat) for run in progress.runs.values() for taken in run.seats.values()
    }
    if rows != logged or len(rows) != seats.participant.notna().sum():
        yield f"The table seats has other people than the log: {sorted(rows ^ logged)}"
    trials = pd.read_parquet(export / "tables" / "trials.parquet")
    for row in trials[trials.bag.notna()].itertuples():
        if (row.participant, row.group, row.seat) not in logged:
            yield f"The table trials has {row.participant} in {row.group}, {row.seat}."
    by_text = {f"I am {guest.name}.": progress.run_of(guest.name) for guest in guests}
    for guest in guests:
        run = progress.run_of(guest.name)
        for seat in guest.browser.seats:
            if run is None or seat not in {taken.seat for taken in run.seats.values()}:
                yield f"{guest.name} played as {seat}, but the log has another seat."
        for said in guest.browser.heard:
            author = by_text[said]
            if run is None or author is None or groups_of(run) != groups_of(author):
                yield f"{guest.name} read {said!r}, but the log has other groups."


def groups_of(run: Run) -> set[str]:
    """Return the groups of a person."""
    return {taken.group for taken in run.seats.values()}


# Table


def row(folder: ExperimentFolder, guests: Sequence[Guest], options: argparse.Namespace) -> Iterator[str]:
    """Yield the lines of the table."""
    progress = read(folder)
    games = progress.groups.values()
    stayed = [guest for guest in guests if not guest.left_at]
    waits = sorted(guest.browser.waited for guest in stayed) or [0.0]
    left = Counter(
        {"turn": "waiting", "game": "playing"}.get(each.left_at, "reading") for each in guests if each.left_at
    )
    matched = [run for guest in stayed if (run := progress.run_of(guest.name)) is not None]
    cells = {
        "game of": options.size,
        "at the end of a wait": options.then,
        "if a person leaves": options.leaving,
        "people": len(guests),
        "left: reading": left["reading"],
        "waiting": left["waiting"],
        "playing": left["playing"],
        "games": len(games),
        "with fewer people": sum({*game.began.values()} != {SeatHolder.PERSON} for game in games),
        "played": sum(bool(run.seats) for run in matched),
        "ended with thanks": sum(run.unmatched for run in matched),
        "wait: median (s)": f"{statistics.median(waits):.1f}",
        "95 % (s)": f"{waits[int(0.95 * (len(waits) - 1))]:.1f}",
        "longest (s)": f"{waits[-1]:.1f}",
    }
    yield f"| {' | '.join(cells)} |"
    yield f"|{'---|' * len(cells)}"
    yield f"| {' | '.join(map(str, cells.values()))} |"


def measure(options: argparse.Namespace) -> list[str]:
    """Serve the study to the crowd, print the table, and return the faults."""
    with tempfile.TemporaryDirectory(prefix="thbridge-crowd-", dir=options.folder) as root:
        folder = write_study(Path(root, "study"), options)
        with ServedProgram(folder.root, "--games", str(options.games)) as server:
            guests = crowd(server.port, folder, options)
            asyncio.run(visit(guests, folder))
            server.program.stop()
            printed = server.program.text
        print("\n".join(row(folder, guests, options)), flush=True)
        found = [*faults(folder, guests, options)]
        if "Traceback" in printed:
            found.append(f"The server printed: {printed[printed.index('Traceback') :][:2000]}")
        return found


def option_parser() -> argparse.ArgumentParser:
    """Return the parser of the options."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=int, default=90, help="number of people")
    parser.add_argument("--size", type=int, default=2, choices=(2, 4), help="number of seats of a game")
    parser.add_argument("--then", type=WaitRule, default=WaitRule.PAY, help="rule for the end of a wait")
    parser.add_argument("--wait", type=float, default=60.0, help="longest wait for others, s")
    parser.add_argument("--leaving", type=LeavingRule, default=LeavingRule.END, help="rule for people who leave a game")
    parser.add_argument("--games", type=int, default=12, help="greatest number of games at the same time")
    parser.add_argument("--seconds", type=float, default=20.0, help="longest duration of a game, s")
    parser.add_argument("--rate", type=float, default=1.0, help="simulated seconds per second")
    parser.add_argument("--seed", type=int, default=1, help="random seed of arrivals, departures and answers")
    parser.add_argument("--folder", help="folder for the study, which is deleted")
    return parser


def main() -> None:
    """Measure one size of games."""
    found = measure(option_parser().parse_args())
    print("\n".join(found), flush=True)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
