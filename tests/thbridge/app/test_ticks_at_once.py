"""The ticks of a game run in groups, without pauses between them, until an input arrives."""

import asyncio
from pathlib import Path

import pytest

from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.session.session import TickRecord
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.study_file import ServerSection, Study

GROUP = 4


async def groups_of(ticks: int, joins_at: int) -> tuple[list[int], int]:
    """Play a number of ticks; return the size of each group of ticks, and the tick with the input of a program."""
    study = Study(map="practice", templates="practice", robots=1, server=ServerSection(port=0))
    turns: list[int] = []
    turn = input_at = 0
    address: list[ListeningAddress] = []

    async def count() -> None:
        """Count the turns of the event loop between the groups."""
        nonlocal turn
        while True:
            turn += 1
            await asyncio.sleep(0)

    def ready(where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        address.append(where)

    def progress(moment: TickRecord) -> None:
        nonlocal input_at
        turns.append(turn)
        if moment.tick == joins_at:
            joining.append(asyncio.create_task(asyncio.open_connection(address[0].host, address[0].port)))
        if moment.inputs and not input_at:
            input_at = len(turns) - 1

    joining: list[asyncio.Task[tuple[asyncio.StreamReader, asyncio.StreamWriter]]] = []
    counting = asyncio.create_task(count())
    options = PlayOptions(10.0, None, frozenset(), "", ticks / 50.0, ticks_at_once=GROUP)
    with pytest.raises(HuntUnfinished):
        await play(read_setting(study, Path()), (), options, ready, progress)
    counting.cancel()
    for each in joining:
        (await each)[1].close()
    return [turns.count(each) for each in dict.fromkeys(turns)], input_at


def test_an_input_interrupts_the_groups() -> None:
    sizes, input_at = asyncio.run(groups_of(200, 100))
    first_ticks = [sum(sizes[:number]) for number in range(len(sizes))]
    group_of_input = max(number for number, tick in enumerate(first_ticks) if tick <= input_at)
    before, after = sizes[:group_of_input], sizes[group_of_input + 1 :]
    assert set(before) == {GROUP}
    # The answer to the input is sent in one of the next ticks, which do not wait for others.
    assert after[:3] == [1, 1, 1]
    assert set(after[4:-1]) == {GROUP}
