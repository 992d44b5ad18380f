"""Search for the plug-ins that a study names."""

from collections.abc import Iterator, Mapping

from sim.parameters import PartKind, RobotParameters, installed_names
from thbridge.files.plugins import LOCALIZERS, PARTICIPANTS, PLANNERS, RECOVERIES, STRATEGIES, WORDINGS, PluginKind
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.study.study_file import Study

PART_KINDS: Mapping[PartKind, PluginKind] = {
    "localizers": LOCALIZERS,
    "planners": PLANNERS,
    "recoveries": RECOVERIES,
}
"""Kind of plug-in for each kind of robot part."""


def plugins_of(*studies: Study) -> tuple[str, ...]:
    """Return the keys of all plug-ins that the studies name, in alphabetical order; see `PluginKind.key`."""
    return tuple(sorted({key for study in studies for key in _plugins_of(study)}))


def part_keys(*robots: RobotParameters) -> Iterator[str]:
    """Yield the keys of the plug-ins that the robots' parameters name."""
    for software in robots:
        for kind, _, name in installed_names(software):
            yield PART_KINDS[kind].key(name)


def _plugins_of(study: Study) -> Iterator[str]:
    yield from part_keys(study.robot, *study.each.values())
    talk = study.dialogue
    if study.participant.strategy not in set(BotStrategy):
        yield PARTICIPANTS.key(study.participant.strategy)
    if talk.author is not None:
        yield WORDINGS.key(talk.author)
    for manner in (talk.manner, *talk.each.values()):
        if (strategy := talk.strategy_of(manner)) is not None:
            yield STRATEGIES.key(strategy)
