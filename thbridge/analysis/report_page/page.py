"""HTML page of a session's report, complete in one file: figures are embedded as SVG."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from sim.common.grid import OccupancyGrid
from sim.common.robot_colors import robot_color
from sim.numerics.float_array import FloatArray
from thbridge.analysis.plot.figures import energy, error, timeline
from thbridge.analysis.plot.paths import paths
from thbridge.analysis.plot.style import PAGE, FigureFormat, FigureStyle, clock
from thbridge.analysis.report.builder import gather_games
from thbridge.analysis.report.dialogues import ENDS, RecordedDialogues, RecordedGame
from thbridge.analysis.report.report import Report, Track, label_of
from thbridge.analysis.report.tracks import FOUND_BY_NAME, TrajectoryTopics
from thbridge.files.progress import Tell, followed, untold
from thbridge.recording.bag.reading.reader import info, messages


def build_report(
    bag: Path, grid: OccupancyGrid | None = None, tell: Tell = untold, named: TrajectoryTopics = FOUND_BY_NAME
) -> str:
    """Return the report of a bag as HTML, with a part for each game; the same bag gives the same page.

    Args:
        bag: bag of thbridge or of other robots.
        grid: map to use instead of the bag's own.
        `tell`: receives the progress.
        named: topics of a robot's trajectories, if the user named them.

    Raises:
        BadFile: the bag cannot be read; the message has a remedy.
    """
    games = gather_games(followed(messages(bag), "messages", info(bag).messages, tell), named)
    count = len(games)
    return _page((games.pop(0).report(grid) for _ in range(count)), count, bag.name, tell)


def render(games: Sequence[Report], name: str) -> str:
    """Return the reports of a recording's games as HTML.

    Args:
        games: reports to show, at least one.
        name: name of the bag, for the title.
    """
    return _page(iter(games), len(games), name, untold)


def _page(reports: Iterator[Report], count: int, name: str, tell: Tell) -> str:
    """Return the page of `count` reports; only one report at a time is in memory."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))
    games: list[dict[str, object]] = []
    for done in range(count):
        tell("games drawn", done, count)
        games.append(_part(next(reports), count > 1))
    tell("games drawn", count, count)
    return template.render(name=name, games=games, clock=clock)


def _part(report: Report, several: bool) -> dict[str, object]:
    """Return the part of the page for one game; without a title if there is no other game."""
    title = f"Game {report.game}" if several else ""
    report = replace(report, tracks=tuple(map(_shown, report.tracks)))
    return {
        "title": title,
        # All large data have been drawn by now.
        "report": replace(report, tracks=(), grid=None),
        "sources": [(track.label, track.sources) for track in report.tracks],
        "figures": list(_figures(report, title)),
        "summary": _summary(report),
        "robots": [_robot_row(index, track) for index, track in enumerate(report.tracks)],
        "ways_made": [
            (made, track.label, label_of(made.robot))
            for made, track in sorted(
                ((made, track) for track in report.tracks for made in track.ways_made),
                key=lambda pair: (pair[0].start, pair[1].name),
            )
        ],
        "dialogues": _dialogues(report.dialogues),
        "points": [entry for entry in report.timeline if entry.points is not None],
    }


def _shown(track: Track) -> Track:
    """Return a track with only the data that figures of the page show. The other data are a large share of a track."""
    placed = len(track.truth) or len(track.estimate)
    nothing = np.empty((0, 4))
    return replace(track, speeds=nothing, commands=nothing, odometry=nothing if placed else track.odometry)


def _figures(report: Report, title: str) -> Iterator[dict[str, object]]:
    """Yield the figures that can be drawn."""
    for name, caption, make in _FIGURES:
        with PAGE.settings():
            figure = make(report, PAGE)
        if figure is not None:
            yield {"title": name, "caption": caption, "svg": _svg(figure, title + name)}


_FIGURES: tuple[tuple[str, str, Callable[[Report, FigureStyle], Figure | None]], ...] = (
    (
        "Paths",
        "Broad lines: true path. Narrow lines: path as the robot believed it. A ring marks the start, a dot the end. "
        "A line is interrupted where a robot was picked up and moved, or localized itself elsewhere. "
        "Yellow: obstacles at their first position; dotted: their paths.",
        paths,
    ),
    (
        "Localization error",
        "Distance and angle between the true pose and the pose that the robot believed. Shaded: two standard "
        "deviations that the localizer reports.",
        error,
    ),
    ("Energy", "Energy left of each robot.", energy),
    (
        "Timeline",
        "Bars: drives to a goal, with its room; pale bars did not reach the goal. Thin bars below: the robot makes way "
        "for the robot of that color. Diamonds: events of the game. Strokes at the bottom: utterances.",
        timeline,
    ),
)


def _summary(report: Report) -> list[tuple[str, str]]:
    """Return the numbers at the top of the page: label and value."""
    cards = [("Duration", f"{clock(report.duration)} min"), ("Robots", str(len(report.tracks)))]
    if report.tracks:
        cards.append(("Driven", f"{sum(track.distance for track in report.tracks):.1f} m"))
    if report.score is not None:
        cards.append(("Score", f"{report.score.score}"))
        cards.append(("Rooms visited", f"{report.score.visited} of {report.score.rooms}"))
    errors = [track.errors[:, 1] for track in report.tracks if len(track.errors)]
    if errors:
        cards.append(("Localization RMSE", f"{100 * _rms(np.concatenate(errors)):.1f} cm"))
    if report.inputs:
        cards.append(("Inputs", str(report.inputs)))
    return cards


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _robot_row(index: int, track: Track) -> dict[str, str]:
    unknown = "–"
    errors, energy = track.errors, track.energy
    arrived = sum(attempt.outcome == "arrived" for attempt in track.attempts)
    return {
        "name": track.label,
        "colour": robot_color(index),
        "distance": f"{track.distance:.1f}",
        "goals": f"{arrived} of {len(track.attempts)}" if track.attempts else unknown,
        "rmse": f"{100 * _rms(errors[:, 1]):.1f}" if len(errors) else unknown,
        "worst": f"{100 * errors[:, 1].max():.1f}" if len(errors) else unknown,
        "turn": f"{np.degrees(_rms(errors[:, 2])):.2f}" if len(errors) else unknown,
        "energy": f"{energy[0, 1]:.0f} → {energy[-1, 1]:.0f}" if len(energy) else unknown,
        "makes_way": f"{sum(made.end - made.start for made in track.ways_made):.1f}" if track.ways_made else unknown,
    }


def _dialogues(recorded: RecordedDialogues) -> dict[str, object] | None:
    """Return the part about argumentation dialogues: games by kind and opener, and moves by locution.

    Return None if there are no dialogues.
    """
    if not recorded.games:
        return None
    kinds = sorted({(game.kind, game.opener) for game in recorded.games})
    groups = [(kind, [game for game in recorded.games if (game.kind, game.opener) == kind]) for kind in kinds]
    locutions = dict.fromkeys(locution for _, locution in sorted(recorded.moves))
    asides = {
        "Questions asked": recorded.questions,
        "Advice overridden": recorded.overrides,
        "Misheard": recorded.misheard,
    }
    if recorded.strategy_faults:
        asides["Strategy failed"] = recorded.strategy_faults
    return {
        "ends": [end for end in ENDS if any(game.end == end for game in recorded.games)],
        "games": [(*kind, _games_row(games)) for kind, games in groups],
        "moves": [
            (locution, *(recorded.moves.get((speaker, locution), 0) for speaker in ("robot", "human")))
            for locution in locutions
        ],
        "asides": asides,
    }


def _games_row(games: Sequence[RecordedGame]) -> dict[str, object]:
    return {
        "count": len(games),
        "ends": {end: sum(game.end == end for game in games) for end in ENDS},
        "moves": sum(game.moves for game in games) / len(games),
        "challenges": max(game.challenges for game in games),
        "gave_in": {side: sum(game.gave_in == side for game in games) for side in ("robot", "human")},
    }


def _svg(figure: Figure, salt: str) -> Markup:
    """Return the figure as an SVG element; `salt` makes its ids different from the ids of other figures."""
    drawn = PAGE.rendered(figure, FigureFormat.SVG, salt, transparent=True).decode()
    # Safe: matplotlib escapes the texts in its files.
    return Markup(drawn[drawn.index("<svg") :])
