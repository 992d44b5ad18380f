"""Environments: PettingZoo's own tests, determinism, what agents see and get."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test, seed_test
from pettingzoo.utils.conversions import parallel_to_aec

from thbridge import api
from thbridge.api.learning import HuntEnv, parallel_env
from thbridge.api.learning.observation import ObservationEncoder, ObservationScale
from thbridge.api.session import inside
from thbridge.api.snapshot import team_of
from thbridge.api.study import setting_of

STUDY = api.HuntStudy(robots=3, game={"energy": 40})


def first_choices(env: HuntEnv, infos: dict[str, dict[str, object]]) -> dict[str, int]:
    """Return for each agent the lowest room that it may choose."""
    found = {agent: np.flatnonzero(np.asarray(infos[agent]["action_mask"])) for agent in env.agents}
    return {agent: int(choices[min(1, len(choices) - 1)]) for agent, choices in found.items()}


@pytest.mark.parametrize("control", ["rooms", "velocity"])
def test_pettingzoos_test_of_the_interface(control: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(parallel_env(STUDY, control=control, max_seconds=8), num_cycles=100)


@pytest.mark.parametrize("control", ["rooms", pytest.param("velocity", marks=pytest.mark.slow)])
def test_pettingzoos_test_of_seeds(control: str) -> None:
    def made() -> HuntEnv:
        return parallel_env(STUDY, control=control, max_seconds=8)

    parallel_seed_test(made, num_cycles=30)
    seed_test(lambda: parallel_to_aec(made()), num_cycles=30)


@pytest.mark.slow
@pytest.mark.parametrize("control", ["rooms", "velocity"])
def test_same_seed_and_same_actions_give_the_same_to_the_bit(control: str) -> None:
    def episode() -> list[object]:
        env = HuntEnv(STUDY, control=control, max_seconds=20)
        dice = np.random.default_rng(5)
        observations, infos = env.reset(seed=11)
        seen: list[object] = [{agent: vector.tobytes() for agent, vector in observations.items()}]
        while env.agents:
            spaces = {agent: env.action_space(agent) for agent in env.agents}
            actions = {
                agent: dice.uniform(-1, 1, 2) if control == "velocity" else int(dice.integers(spaces[agent].n))
                for agent in env.agents
            }
            observations, rewards, _, _, infos = env.step(actions)
            seen.append(({agent: vector.tobytes() for agent, vector in observations.items()}, rewards, str(infos)))
        return seen

    first = episode()
    assert len(first) > 15
    assert episode() == first


def test_episodes_without_a_seed_follow_from_the_last_one_given() -> None:
    one, other = HuntEnv(STUDY), HuntEnv(STUDY)
    hidden = []
    for env in (one, other):
        env.reset(seed=3)
        env.reset()
        assert env.session is not None
        hidden.append((env.session.study.seed, env.session.snapshot.true_treasures))
    assert hidden[0] == hidden[1]
    assert hidden[0][0] != 3


def test_a_whole_game_scores_what_its_rewards_say_and_replays(tmp_path: Path) -> None:
    env = HuntEnv(api.HuntStudy(robots=3, game={"energy": 25}))
    observations, infos = env.reset(seed=2, options={"record": tmp_path / "episode.bag"})
    total, steps = 0.0, 0
    while env.agents:
        for agent, vector in observations.items():
            assert env.observation_space(agent).contains(vector)
        observations, rewards, terminations, truncations, infos = env.step(first_choices(env, infos))
        assert len(set(rewards.values())) == 1
        total, steps = total + rewards["robot_1"], steps + 1
    assert env.session is not None
    assert all(terminations.values()) and not any(truncations.values())
    assert total == env.session.snapshot.score != 0
    assert env.session.snapshot.visited.sum() >= 3
    env.close()
    assert api.HuntRecording(tmp_path / "episode.bag").replay().equal


@pytest.mark.slow
def test_own_rewards_and_costs_add_up_to_those_of_the_team() -> None:
    returns = []
    for shared in (True, False):
        env = HuntEnv(STUDY, shared=shared, room_reward=2.0, energy_cost=0.5, time_cost=0.1)
        _, infos = env.reset(seed=2)
        total = 0.0
        while env.agents:
            _, rewards, _, _, infos = env.step(first_choices(env, infos))
            total += rewards["robot_1"] if shared else sum(rewards.values())
        assert env.session is not None
        returns.append(total)
        now = env.session.snapshot
        spent = 120.0 - now.energy.sum()
        seconds = now.seconds - 0.1
        expected = now.score + 2.0 * now.visited.sum() - 0.5 * spent - 0.3 * seconds
        assert total == pytest.approx(expected, abs=0.1)
    assert returns[0] == pytest.approx(returns[1])


def test_the_mask_is_what_the_rules_grant() -> None:
    env = HuntEnv(STUDY)
    _, infos = env.reset(seed=1)
    mask = np.asarray(infos["robot_1"]["action_mask"])
    assert mask.tolist() == [1] * 9
    _, _, _, _, infos = env.step({"robot_1": 3, "robot_2": 3, "robot_3": 0})
    assert env.session is not None
    assert env.session.snapshot.bound_for.tolist() == [3, 0, 0]
    assert [infos[agent]["accepted"] for agent in env.agents] == [True, False, True]
    assert np.flatnonzero(np.asarray(infos["robot_1"]["action_mask"])).tolist() == [0]
    assert np.asarray(infos["robot_2"]["action_mask"])[3] == 0


def test_parts_of_an_observation_say_what_their_names_say() -> None:
    env = HuntEnv(STUDY)
    observations, _ = env.reset(seed=1)
    observations, *_ = env.step({"robot_1": 3})
    assert env.session is not None
    own = {name: observations["robot_1"][part] for name, part in env.layout.items()}
    assert np.argmax(own["bound_for"]) == 2 and own["ready"] == 0.0
    assert own["reserved"].tolist() == own["bound_for"].tolist()
    now = env.session.snapshot
    assert own["energy"][0] == pytest.approx(now.energy[0] / 40.0)
    assert own["heading"] == pytest.approx([np.cos(now.poses[0, 2]), np.sin(now.poses[0, 2])], abs=1e-6)
    other = observations["robot_2"][env.layout["mates"]]
    assert other[:2] == pytest.approx(own["place"])
    assert env.state().shape == (3 * len(observations["robot_1"]),)


def test_no_observation_depends_on_the_truth() -> None:
    env = HuntEnv(STUDY, control="velocity")
    env.reset(seed=4)
    env.step({"robot_1": np.array([0.4, 0.2])})
    assert env.session is not None
    team, scans = team_of(env.session.snapshot)
    game = inside(env.session).game
    assert game is not None
    goals = [room.goal for room in setting_of(STUDY).map.rooms]
    scale = ObservationScale(0.0, 0.0, 10.0, 10.0, 40.0, 1.0, 1.0, 8.0, 600.0)
    told = []
    for each in (team, replace(team, world=None)):
        encoder = ObservationEncoder(3, goals, scale, with_scans=True)
        bodies = [encoder.of_output(output, scan) for output, scan in zip(each.robots, scans, strict=True)]
        told.append(encoder.encode(each.tick, bodies, game, [True] * 3))
    assert np.array_equal(told[0], told[1])


def test_steps_by_decision_end_when_somebody_is_ready() -> None:
    env = HuntEnv(STUDY, step="decision")
    _, infos = env.reset(seed=2)
    steps = 0
    while env.agents:
        _, _, terminations, _, infos = env.step(first_choices(env, infos))
        steps += 1
        if env.agents:
            assert any(np.asarray(info["action_mask"]).sum() > 1 for info in infos.values())
    assert all(terminations.values())
    assert steps < 20


def test_who_drives_to_a_room_enters_it_by_the_games_rules() -> None:
    study = api.HuntStudy(robots=1, game={"energy": 60})
    env = HuntEnv(study, control="velocity", max_seconds=60)
    observations, _ = env.reset(seed=3)
    assert env.session is not None
    goal = setting_of(study).map.rooms[2].goal
    env.session.carry(1, goal.x, goal.y + 1.2, 0.0)
    env.session.set_pose(1, goal.x, goal.y + 1.2, 0.0, np.diag([0.01, 0.01, 0.01]).tolist())
    while env.agents and not env.session.snapshot.visited.any():
        x, y = observations["robot_1"][env.layout["directions"]].reshape(-1, 2)[2].tolist()
        bearing = np.arctan2(y, x)
        speeds = [0.3 if abs(bearing) < 0.3 else 0.0, np.clip(bearing, -0.6, 0.6)]
        observations, _, _, _, infos = env.step({"robot_1": np.array(speeds, np.float32)})
    now = env.session.snapshot
    assert np.flatnonzero(now.visited).tolist() == [2]
    assert now.energy[0] < 60.0
    assert infos["robot_1"]["accepted"] is False
    while env.agents and now.named[2] is None and env.session.seconds < 50:
        env.step({"robot_1": np.zeros(2, np.float32)})
        now = env.session.snapshot
    assert now.named[2] == now.true_treasures[2]


def test_an_episode_that_is_over_stays_over() -> None:
    env = HuntEnv(STUDY, max_seconds=1)
    env.reset(seed=1)
    _, _, terminations, truncations, _ = env.step({})
    assert not any(terminations.values()) and all(truncations.values())
    assert env.agents == [] and env.step({}) == ({}, {}, {}, {}, {})


def test_pictures_are_drawn_on_request() -> None:
    env = HuntEnv(STUDY, render_mode="rgb_array")
    assert env.render() is None
    env.reset(seed=1)
    before = env.render()
    env.step({"robot_1": 3})
    after = env.render()
    assert before is not None and after is not None
    assert before.shape == after.shape and before.shape[2] == 3 and before.dtype == np.uint8
    assert not np.array_equal(before, after)


@pytest.mark.parametrize(
    ("act", "told"),
    [
        (lambda: HuntEnv(STUDY, control="thoughts"), "Write rooms or velocity"),
        (lambda: HuntEnv(STUDY, step=0.001), "Give at least 0.02"),
        (lambda: HuntEnv(STUDY, step="decision", control="velocity"), "Give a number of seconds"),
        (lambda: HuntEnv(STUDY).step({}), "no episode is in progress. Call `reset` first"),
        (lambda: acted({"robot_1": 9}), "Choose an action from 0 to 8"),
        (lambda: acted({"robot_1": np.array([1.5, 0.0])}, control="velocity"), "Clip the action"),
    ],
)
def test_faults_are_told(act: Callable[[], object], told: str) -> None:
    with pytest.raises(api.HuntError, match=told):
        act()


def acted(actions: dict[str, object], control: str = "rooms") -> object:
    env = HuntEnv(STUDY, control=control)
    env.reset(seed=1)
    return env.step(actions)
