"""The abstract hunt: the game of whole robots without robots, with moves that take the map's times."""

import warnings
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

from thbridge import api
from thbridge.api.learning import AbstractHuntEnv, HuntEnv
from thbridge.api.session import HuntEvent
from thbridge.api.study import setting_of
from thbridge.files.map_times import read_map_times

STUDY = api.HuntStudy("standard", robots=2, game={"energy": 50})


def cheapest(env: HuntEnv | AbstractHuntEnv, observations: dict[str, np.ndarray], infos: dict) -> dict[str, int]:
    """Return for each agent the room that costs it least; 0 where there is none."""
    actions = {}
    for agent in env.agents:
        costs, choices = observations[agent][env.layout["costs"]], np.flatnonzero(infos[agent]["action_mask"])[1:]
        actions[agent] = int(min(choices, key=lambda room, costs=costs: costs[room - 1], default=0))
    return actions


def play(env: HuntEnv | AbstractHuntEnv, seed: int) -> float:
    """Play an episode by the cheapest rooms; return the reward of robot 1."""
    observations, infos = env.reset(seed=seed)
    total = 0.0
    while env.agents:
        for agent, vector in observations.items():
            assert env.observation_space(agent).contains(vector)
        observations, rewards, _, _, infos = env.step(cheapest(env, observations, infos))
        total += rewards["robot_1"]
    return total


def of_game(events: Iterable[HuntEvent]) -> list[tuple[object, ...]]:
    """Return the events of a game without their times, and without what the study's files say."""
    kept = (event for event in events if event.kind not in {"started", "said", "goal", "refused", "reported"})
    return [(event.kind, event.robot, event.room, dict(event.data)) for event in kept]


@pytest.mark.parametrize("step", [1.0, "decision"])
def test_pettingzoos_tests_of_the_interface_and_of_seeds(step: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(AbstractHuntEnv(STUDY, step=step), num_cycles=200)
    parallel_seed_test(lambda: AbstractHuntEnv(STUDY, step=step), num_cycles=100)


def test_spaces_treasures_starts_and_masks_are_those_of_whole_robots() -> None:
    whole, abstract = HuntEnv(STUDY), AbstractHuntEnv(STUDY)
    for seed in (3, None):
        (first, first_infos), (second, second_infos) = whole.reset(seed=seed), abstract.reset(seed=seed)
        for agent in whole.possible_agents:
            assert whole.observation_space(agent) == abstract.observation_space(agent)
            assert whole.action_space(agent) == abstract.action_space(agent)
            # Robots start on the map's poses, as well as they know them, and their software has some particles.
            exact = np.ones(first[agent].size, dtype=bool)
            exact[whole.layout["spread"]] = exact[whole.layout["time"]] = False
            assert first[agent][exact] == pytest.approx(second[agent][exact], abs=0.02)
            assert np.array_equal(first_infos[agent]["action_mask"], second_infos[agent]["action_mask"])
        assert whole.session is not None
        hidden = [
            next(event.data for event in events if event.kind == "hidden")
            for events in (whole.session.events, abstract.events)
        ]
        assert hidden[0] == hidden[1]
    assert whole.layout == abstract.layout


@pytest.mark.parametrize(
    "study",
    [
        api.HuntStudy("standard", robots=1, game={"energy": 40}),
        api.HuntStudy(robots=1, game={"energy": 36}),
        api.HuntStudy(robots=1, templates="four-properties", game={"energy": 40}),
    ],
)
def test_a_robot_alone_has_the_same_events_as_a_whole_one(study: api.HuntStudy) -> None:
    whole, abstract = HuntEnv(study, step="decision"), AbstractHuntEnv(study, step="decision")
    assert play(whole, 5) == play(abstract, 5)
    assert whole.session is not None
    assert of_game(whole.session.events) == of_game(abstract.events)
    arrivals = [
        [event.seconds for event in env if event.kind == "arrived"] for env in (whole.session.events, abstract.events)
    ]
    assert len(arrivals[0]) >= 2
    assert arrivals[0] == pytest.approx(arrivals[1], abs=6.0)


def test_moves_take_the_times_of_the_map_whatever_they_cost() -> None:
    study = api.HuntStudy(robots=2)  # The costs of 2016, which are none of arena8's times.
    env = AbstractHuntEnv(study, step="decision")
    play(env, 1)
    file = setting_of(study).map.costs
    assert file is not None
    times = read_map_times(file).rows
    left: dict[int, HuntEvent] = {}
    at: dict[int, int] = {}
    checked = 0
    for event in env.events:
        if event.kind == "departed":
            left[event.robot] = event
        elif event.kind == "arrived":
            departed = left[event.robot]
            if event.robot in at:
                assert event.seconds - departed.seconds == pytest.approx(times[at[event.robot]][event.room])
                checked += departed.data["cost"] != times[at[event.robot]][event.room]
            at[event.robot] = event.room
    assert checked >= 4


def test_a_robot_under_way_is_seen_between_its_ends() -> None:
    env = AbstractHuntEnv(STUDY, step=5.0)
    observations, _ = env.reset(seed=1)
    place, remaining = env.layout["place"], env.layout["remaining"]
    seen = [observations["robot_1"]]
    while env.agents and not any(event.kind == "arrived" for event in env.events):
        observations, *_ = env.step({"robot_1": 3})
        seen.append(observations["robot_1"])
    goal = setting_of(STUDY).map.rooms[2].goal
    grid = setting_of(STUDY).map.grid
    at_goal = 2.0 * (goal.x - grid.origin.x) / (grid.cols * grid.resolution) - 1.0
    assert seen[-1][place][0] == pytest.approx(at_goal)
    steps = np.diff([each[place] for each in seen], axis=0)
    assert len(steps) >= 3
    assert steps[1] == pytest.approx(steps[0], abs=1e-5)
    assert seen[1][remaining] > seen[2][remaining] > seen[-1][remaining] == 0.0


def test_who_waits_lets_a_tick_pass() -> None:
    env = AbstractHuntEnv(STUDY, step="decision", max_seconds=1)
    env.reset(seed=1)
    steps = 0
    while env.agents:
        _, _, _, truncations, _ = env.step({})
        steps += 1
    assert all(truncations.values())
    assert steps == 50


def test_pictures_are_drawn_on_request() -> None:
    env = AbstractHuntEnv(STUDY, render_mode="rgb_array")
    assert env.render() is None
    env.reset(seed=1)
    before = env.render()
    env.step({"robot_1": 3})
    after = env.render()
    assert before is not None and after is not None
    assert not np.array_equal(before, after)


@pytest.mark.parametrize(
    ("act", "told"),
    [
        (
            lambda: AbstractHuntEnv(STUDY.changed(mishaps=[{"robot": 1, "what": "dies", "time": 5.0}])),
            "mishaps: .* HuntEnv",
        ),
        (
            lambda: AbstractHuntEnv(STUDY.changed(things=[{"name": "box", "shape": "crate", "at": [0.0, 0.0, 0.0]}])),
            "things: .* HuntEnv",
        ),
        (lambda: AbstractHuntEnv(STUDY).reset(options={"record": Path("x.bag")}), "Use HuntEnv"),
        (lambda: AbstractHuntEnv(STUDY).step({}), "no episode is in progress. Call `reset` first"),
    ],
)
def test_faults_are_told(act: Callable[[], object], told: str) -> None:
    with pytest.raises(api.HuntError, match=told):
        act()
