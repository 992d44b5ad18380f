"""Texts and votes of the participants of one game."""

import math
from dataclasses import dataclass, field

from thbridge.hunt.events import (
    DecisionKind,
    DecisionProposed,
    DecisionSettled,
    PersonRead,
    PersonSaid,
    TeamEntry,
    VoteCast,
)
from thbridge.roles.keeper.team.decisions import AgreementRule, TeamDecisions, VotingRules
from thbridge.roles.keeper.team.people_talk import PeopleTalk, TalkRules

_NO_VOTES = VotingRules(dict.fromkeys(DecisionKind, AgreementRule.ONE), math.inf)
_NO_TALK = TalkRules(math.inf, math.inf)


@dataclass(frozen=True, slots=True)
class TeamRules:
    """Rules for the participants of a game: when they may send texts, and which decisions need votes."""

    talk: TalkRules = _NO_TALK
    voting: VotingRules = field(default_factory=lambda: _NO_VOTES)


class GameTeam:
    """The participants of one game.

    Args:
        rules: the rules for them.

    Attributes:
        talk: their texts.
        decisions: their votes.
    """

    def __init__(self, rules: TeamRules) -> None:
        self.talk = PeopleTalk(rules.talk)
        self.decisions = TeamDecisions(rules.voting)

    def note(self, entry: TeamEntry) -> None:
        """Process an entry of the journal."""
        match entry:
            case PersonSaid() | PersonRead():
                self.talk.note(entry)
            case DecisionProposed() | VoteCast() | DecisionSettled():
                self.decisions.note(entry)
