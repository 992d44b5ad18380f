"""Status of a sweep, read from its folder. Other programs may be running the sweep at the same time."""

import math
import os
from collections import Counter
from collections.abc import Container, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import msgspec

from thbridge.batch.chunks import is_drawn
from thbridge.batch.ended_games import read_ended
from thbridge.batch.engines.batch_task import worker_name
from thbridge.batch.folder import read_manifest
from thbridge.batch.results import GameStatus, differing_games, game_faults, read_table, versions_in
from thbridge.batch.tasks import begun_game


@dataclass(frozen=True, slots=True)
class SweepStatus:
    """Status of a sweep.

    Attributes:
        games: number of games of the design.
        done: number of games with a result of any kind.
        missing: number of games without a result of any kind.
        running: number of missing games that workers are playing. Dead workers of this machine do not count.
        by_status: number of games by `GameStatus`.
        faults: sentences about failed and crashed games.
        drawn: number of games for repetition.
        verified: number of repeated games.
        differing: sentences about games with another result in the repetition.
        cpu_seconds: total processor time of all games, s.
        last_written: time of the newest file, seconds since 1970, or None if there is no file.
        rate: games per second, from the newest files, or None if unknown.
        seconds_left: remaining time at this rate, s, or None if unknown.
        versions: number of files, by the versions of the programs that wrote them.
    """

    games: int
    done: int
    missing: int
    running: int
    by_status: Mapping[str, int]
    faults: tuple[str, ...]
    drawn: int
    verified: int
    differing: tuple[str, ...]
    cpu_seconds: float
    last_written: float | None
    rate: float | None
    seconds_left: float | None
    versions: Mapping[str, int]


RECENT = 50
"""Number of newest files from which the rate is computed."""
A_BREAK = 600.0
"""The sweep counts as interrupted after this number of seconds without a new file."""


def status_of(root: Path) -> SweepStatus:
    """Read the status of a sweep. Raises BadFile if the folder has no sweep, or a file cannot be read."""
    folder, manifest = read_manifest(root)
    by_status, versions = Counter[str](), Counter[str]()
    faults, differing, written = list[str](), list[str](), list[tuple[float, int]]()
    drawn = verified = running = 0
    cpu = 0.0
    for chunk in manifest.chunks:
        drawn += sum(is_drawn("verified", manifest.one_verified_in, chunk.condition, seed) for seed in chunk.seeds)
        path, again = folder.games(chunk), folder.verified(chunk)
        if path.exists():
            rows = read_table(path, ["status", "cpu_seconds"]).to_pylist()
            written.append((path.stat().st_mtime, len(rows)))
            versions[versions_in(path)] += 1
            for row in rows:
                by_status[row["status"]] += 1
                cpu += row["cpu_seconds"]
            faults += game_faults(path, chunk.condition)
        else:
            kept = folder.ended(chunk)
            ended = read_ended(folder, kept, manifest.versions)
            running += _is_running(folder.attempts(chunk), ended)
            with suppress(FileNotFoundError):  # The chunk has just ended, or no game has ended.
                written.append((kept.stat().st_mtime, len(ended)))
            by_status.update(game.status for game in ended.values())
            cpu += math.fsum(game.cpu_seconds for game in ended.values())
        if again.exists():
            verified += read_table(again, ["seed"]).num_rows
            differing += differing_games(again, chunk.condition)
    done = by_status.total()
    rate = _rate(sorted(written))
    return SweepStatus(
        games=manifest.games,
        done=done,
        missing=manifest.games - done,
        running=running,
        by_status={status.value: by_status[status.value] for status in GameStatus},
        faults=tuple(faults),
        drawn=drawn,
        verified=verified,
        differing=tuple(differing),
        cpu_seconds=round(cpu, 1),
        last_written=max(written)[0] if written else None,
        rate=rate,
        seconds_left=None if rate is None else round((manifest.games - done) / rate, 1),
        versions={_versions_text(each): count for each, count in versions.items()},
    )


def _is_running(journal: Path, ended: Container[int]) -> bool:
    """Return True if a worker is playing a game of a chunk. Workers on other machines count as running."""
    begun = begun_game(journal)
    if begun is None or begun[1] in ended:
        return False
    host, _, process = begun[0].rpartition(":")
    if host != worker_name().rpartition(":")[0] or not process.isdigit():
        return True
    try:
        os.kill(int(process), 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        pass
    return True


def _rate(written: list[tuple[float, int]]) -> float | None:
    """Return the number of games per second. `written` has the time and number of games of each file, oldest first."""
    recent = written[-RECENT:]
    for place in range(len(recent) - 1, 0, -1):
        if recent[place][0] - recent[place - 1][0] > A_BREAK:
            recent = recent[place:]
            break
    if len(recent) < 2 or recent[-1][0] <= recent[0][0]:
        return None
    return round(sum(games for _, games in recent[1:]) / (recent[-1][0] - recent[0][0]), 4)


def _versions_text(versions: str) -> str:
    try:
        named = msgspec.json.decode(versions, type=dict[str, str])
    except (msgspec.MsgspecError, RecursionError):
        return "unknown versions"
    return ", ".join(f"{name} {version}" for name, version in named.items())
