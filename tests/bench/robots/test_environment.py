"""Steps of environments: what they add to the session under them, and how fast the abstract hunt is."""

import time
from collections.abc import Callable

import numpy as np
import pytest

from tests.bench.budget import Budgets
from thbridge import api
from thbridge.api.learning import AbstractHuntEnv, HuntEnv
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


@pytest.mark.bench
@pytest.mark.parametrize("robots", [2, 4])
def test_decisions_of_the_abstract_hunt(budgets: Budgets, robots: int) -> None:
    env = AbstractHuntEnv(api.HuntStudy("standard", robots=robots), step="decision")

    def played(episodes: int) -> tuple[int, float]:
        """Play, and return the rooms chosen and the processor seconds of the environment."""
        chosen, spent = 0, 0.0
        for seed in range(episodes):
            began = time.process_time()
            _, infos = env.reset(seed=seed)
            spent += time.process_time() - began
            while env.agents:
                actions = {
                    agent: int(np.flatnonzero(np.asarray(infos[agent]["action_mask"]))[-1]) for agent in env.agents
                }
                began = time.process_time()
                _, _, _, _, infos = env.step(actions)
                spent += time.process_time() - began
                chosen += sum(room > 0 and bool(infos[agent]["accepted"]) for agent, room in actions.items())
        return chosen, spent

    played(20)
    chosen, spent = played(500)
    print(f"{chosen / spent:.0f} decisions a processor second")
    budgets.time(f"environment: 1000 decisions in the abstract hunt, {robots} robots", 1000.0 * spent / chosen)
