"""An environment's steps, beside those of the session under it."""

import time
from collections.abc import Callable

import numpy as np
import pytest

from tests.bench.budget import Budgets
from thbridge import api
from thbridge.api.learning import HuntEnv
from thbridge.app.session.session import Session, TickRecord

STEPS = 1500


@pytest.mark.bench
@pytest.mark.parametrize(("step", "steps"), [(0.02, STEPS), (0.1, STEPS // 5)])
def test_steps_of_four_robots(budgets: Budgets, monkeypatch: pytest.MonkeyPatch, step: float, steps: int) -> None:
    inner = 0.0

    def measured(run: Callable[[Session], TickRecord]) -> Callable[[Session], TickRecord]:
        def timed(session: Session) -> TickRecord:
            nonlocal inner
            began = time.process_time()
            record = run(session)
            inner += time.process_time() - began
            return record

        return timed

    monkeypatch.setattr(Session, "step", measured(Session.step))
    env = HuntEnv(api.HuntStudy(robots=4), step=step)
    observations, infos = env.reset(seed=1)
    assert observations
    inner, outer = 0.0, 0.0
    for _ in range(steps):
        choices = {agent: np.flatnonzero(np.asarray(infos[agent]["action_mask"])) for agent in env.agents}
        actions = {agent: int(choice[-1]) for agent, choice in choices.items()}
        began = time.process_time()
        _, _, _, _, infos = env.step(actions)
        outer += time.process_time() - began
    assert env.agents
    print(f"{steps / outer:.0f} steps of {step:g} s a processor second, {steps / inner:.0f} of the session alone")
    budgets.ratio(f"environment: what it adds to a step of {step:g} s of 4 robots", (outer - inner) / inner)
