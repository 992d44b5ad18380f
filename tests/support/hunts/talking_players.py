"""Simulated participants of seats that also send texts to each other, and report the texts that they have read."""

from collections.abc import Sequence

from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import StudySetting
from thbridge.roles.participant.bots import Bot
from thbridge.roles.participant.installed_participant import InstalledParticipant
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.team_notices import MarkRead, SayToPeople, TeamTalk
from thbridge.roles.shared.view import ParticipantRequest, View


class TalkingPlayer:
    """Player of a seat: a simulated participant that greets all, and answers each text with a text to its author."""

    def __init__(self, seat: str, bot: Bot | InstalledParticipant) -> None:
        self._seat = seat
        self._bot = bot
        self._texts: list[SayToPeople | MarkRead] = [SayToPeople(f"Hello, I am {seat}.", typing=0.5)]

    def observe(self, level: ParticipantUpdate) -> None:
        """Receive a notice; see `ParticipantObserver`."""
        if isinstance(level, TeamTalk):
            others = [line for line in level.lines if line.seat != self._seat]
            self._texts += [SayToPeople(f"Welcome, {line.seat}!", line.seat) for line in others if not line.to]
            self._texts += [MarkRead(line.line) for line in others]

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the next requests; see `Player`."""
        texts, self._texts = self._texts, []
        return [*texts, *self._bot.requests(view)]


def talking_participants(setting: StudySetting) -> tuple[TabUI, ...]:
    """Return a talking participant for each seat of a study."""
    who = setting.study.participant
    participants = []
    for seed, entry in enumerate(setting.study.seats):
        bot = build_bot(setting.templates, entry.strategy or who.strategy, seed, entry.attitude or who.attitude)
        player = TalkingPlayer(entry.name, bot)
        participants.append(TabUI(player, player, seat=entry.name))
    return tuple(participants)
