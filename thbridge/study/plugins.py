"""Plug-ins that a study names."""

from collections.abc import Iterator

from thbridge.files.plugins import PARTICIPANTS, STRATEGIES, WORDINGS
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.study.study_file import Study


def plugins_of(*studies: Study) -> tuple[str, ...]:
    """Return the keys of all plug-ins that studies name, in alphabetical order; see `PluginKind.key`."""
    return tuple(sorted({key for study in studies for key in _plugins_of(study)}))


def _plugins_of(study: Study) -> Iterator[str]:
    talk = study.dialogue
    if study.participant.strategy not in set(BotStrategy):
        yield PARTICIPANTS.key(study.participant.strategy)
    if talk.author is not None:
        yield WORDINGS.key(talk.author)
    for manner in (talk.manner, *talk.each.values()):
        if (strategy := talk.strategy_of(manner)) is not None:
            yield STRATEGIES.key(strategy)
