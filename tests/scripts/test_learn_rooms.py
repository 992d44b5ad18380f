"""The baseline learner: it learns in the abstract hunt, and what was saved of it is better than the cheapest rooms."""

import importlib
from pathlib import Path
from types import ModuleType

import pytest

from thbridge.api.learning import AbstractHuntEnv


@pytest.fixture
def learner(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script, which finds its own folder as it does when it is run."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "scripts"))
    return importlib.import_module("learn_rooms")


def test_the_saved_table_beats_the_cheapest_rooms_in_games_that_it_has_not_seen(learner: ModuleType) -> None:
    env = AbstractHuntEnv(learner.study(), step="decision")
    saved = learner.TablePolicy.read(Path(__file__).parents[2] / "docs" / "learning" / "table.npy")
    assert learner.mean_score(env, saved, 200) > learner.mean_score(env, learner.CheapestPolicy(), 200) + 10.0


@pytest.mark.slow
def test_the_same_seed_learns_the_same_and_better_than_it_began(learner: ModuleType) -> None:
    env = AbstractHuntEnv(learner.study(), step="decision")
    (table, curve), (again, _) = (learner.learn(env, 3, 24, 1.5) for _ in range(2))
    assert (table == again).all()
    assert sum(curve[-6:]) > sum(curve[:6])
