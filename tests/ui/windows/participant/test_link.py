"""The link between a participant's window and a server."""

import asyncio
import base64
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.roles.shared.view import RequestSuggestion, View
from thbridge.sockets.addresses import ListeningAddress
from thbridge.study.study_file import ServerSection, Study
from thbridge.text_protocol.wire import legacy
from ui.windows.link import ParticipantLink


def test_a_window_that_is_opened_again_does_not_use_the_numbers_of_the_one_before(tmp_path: Path) -> None:
    setting = read_setting(
        Study(map="practice", templates="practice", robots=1, server=ServerSection(port=0)), tmp_path
    )
    log = tmp_path / "game.inputs"
    ended: list[bool] = []
    options = PlayOptions(5.0, None, frozenset({legacy.TABUI}), "", 3600.0, inputs=log, left=lambda: bool(ended))
    visits: list[asyncio.Task[None]] = []

    async def until(happened: Callable[[], bool]) -> None:
        while not happened():
            await asyncio.sleep(0.05)

    async def ask(where: ListeningAddress, number: int) -> None:
        # The host gives each window of a participant the same mark.
        link = ParticipantLink(where.host, where.port, "token")
        link.start()
        await until(lambda: any(isinstance(each.event, View) and each.event.ready for each in link.take_events()))
        link.request((RequestSuggestion(0),))
        await until(lambda: len(numbers()) == number)
        await asyncio.to_thread(link.stop)

    async def visit(where: ListeningAddress) -> None:
        await ask(where, 1)
        await ask(where, 2)
        ended.append(True)

    def numbers() -> set[int]:
        """The numbers of the requests for advice that the server has received."""
        received = re.findall(r"data\W+([\w+/=]+)", log.read_text() if log.exists() else "")
        said = b"".join(map(base64.b64decode, received)).decode()
        return set(map(int, re.findall(r'"Unsure".*?"request":(\d+)', said)))

    async def game() -> None:
        with suppress(HuntUnfinished):
            await play(
                setting, (), options, lambda where: visits.append(asyncio.create_task(visit(where))), lambda _: None
            )

    asyncio.run(asyncio.wait_for(game(), 120))
    first, second = sorted(numbers())
    assert second - first > 1
