"""Content of the player's page from the report of a recording."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.common.robot_numbers import robot_name
from sim.numerics.float_array import FloatArray
from thbridge.analysis.plot.style import clock
from thbridge.analysis.report.report import GoalAttempt, Report, Track, index_in
from thbridge.dialogue.wording.texts import NamedRoom, Texts
from thbridge.files.map_files import MapRoom
from thbridge.hunt import events
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.seats import label_of
from thbridge.study.study_file import Study
from ui.model.shared.scene import decided
from ui.web.page.floor import FloorRoom, FloorShapes, outline
from ui.web.player.content import (
    EntryMark,
    PlayedEntry,
    PlayedGame,
    PlayedRobot,
    RobotDrive,
    RobotPhase,
    RoomChange,
)
from ui.web.player.curves import PlayedCurve, line, steps
from ui.web.player.words import EventWords, event_of

METER = 0.001
"""Unit of positions and position errors in the page, meters."""
RADIAN = 0.001
"""Unit of headings in the page."""
DEGREE = 0.01
"""Unit of heading errors in the page, degrees."""
ENERGY = 0.1
"""Unit of energy in the page."""
SIGMAS = 2.0
"""Half width of a band in standard deviations, as in the report."""
MOST_CELLS = 1_000_000
"""Maximum number of cells of a drawn map. The resolution of a larger map is halved until it fits."""
_OCCUPIED_FROM = 50
"""Occupancy from which a cell is drawn as a wall, percent; maps of other robots have values between 0 and 100."""
_POSE_TOLERANCES = (0.015, 0.015, 0.02)
_SAME_START = 1.0
"""Maximum time between the departure of a robot in the game and the start of its drive, seconds."""


@dataclass(frozen=True, slots=True)
class GameContext:
    """Facts about a recording that its games share: its study, if it is readable, and the words of the page."""

    study: Study | None
    texts: Texts


def played_game(report: Report, context: GameContext, several: bool) -> PlayedGame:
    """Return the content of one game; it has a title if the recording has several games."""
    texts, words = context.texts, EventWords(context.texts, report.rooms)
    title = texts.text("player.game", number=report.game or 1) if several else ""
    numbers = [index_in(track.name) for track in report.tracks]
    pages = {number: index for index, number in enumerate(numbers) if number is not None}
    entries = sorted(_entries(report, words, pages), key=lambda entry: entry.at)
    moves = [(at, event_of(event)) for at, event in report.events]
    robots = (_robot(track, number, moves, words) for track, number in zip(report.tracks, numbers, strict=True))
    scores = np.array([(at, record.score, record.visited) for at, record in report.scores]).reshape(-1, 3)
    return PlayedGame(
        title=title,
        duration=report.duration,
        summary=tuple(_summary(report, context)),
        robots=tuple(robots),
        entries=tuple(entries),
        rooms=tuple(_room_changes(moves)),
        score=steps(scores, (1.0, 1.0)) if len(scores) else None,
        room_count=0 if report.score is None else report.score.rooms,
        missing=report.missing,
    )


def floor_of(grid: OccupancyGrid, rooms: Sequence[MapRoom], names: RoomNames, study: Study) -> FloorShapes:
    """Return the shapes of a map.

    Args:
        grid: the map.
        rooms: rooms of the map, with their outlines; empty if they are unknown.
        names: names of the rooms.
        study: has the footprint of the robots.
    """
    cells, resolution = grid.cells, grid.resolution
    codes = np.where(cells >= _OCCUPIED_FROM, 1, np.where(cells >= 0, 0, 2))
    while codes.size > MOST_CELLS:
        codes, resolution = _halved(codes), 2.0 * resolution
    corners = [np.array(room.region, dtype=np.float64).reshape(-1, 2) for room in rooms]
    rows, cols = np.nonzero(codes != 2)
    if len(rows):
        edges = np.array([(x, y) for x in (cols.min(), cols.max() + 1) for y in (rows.min(), rows.max() + 1)])
        corners.append(grid.origin.transform(edges * resolution))
    known = np.concatenate(corners) if corners else np.array([[-1.0, -1.0], [1.0, 1.0]])
    (left, bottom), (right, top) = np.round(100.0 * np.array([known.min(axis=0), known.max(axis=0)])).astype(int)
    return FloorShapes(
        box=(int(left), int(bottom), int(right), int(top)),
        origin=(round(100.0 * grid.origin.x), round(100.0 * grid.origin.y), round(1000.0 * grid.origin.theta)),
        resolution=100.0 * resolution,
        walls=outline(codes == 1),
        unknown=outline(codes == 2),
        rooms=tuple(FloorRoom(each.room.people, names.name(each.room.people), _flat(each.region)) for each in rooms),
        footprint=_flat(study.world.footprint),
    )


def bare_floor(report: Report, study: Study) -> FloorShapes | None:
    """Return an empty floor around the paths of the robots, for a recording without a map; None without any path."""
    paths = [rows[:, 1:3] for track in report.tracks if (rows := _path(track)) is not None]
    if not paths:
        return None
    places = np.concatenate(paths)
    (left, bottom), (right, top) = (100.0 * np.array([places.min(axis=0) - 1.0, places.max(axis=0) + 1.0])).round()
    box = (int(left), int(bottom), int(right), int(top))
    return FloorShapes(box, (0, 0, 0), 1.0, "", "", (), _flat(study.world.footprint))


def obstacles_of(report: Report) -> tuple[tuple[int, ...], ...]:
    """Return the corners of the obstacles that never moved, centimeters."""
    return tuple(_flat(thing.outline.tolist()) for thing in report.things if len(thing.path) == 1)


def _summary(report: Report, context: GameContext) -> Iterator[tuple[str, str]]:
    texts, study = context.texts, context.study
    if study is not None:
        yield texts.text("player.study"), f"{study.map}, {study.templates}"
        yield texts.text("player.condition"), texts.text(f"player.condition_{study.dialogue.condition}")
    if report.session is not None:
        yield texts.text("player.seed"), str(report.session.seed)
    if report.score is not None:
        yield texts.text("player.score"), str(report.score.score)
        visited, rooms = report.score.visited, report.score.rooms
        yield texts.text("player.rooms_visited"), texts.text("player.rooms_of", visited=visited, rooms=rooms)
    yield texts.text("player.duration"), clock(report.duration)


def _entries(report: Report, words: EventWords, pages: Mapping[int, int]) -> Iterator[PlayedEntry]:
    """Yield the entries of a game; `pages` has the indices of robots in the page, by their index in the team."""
    for at, event in report.events:
        robot = None if event.robot is None else pages.get(event.robot)
        if (entry := words.entry(at, event, robot)) is not None:
            yield entry
    for at, said in report.utterances:
        yield words.utterance(at, said, pages.get(said.robot))
    started = (event_of(event) for _, event in report.events)
    seats = next((each.seats for each in started if isinstance(each, events.GameStarted)), ())
    for at, raised in report.team:
        if isinstance(raised, events.ObjectionRaised):
            yield words.objection(at, raised, label_of(seats, raised.seat), pages.get(raised.robot))
    for fault in report.timeline:
        if fault.kind in {"misheard", "strategy failed"}:
            robot = next(each for each in (*pages, 0) if robot_name(each) == fault.who)
            text = words.texts.text(f"player.{fault.kind.replace(' ', '_')}", robot=robot, text=fault.text)
            yield PlayedEntry(fault.time, EntryMark.FAILED, "", pages.get(robot), "", text)


Moves = Sequence[tuple[float, events.JournalEntry | None]]
"""Events of the game with their times, s; None for other events."""


def _room_changes(moves: Moves) -> Iterator[RoomChange]:
    for at, event in moves:
        match event:
            case events.RobotDeparted():
                yield RoomChange(at, event.room.people, "reserved")
            case events.RobotArrived():
                yield RoomChange(at, event.room.people, "visited")
            case events.MoveFailed():
                yield RoomChange(at, event.room.people, "unvisited")
            case events.TreasureIdentified() if event.room is not None:
                yield RoomChange(at, event.room.people, decided(event.points), event.points)


def _robot(track: Track, robot: int | None, moves: Moves, words: EventWords) -> PlayedRobot:
    own = [(at, event) for at, event in moves if robot is not None and getattr(event, "robot", None) == robot]
    poses = _path(track)
    error = np.column_stack((track.errors[:, :2], np.degrees(track.errors[:, 2])))
    band = np.column_stack((track.deviations[:, :2], np.degrees(track.deviations[:, 2])))
    band[:, 1:] *= SIGMAS
    drives = tuple(_drive(track.label if robot is None else robot, attempt, own, words) for attempt in track.attempts)
    return PlayedRobot(
        name=track.label if robot is None else words.texts.text("player.robot", robot=robot),
        pose=None if poses is None else _poses(poses),
        belief=_poses(track.estimate) if len(track.truth) and len(track.estimate) else None,
        energy=steps(track.energy, (ENERGY,)) if len(track.energy) else None,
        error=line(error, (METER, DEGREE), (0.002, 0.2)) if len(error) else None,
        deviation=steps(band, (METER, DEGREE)) if len(band) and len(error) else None,
        drives=drives,
        phases=tuple(_phases(own, words) if own else _phases_of_drives(track.attempts, words)),
    )


def _path(track: Track) -> FloatArray | None:
    """Return the poses at which the player shows a robot; None if the recording has none."""
    return next((rows for rows in (track.truth, track.estimate, track.odometry) if len(rows)), None)


def _poses(rows: FloatArray) -> PlayedCurve:
    continuous = np.column_stack((rows[:, :3], np.unwrap(rows[:, 3])))
    return line(continuous, (METER, METER, RADIAN), _POSE_TOLERANCES)


def _drive(robot: int | str, attempt: GoalAttempt, own: Moves, words: EventWords) -> RobotDrive:
    """Return a drive, with the room of the departure that started it."""
    texts = words.texts
    room = next(
        (
            event.room
            for at, event in own
            if isinstance(event, events.RobotDeparted) and abs(at - attempt.start) < _SAME_START
        ),
        None,
    )
    arrived = attempt.outcome == "arrived"
    goal: NamedRoom | str = texts.text("player.somewhere") if room is None else words.room(room)
    start, end = clock(attempt.start), clock(attempt.end)
    key = "player.drive" if arrived else "player.drive_failed"
    text = texts.text(key, robot=robot, room=goal, start=start, end=end)
    return RobotDrive(attempt.start, attempt.end, arrived, "" if room is None else str(room.people), text)


def _phases(own: Moves, words: EventWords) -> Iterator[RobotPhase]:
    """Yield the activities of a robot in the game."""
    now = RobotPhase(0.0, words.texts.text("player.phase_waiting"))
    yield now
    for at, event in own:
        match event:
            case events.RobotDeparted():
                now = _phase(at, "driving", words, event)
            case events.RobotArrived():
                now = _phase(at, "arrived", words, event)
            case events.MoveFailed():
                now = _phase(at, "failed", words, event, trouble=True)
            case events.ConditionChanged(condition=events.Condition.WELL):
                # The robot continues what it did before.
                yield replace(now, at=at)
                continue
            case events.ConditionChanged():
                yield RobotPhase(at, words.texts.text(f"player.phase_{event.condition}"), trouble=True)
                continue
            case _:
                continue
        yield now


def _phase(
    at: float,
    key: str,
    words: EventWords,
    event: events.RobotDeparted | events.RobotArrived | events.MoveFailed,
    trouble: bool = False,
) -> RobotPhase:
    return RobotPhase(at, words.texts.clause(f"player.phase_{key}", room=words.room(event.room)), trouble)


def _phases_of_drives(attempts: Iterable[GoalAttempt], words: EventWords) -> Iterator[RobotPhase]:
    """Yield the activities of a robot that is known only by its drives."""
    waiting, driving = (words.texts.text(f"player.phase_{key}") for key in ("waiting", "driving_somewhere"))
    for attempt in attempts:
        yield RobotPhase(attempt.start, driving)
        yield RobotPhase(attempt.end, waiting)


def _halved(codes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return a map at half the resolution. A cell is a wall if one of its parts is a wall, else free if one is free."""
    rows, cols = codes.shape
    even = np.pad(codes, ((0, rows % 2), (0, cols % 2)), constant_values=2)
    blocks = even.reshape(even.shape[0] // 2, 2, even.shape[1] // 2, 2)
    wall, free = (blocks == 1).any(axis=(1, 3)), (blocks == 0).any(axis=(1, 3))
    return np.where(wall, 1, np.where(free, 0, 2))


def _flat(points: Iterable[Iterable[float]]) -> tuple[int, ...]:
    return tuple(round(100.0 * number) for point in points for number in point)
