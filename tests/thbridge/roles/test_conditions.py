"""Whole hunts in each condition of a study, without a simulator: participants of every attitude come to an end."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.hunts.hunt_without_simulator import Log, Puppets
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.moves import DialogueUtterance, Speaker, word_of
from thbridge.hunt import rules
from thbridge.hunt.events import EndReason, RobotDeparted
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.notices import KEEPER, MoveCosts
from thbridge.study.study_file import DialogueSection, GameSection, MannerSection, ParticipantSection, Study
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice

MOST_TICKS = 5_000


class Hunting:
    """A hunt of a study with puppets for robots."""

    def __init__(self, study: Study, puppets: type[Puppets] = Puppets) -> None:
        setting, who = read_setting(study, Path()), study.participant
        self.puppets = puppets(study.robots, plain_costs(setting.costs))
        self.tabui = TabUI(build_bot(setting.templates, who.strategy, study.seed, who.attitude))
        self.log = Log()
        roles = [self.puppets, self.tabui, build_hider(setting.templates, study.seed)]
        self.session = Session(build_keeper(setting), roles, log=self.log)
        self.said: list[DialogueUtterance] = []

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.said += self.session.step().utterances

    def finish(self) -> None:
        for _ in range(MOST_TICKS):
            if self.session.game is not None and self.session.game.ended is not None:
                return
            self.run(1)
        raise TimeoutError("the hunt does not end")


def study_of(condition: DialogueCondition, who: Attitude, *, robots: int = 2, **manner) -> Study:
    return Study(
        robots=robots,
        game=GameSection(energy=35.0),
        dialogue=DialogueSection(condition=condition, manner=MannerSection(**manner)),
        participant=ParticipantSection(attitude=who),
    )


@pytest.mark.parametrize("attitude", [Attitude.CAUTIOUS, Attitude.SCEPTICAL])
@pytest.mark.parametrize("condition", DialogueCondition)
def test_a_hunt_ends_when_nothing_more_can_be_done(condition, attitude):
    played = Hunting(study_of(condition, attitude))
    played.finish()
    game = played.session.game
    if game.ended.reason is EndReason.ALL_VISITED:
        assert all(room.visited for room in game.rooms)
    else:
        assert not any(rules.affordable(game, robot) for robot in range(2))


ARGUING = [condition for condition in DialogueCondition if condition.argues]


@pytest.mark.parametrize(("condition", "strategy"), list(zip(ARGUING, BotStrategy, strict=True)))
def test_a_hunt_ends_though_stubborn_robots_mishear_a_sceptic(condition, strategy):
    study = study_of(condition, Attitude.SCEPTICAL, attitude=Attitude.SCEPTICAL, misheard=0.3, talkative=True)
    study = replace(study, seed=5, participant=replace(study.participant, strategy=strategy))
    played = Hunting(study)
    played.finish()
    assert max(said.index for said in played.said) < 60


def test_the_same_seed_gives_the_same_words_and_another_attitude_others():
    cautious, again, sceptical = (
        Hunting(study_of(DialogueCondition.COLLABORATOR, attitude, robots=1))
        for attitude in (Attitude.CAUTIOUS, Attitude.CAUTIOUS, Attitude.SCEPTICAL)
    )
    for played in (cautious, again, sceptical):
        played.finish()
    assert cautious.said == again.said
    words = [
        {word_of(said.move) for said in each.said if said.speaker is Speaker.PERSON} for each in (again, sceptical)
    ]
    assert "reject" in words[1] - words[0]


@pytest.mark.parametrize("attitude", Attitude)
@pytest.mark.parametrize("condition", ARGUING)
def test_a_hunt_ends_though_a_robot_reaches_no_room_whatever_it_was_talked_into(condition, attitude):
    played = Hunting(study_of(condition, attitude, robots=1))
    played.puppets.stuck.add(0)
    played.finish()


def test_a_robot_that_was_stopped_goes_on_only_when_the_participant_has_agreed_again():
    played = Hunting(study_of(DialogueCondition.COLLABORATOR, Attitude.CREDULOUS, robots=1))
    played.puppets.stuck.add(0)
    played.finish()
    departures = [event for event in played.log.events if isinstance(event, RobotDeparted)]
    agreed = {said.dialogue for said in played.said if said.speaker is Speaker.PERSON}
    assert 0 < len(departures) <= len(agreed)


class Pricing(Puppets):
    """Puppets that tell, as soon as one of them fails, that one room is near and all others are far."""

    cheap = 6

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        said = super().step(tick, messages)
        if any(result is not None and not result.arrived for result in self._results):
            costs = tuple(1.0 if place == self.cheap else 20.0 for place in range(len(self.costs)))
            said.append(encode_notice(self.name, KEEPER, MoveCosts(self._game, (costs,))))
        return said


def test_a_robot_that_was_stopped_suggests_a_room_by_what_it_costs_from_there():
    played = Hunting(study_of(DialogueCondition.COLLABORATOR, Attitude.CREDULOUS, robots=1), Pricing)
    played.puppets.stuck.add(0)
    played.run(220)
    first, second, *_ = [event.room.people for event in played.log.events if isinstance(event, RobotDeparted)]
    assert first != Pricing.cheap
    assert second == Pricing.cheap
