import asyncio
import dataclasses
from pathlib import Path

import pytest

from thbridge.adapters.bag_reader import messages
from thbridge.app import programs
from thbridge.app.compose import Setting, build_bot, read_setting
from thbridge.app.config import Study, read_study_text
from thbridge.app.programs import PlayOptions, Unfinished
from thbridge.app.replay import Replayed, ReplayOptions, replay, session_of
from thbridge.app.what_if import Change, changed
from thbridge.roles.tabui import TabUI

STUDY = dataclasses.replace(
    Study(), seed=7, server=dataclasses.replace(Study().server, port=0), map="arena8", templates="original-2016"
)


def setting_of(study: Study) -> Setting:
    return read_setting(study, Path())


def record(bag: Path, study: Study, seconds: float) -> None:
    """A hunt with a simulated participant, given up after some time."""
    setting = setting_of(study)
    tabui = TabUI(build_bot(setting.templates, study.participant.strategy, study.seed))
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", seconds)
    with pytest.raises(Unfinished):
        asyncio.run(programs.play(setting, tabui, options, lambda where: None, lambda moment: None))


def again(bag: Path, *changes: Change, to: Path | None = None, to_the_end: bool = False) -> Replayed:
    study = changed(read_study_text(bag, session_of(bag).study), [], changes)
    return asyncio.run(replay(bag, setting_of(study), ReplayOptions(0.0, 0.0, to, to_the_end), lambda moment: None))


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    bag = tmp_path_factory.mktemp("hunt") / "hunt.bag"
    record(bag, STUDY, 25.0)
    return bag


def test_a_hunt_is_the_same_again_to_the_last_bit(hunt: Path, tmp_path: Path) -> None:
    done = again(hunt, to=tmp_path / "again.bag")
    assert done.difference is None
    assert not done.cut_off
    assert (done.ticks, done.messages) == (25 * 50, len(list(messages(hunt))) - 1)
    assert list(messages(tmp_path / "again.bag")) == list(messages(hunt))


def test_another_seed_is_found_where_it_first_shows(hunt: Path) -> None:
    difference = again(hunt, Change("seed", "8")).difference
    assert difference is not None
    assert (difference.topic, difference.topic_number, difference.seconds) == ("/hunt/events", 1, 0.04)
    (field,) = difference.fields
    assert '"seed":7' in field.was
    assert '"seed":8' in field.now


def test_one_parameter_of_one_robot_is_found(hunt: Path) -> None:
    difference = again(hunt, Change("robot.amcl.max_particles", "300")).difference
    assert difference is not None
    assert difference.seconds < 5.0
