"""A recording with two games: each has figures of its own, and every row of a table tells its game."""

import asyncio
import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from sim.common.observations import TICK
from tests.support.programs.commands import thbridge
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.builder import read_games
from thbridge.analysis.report.report import Report
from thbridge.analysis.report_page.page import build_report
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntOutcome, PlayOptions, play
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import EndGame, ParticipantRequest, PlayAgain, View
from thbridge.study.study_file import GameSection, Study
from ui.command_line.outcome import show_outcome

STUDY = Study(robots=2, seed=7, game=GameSection(energy=30.0))


class _Twice:
    """Plays one game to its end, and ends the second one as soon as a robot has found something."""

    def __init__(self) -> None:
        setting = read_setting(STUDY, Path())
        self._bot = build_bot(setting.templates, BotStrategy.SUGGESTION, STUDY.seed)
        self._view: View | None = None

    def requests(self, view: View) -> tuple[ParticipantRequest, ...]:
        self._view = view
        if view.over is not None:
            return (PlayAgain(1),) if view.game == 1 else ()
        if view.game == 2 and any(room.state == "visited" for room in view.rooms):
            return (EndGame(2),)
        return tuple(self._bot.requests(view))

    def has_left(self) -> bool:
        return self._view is not None and self._view.game == 2 and self._view.over is not None


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("games") / "two.bag"


@pytest.fixture(scope="module")
def outcome(bag: Path) -> HuntOutcome:
    player = _Twice()
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", 600.0, left=player.has_left)
    return asyncio.run(play(read_setting(STUDY, Path()), (TabUI(player),), options, lambda _: None, lambda _: None))


@pytest.fixture(scope="module")
def games(outcome: HuntOutcome, bag: Path) -> tuple[Report, ...]:
    return read_games(messages(bag))


def test_the_outcome_tells_every_game(outcome: HuntOutcome, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = outcome.games
    assert (first.game, second.game) == (1, 2)
    assert first.score > 0 and second.score == 0
    assert first.rooms_visited > second.rooms_visited > 0
    show_outcome(outcome)
    (row,) = (line for line in capsys.readouterr().out.splitlines() if " score " in line)
    assert str(first.score) in row and " 0 " in row


def test_each_game_has_its_own_figures(outcome: HuntOutcome, games: tuple[Report, ...]) -> None:
    assert [report.game for report in games] == [1, 2]
    for report, of_game in zip(games, outcome.games, strict=True):
        assert report.score is not None
        assert (report.score.score, report.score.visited) == (of_game.score, of_game.rooms_visited)
        assert [track.energy[0, 1] for track in report.tracks] == [30.0, 30.0]
        assert report.grid is not None and report.session is not None and report.missing == ()
        assert [entry.kind for entry in report.timeline].count("started") == 1
        assert report.timeline[-1].kind == "ended"
    first, second = games
    assert second.begins == pytest.approx(first.duration)
    assert sum(entry.points or 0 for entry in first.timeline) == outcome.games[0].score


def test_no_path_leads_from_one_game_into_the_next(games: tuple[Report, ...]) -> None:
    for report in games:
        for track in report.tracks:
            for path in (track.truth, track.estimate):
                assert np.hypot(*np.diff(path[:, 1:3], axis=0).T).max() < 0.2
                assert np.hypot(*(path[0, 1:3] - games[0].tracks[report.tracks.index(track)].truth[0, 1:3])) < 0.2
                assert path[0, 0] <= 2 * TICK


def test_the_page_has_a_part_for_each_game(games: tuple[Report, ...], bag: Path) -> None:
    page = build_report(bag)
    assert [page.count(f'<h2 class="game">Game {number}</h2>') for number in (1, 2, 3)] == [1, 1, 0]
    assert page.count("<h2>Paths</h2>") == 2


def test_every_row_of_a_table_tells_its_game(games: tuple[Report, ...], bag: Path, tmp_path: Path) -> None:
    export_bag(bag, tmp_path / "tables", (TableFormat.PARQUET,))

    def column(table: str, name: str) -> np.ndarray:
        return pyarrow.parquet.read_table(tmp_path / "tables" / f"{table}.parquet")[name].to_numpy()

    later = column("poses", "t_s") > games[1].begins
    assert set(column("poses", "game")[~later]) == {0, 1}
    assert set(column("poses", "game")[later]) == {2}
    kinds, numbers = column("hunt_events", "kind"), column("hunt_events", "game")
    assert list(numbers[kinds == "started"]) == list(numbers[kinds == "ended"]) == [1, 2]
    assert np.nansum(column("hunt_events", "event_points")[numbers == 1]) == games[0].score.score
    dictionary = (tmp_path / "tables" / "dictionary.csv").read_text()
    assert "robot1_odom,game," in dictionary


def test_a_figure_is_of_one_game(games: tuple[Report, ...], bag: Path) -> None:
    asked = ("bag", "plot", bag.name, "--what", "energy", "--to", "energy.svg")
    refused = thbridge(bag.parent, *asked)
    assert refused.exit_code == 2 and "--game" in refused.stderr and "1, 2" in refused.stderr
    assert thbridge(bag.parent, *asked, "--game", "2").exit_code == 0


@pytest.mark.slow
def test_runs_are_compared_game_by_game(games: tuple[Report, ...], bag: Path) -> None:
    done = thbridge(bag.parent, "replay", bag.name, "--json", "--with", "game.identify_cost=2")
    told = json.loads(done.stdout)
    assert [run["recorded"]["score"] for run in told["games"]] == [report.score.score for report in games]
