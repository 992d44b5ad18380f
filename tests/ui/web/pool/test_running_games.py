"""Running games, as the next server of the same folder finds them, and people who wait for a game."""

import asyncio
import tempfile
from pathlib import Path
from typing import ClassVar

import pytest

from tests.support.programs.commands import invoke
from thbridge.files.errors import BadFile
from ui.web.gateway.game_queue import GameQueue
from ui.web.pool.messages import WorkerResult
from ui.web.pool.pool import HostLeft, WorkerPool
from ui.web.pool.running_games import RunningGames, WorkerAddress
from ui.web.pool.worker import GameRequest


class RoomyHosts:
    """Other machines that start nothing."""

    rooms: ClassVar[dict[str, int]] = {"10.0.0.2": 3}

    async def start(self, host: str, key: str, request: GameRequest) -> WorkerAddress:
        raise HostLeft

    async def connect(self, address: WorkerAddress) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        raise TimeoutError


@pytest.fixture
def games(tmp_path: Path) -> RunningGames:
    return RunningGames(tmp_path / "user" / "games")


def test_a_game_is_running_while_its_worker_lives_and_has_only_one_worker(games: RunningGames) -> None:
    record = games.claim("P-ABCDE-2-1")
    assert record is not None
    assert [*games] == ["P-ABCDE-2-1"]
    assert games.claim("P-ABCDE-2-1") is None
    record.close()
    assert not [*games]
    games.tidy()
    assert not [*games.folder.iterdir()]


def test_a_game_on_another_machine_is_found_by_the_next_server_and_takes_no_room_here(games: RunningGames) -> None:
    address = WorkerAddress("tls://10.0.0.2:4711", "secret", 7)
    games.place_remotely("P-ABCDE-2-1", address)
    again = RunningGames(games.folder)
    assert [*again] == ["P-ABCDE-2-1"]
    assert again.address("P-ABCDE-2-1") == address
    assert again.remote_host("P-ABCDE-2-1") == "10.0.0.2"
    pool = WorkerPool(again, 1, RoomyHosts())
    assert (pool.playing, pool.free) == (1, 3)
    again.tidy()
    assert [*again] == ["P-ABCDE-2-1"]
    again.end_remotely("P-ABCDE-2-1")
    assert (pool.playing, pool.free) == (0, 4)


def test_a_result_waits_for_the_next_server_until_it_is_in_the_log(games: RunningGames) -> None:
    games.keep("game", WorkerResult(declined=True))
    games.tidy()
    kept = games.result("game")
    assert kept is not None
    assert kept.declined
    games.forget("game")
    assert games.result("game") is None


def test_a_server_that_is_not_found_may_have_another_temporary_folder(tmp_path: Path) -> None:
    answer = invoke("serve", "--drain", "--bags", str(tmp_path))
    assert answer.exit_code == 2
    assert f"another temporary folder than {tempfile.gettempdir()}" in " ".join(answer.output.split())


def test_only_one_server_has_the_games_of_a_folder(games: RunningGames, tmp_path: Path) -> None:
    with games.lock_server(tmp_path), pytest.raises(BadFile, match="another server serves this folder"):
        RunningGames(games.folder).lock_server(tmp_path)
    games.lock_server(tmp_path).close()


def test_a_folder_that_others_can_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "user").mkdir(mode=0o755)
    with pytest.raises(BadFile, match="other accounts have access"):
        RunningGames(tmp_path / "user" / "games")


def test_people_get_games_in_the_order_in_which_they_came(games: RunningGames) -> None:
    queue = GameQueue(WorkerPool(games, 1))
    record = games.claim("playing")
    assert record is not None
    for key in ("first", "second"):
        queue.enter(key)
        assert not queue.admits(key)
    assert queue.before("second") == 1
    record.close()
    assert queue.admits("first")
    assert not queue.admits("second")
    queue.leave("first")
    assert queue.admits("second")
    queue.is_closed = True
    assert not queue.admits("second")
