"""A loop of ticks whose pace is changed while it runs."""

import asyncio
import gc
import os
import signal
import sys
from collections.abc import Awaitable, Callable

from thbridge.timing.loop import LoopResult, _short_turns, run_ticks
from thbridge.timing.pacer import Pacer

PATIENCE = 120


class Loop:
    """A loop of ticks at full speed."""

    def __init__(self) -> None:
        self.pacer = Pacer(0.0)
        self.ticks = 0
        self.over = False

    def tick(self) -> bool:
        self.ticks += 1
        return not self.over

    async def rest(self) -> int:
        """Ticks, once no more come."""
        ticks = -1
        while ticks != self.ticks:
            ticks = self.ticks
            await asyncio.sleep(0.01)
        return ticks


def driven(drive: Callable[[Loop], Awaitable[None]]) -> tuple[LoopResult, Loop]:
    async def whole() -> tuple[LoopResult, Loop]:
        loop = Loop()
        async with asyncio.timeout(PATIENCE):
            running = asyncio.ensure_future(run_ticks(loop.tick, loop.pacer))
            await drive(loop)
            return await running, loop

    return asyncio.run(whole())


def test_a_pause_holds_steps_step_and_it_goes_on():
    async def drive(loop: Loop) -> None:
        loop.pacer.pause()
        paused = await loop.rest()
        loop.pacer.step(3)
        loop.pacer.step(2)
        assert await loop.rest() == paused + 5
        assert loop.pacer.paused
        loop.pacer.resume()
        while loop.ticks < paused + 100:
            await asyncio.sleep(0)
        loop.over = True

    assert driven(drive)[0].finished


def test_steps_that_were_granted_do_not_come_after_a_pause():
    async def drive(loop: Loop) -> None:
        loop.pacer.pause()
        paused = await loop.rest()
        loop.pacer.step(10**9)
        while loop.ticks < paused + 10:
            await asyncio.sleep(0)
        loop.pacer.pause()
        await loop.rest()
        loop.over = True
        loop.pacer.resume()

    assert driven(drive)[0].finished


def test_a_pause_ends_when_nobody_wants_one_any_more():
    over = False

    async def whole() -> int:
        nonlocal over
        pacer, ticks = Pacer(0.0, pause_abandoned=lambda: over), 0

        def tick() -> bool:
            nonlocal ticks
            ticks += 1
            return not over

        async with asyncio.timeout(PATIENCE):
            pacer.pause()
            running = asyncio.ensure_future(run_ticks(tick, pacer))
            await asyncio.sleep(0.25)
            assert ticks == 1
            over = True
            await running
        return ticks

    assert asyncio.run(whole()) == 2


def test_what_stood_before_the_first_tick_is_not_walked_by_the_garbage_collector_until_the_last():
    spared = []

    async def drive(loop: Loop) -> None:
        await asyncio.sleep(0)
        spared.append(gc.get_freeze_count())
        loop.over = True

    before = len(gc.get_objects())
    driven(drive)
    assert spared[0] > 0.9 * before
    assert gc.get_freeze_count() == 0


def test_other_threads_soon_let_the_ticks_go_on_and_only_as_long_as_there_are_any():
    turns: list[float] = []

    async def drive(loop: Loop) -> None:
        await asyncio.sleep(0)
        turns.append(sys.getswitchinterval())
        loop.over = True

    usual = sys.getswitchinterval()
    driven(drive)
    assert turns[0] < usual / 5 == sys.getswitchinterval() / 5


def test_of_loops_that_overlap_the_last_to_end_puts_the_turns_back():
    usual = sys.getswitchinterval()

    async def both() -> None:
        first, second = asyncio.Event(), asyncio.Event()

        async def one(begun: asyncio.Event, end: asyncio.Event) -> None:
            with _short_turns():
                begun.set()
                await end.wait()

        started, later = asyncio.Event(), asyncio.Event()
        early = asyncio.create_task(one(started, first))
        await started.wait()
        late = asyncio.create_task(one(later, second))
        await later.wait()
        first.set()
        await early
        assert sys.getswitchinterval() < usual
        second.set()
        await late

    asyncio.run(both())
    assert sys.getswitchinterval() == usual


def test_a_paused_program_can_be_stopped():
    async def drive(loop: Loop) -> None:
        loop.pacer.pause()
        await loop.rest()
        os.kill(os.getpid(), signal.SIGTERM)

    assert not driven(drive)[0].finished


def test_what_came_in_during_a_pause_is_taken_by_a_last_tick():
    before = 0

    async def drive(loop: Loop) -> None:
        nonlocal before
        loop.pacer.pause()
        before = await loop.rest()
        os.kill(os.getpid(), signal.SIGTERM)

    assert driven(drive)[1].ticks == before + 1


def waited(clock: list[float], pacer: Pacer, ticks: int) -> None:
    async def wait() -> None:
        for _ in range(ticks):
            await pacer.wait()

    asyncio.run(wait())


def test_lag_is_what_the_rate_asks_for_and_the_machine_does_not_do():
    now = [100.0]
    pacer = Pacer(1.0, lambda: now[0])
    waited(now, pacer, 1)
    assert pacer.lag == 0.0
    now[0] += 0.52
    assert round(pacer.lag, 6) == 0.5
    now[0] += 4.5
    waited(now, pacer, 1)  # the delay is given up
    assert round(pacer.lag, 6) == 5.0
    pacer.set_rate(0.0)
    now[0] += 100.0
    assert round(pacer.lag, 6) == 5.0
