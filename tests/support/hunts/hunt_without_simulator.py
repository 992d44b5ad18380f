"""Hunt without a simulator: robots arrive after a number of ticks; the router and all other roles are the real ones."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from thbridge.app.compose.game import build_bot, build_hider, known_treasures
from thbridge.app.session.session import NO_OUTLETS, Session, SessionOutlets, TickRecord
from thbridge.app.trials.puppets import Puppets
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.scripted.protocols import TemplateProtocol
from thbridge.dialogue.scripted.scripted_engine import ScriptedEngine
from thbridge.dialogue.scripted.strategies import TemplateStrategy
from thbridge.dialogue.scripted.templates import TemplatePhrasing
from thbridge.files.language_texts import shipped_texts
from thbridge.files.resources import shipped
from thbridge.files.template_files import TemplateSet, read_template_set
from thbridge.hunt.events import DialogueOpened, DialogueSaid, Event, JournalEntry
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.keeper.keeper import GameRules, Keeper
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.role import Role

RULES = GameRules(seed=7, energy=100.0, picture_cost=5.0, identify_cost=1.0, wrong_share=1.0)


@cache
def templates(name: str = "original-2016") -> TemplateSet:
    return read_template_set(shipped().find("templates", name, Path()))


def scripted_engine(chosen: TemplateSet, seed: int = 7) -> ScriptedEngine:
    return ScriptedEngine(
        TemplateProtocol(chosen.dialogue), TemplateStrategy(), TemplatePhrasing(chosen.dialogue, seed, shipped_texts())
    )


class Log:
    def __init__(self) -> None:
        self.entries: list[JournalEntry] = []

    @property
    def events(self) -> list[Event]:
        return [entry for entry in self.entries if not isinstance(entry, DialogueOpened | DialogueSaid)]

    def append(self, entries: Sequence[JournalEntry]) -> None:
        self.entries += entries


class HuntWithoutSimulator:
    """Session of keeper, puppets, Hider and TabUI, except those named in `outside`."""

    def __init__(
        self,
        robots: int = 2,
        strategy: BotStrategy = BotStrategy.SUGGESTION,
        set_name: str = "original-2016",
        rules: GameRules = RULES,
        outside: Collection[str] = (),
        participant: Role | None = None,
        seed: int = 7,
        briefing: Briefing | None = None,
        kinds: Sequence[TreasureKind] | None = None,
        history: Sequence[JournalEntry] = (),
        tells_refusals: bool = False,
        adviser: Adviser | None = None,
        talk: DialogueEngine | None = None,
        patience: int | None = None,
        outlets: SessionOutlets = NO_OUTLETS,
        run: str = "",
        others: Sequence[Role] = (),
    ) -> None:
        self.templates = templates(set_name)
        if kinds is not None:
            self.templates = replace(self.templates, kinds=tuple(kinds))
        self.log = Log()
        self.log.append(history)
        names = tuple(sorted(kind.name for kind in self.templates.kinds))
        known = known_treasures(self.templates)
        self.briefing = briefing or Briefing(names=names, properties=self.templates.properties, kinds=known)
        last_game = 1 if history else 0
        self.keeper = Keeper(
            rules,
            lambda game: talk or scripted_engine(self.templates, seed),
            history,
            last_game,
            self.briefing,
            adviser,
            patience,
            tells_refusals=tells_refusals,
        )
        costs = self.templates.costs or templates("original-2016").costs
        assert costs is not None
        self.puppets = Puppets(robots, plain_costs(costs))
        self.tabui: Role = participant or TabUI(build_bot(self.templates, strategy, seed))
        roles: list[Role] = [self.puppets, self.tabui, *others]
        roles.append(build_hider(self.templates, seed))
        roles = [role for role in roles if role.name not in outside]
        self.session = Session(self.keeper, roles, log=self.log, outlets=outlets, run=run)
        self.router = self.session._message_router
        self.tick_records: list[TickRecord] = []

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.tick_records.append(self.session.step())

    def finish(self, ticks: int = 20_000) -> None:
        while self.session.game is None or self.session.game.ended is None:
            self.run(1)
            if len(self.tick_records) > ticks:
                raise TimeoutError("the hunt does not end")
        self.run(5)

    @property
    def lines(self) -> list[str]:
        return [item.message.line() for tick_record in self.tick_records for item in tick_record.forwarded]

    def view(self):
        return self.tabui.view if isinstance(self.tabui, TabUI) else None
