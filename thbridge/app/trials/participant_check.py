"""Trial of a simulated participant in complete games, in which robots are not simulated."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import number_of
from thbridge.app.compose.game import build_hider, knowledge_of
from thbridge.app.compose.installed import installed_participant
from thbridge.app.compose.session import Programs, open_session
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.trials.plugin_trial import PluginTrial
from thbridge.app.trials.puppets import Puppets
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.files.plugins import printing_aside
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.bots import Bot
from thbridge.roles.participant.installed_participant import InstalledParticipant
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import ParticipantRequest, View
from thbridge.study.study_file import DialogueSection, Study

LONGEST_GAME = 400 * TICKS_PER_SECOND
"""A game counts as endless after this number of ticks."""
MOST_REFUSED = 10
"""Maximum number of refusals of the same request in a game."""
_TEAMS = ((DialogueCondition.SCRIPT, 1, ()), *((condition, 3, (0,)) for condition in DialogueCondition))
"""Conditions, numbers of robots, and indices of robots that find no path."""


class _OnTrial:
    """Player that collects the faults of a participant, and compares the speed with a built-in participant."""

    def __init__(self, trial: PluginTrial, title: str, tried: InstalledParticipant, built_in: Bot) -> None:
        self._trial = trial
        self._title = title
        self._tried = tried
        self._built_in = built_in
        self.returned: list[str] = []

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the participant's requests; see `Player`."""
        requests = self._tried.requests(view)
        self._trial.built_in.measure(lambda: self._built_in.requests(view))
        if self._tried.fault:
            remedy = "For this view, return a list of requests, which may be empty"
            self._trial.note(self._tried.fault, remedy, (self._title, *_position(view)))
        self.returned.append(repr([*requests]))
        return requests


def try_participant(name: str, seed: int, seconds: float) -> PluginTrial:
    """Return the trial of a simulated participant in games of all conditions. In some games, a robot finds no path.

    Args:
        name: name of the participant.
        seed: random seed.
        seconds: timeout of a reply to a view, in wall time.

    Raises:
        BadFile: there is no participant with this name; see `installed_participant`.
    """
    trial = PluginTrial("participant")
    # Robots of this study argue, so that all files for all games are read.
    study = Study(templates="everyday-things", seed=seed, dialogue=DialogueSection(DialogueCondition.COLLABORATOR))
    setting = read_setting(study, Path())
    for condition, robots, stuck in _TEAMS:
        talk = replace(study.dialogue, condition=condition)
        game = replace(setting, study=replace(study, robots=robots, dialogue=talk))
        without = f", {len(stuck)} without a path" if stuck else ""
        title = f"A game with {robots} robot{'s' if robots > 1 else ''}{without}, in the condition {condition}"
        trial.twice(title, lambda: _play(trial, title, game, name, stuck, seconds))  # noqa: B023 - called at once
    trial.end()
    return trial


def _play(
    trial: PluginTrial, title: str, setting: StudySetting, name: str, stuck: Sequence[int], seconds: float
) -> Iterator[str]:
    """Play a game, and yield the requests for each view."""
    study, knowledge = setting.study, knowledge_of(setting.templates)
    caller = trial.caller(seconds)

    def call(asked: Callable[[], Sequence[ParticipantRequest]]) -> Sequence[ParticipantRequest]:
        with printing_aside():
            return caller(asked)

    tried = installed_participant(name, knowledge, study.seed, Attitude.CREDULOUS, call)
    player = _OnTrial(trial, title, tried, Bot(BotStrategy.NEAREST, knowledge, study.seed))
    robots = Puppets(study.robots, plain_costs(setting.costs))
    robots.stuck.update(stuck)
    participant = TabUI(player)
    session = open_session(setting, Programs(robots, build_hider(setting.templates, study.seed), (participant,)))
    refused = Counter[tuple[str, str]]()
    while session.tick < LONGEST_GAME:
        record = session.step()
        refused.update((each.asked, each.refused.sentence) for each in record.refusals)
        if session.game is not None and session.game.ended is not None:
            break
    else:
        view = () if participant.view is None else _position(participant.view)
        problem = f"the game has not ended after {LONGEST_GAME // TICKS_PER_SECOND} s of simulated time"
        remedy = "Return a request for each view in which a robot waits, or end the game with GiveUp"
        trial.note(problem, remedy, (title, *view))
    for (asked, sentence), times in sorted(refused.items()):
        if times > MOST_REFUSED:
            problem = f"the participant repeated a request after more than {MOST_REFUSED} refusals"
            trial.note(problem, "If view.refusal has a refusal, send another request", (title, asked, sentence))
    yield from player.returned


def _position(view: View) -> Iterator[str]:
    """Yield lines that describe a view."""
    for robot in view.robots:
        where = f"in room {robot.place}" if robot.place else "in the corridor"
        going = "" if robot.moving_to is None else f", driving to room {robot.moving_to}"
        yield f"Robot {number_of(robot.robot)} is {where}{going}, with energy {robot.energy:g}"
    yield f"Unvisited rooms: {', '.join(str(room.room) for room in view.rooms if room.state == 'unvisited') or 'none'}"
    for talk in view.dialogues:
        yield f"Dialogue {talk.dialogue} with robot {number_of(talk.robot)}: {talk.said[-1] if talk.said else ''}"
        yield f"Choices: {'; '.join(talk.choices) or 'none'}"
