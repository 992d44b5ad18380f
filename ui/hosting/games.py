"""Games that a participant plays in the window of `thbridge play`."""

import asyncio
import dataclasses
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.app import play as hunt
from thbridge.app.compose.setting import StudySetting
from thbridge.app.consent import ParticipantDeclined
from thbridge.app.listeners import StartupCallbacks
from thbridge.app.play import HuntOutcome, HuntUnfinished, PlayOptions
from thbridge.app.session.session import TickRecord
from thbridge.hunt.seats import seat_named
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.seats import seats_of
from thbridge.study.study_file import Study, with_team_size
from ui.command_line.outcome import show_outcome, usual_bag
from ui.command_line.outputs import make_ready
from ui.command_line.report import write_report
from ui.command_line.settings import setting_of
from ui.command_line.story import print_story
from ui.command_line.terminal import DECLINED, FAILED, NOT_TAKING_PART, bad_input, fail, note
from ui.first_start.compiling import compile_ahead
from ui.hosting.lobby import Answer, GameVisit, PlayGame, host
from ui.hosting.players import teammates_of
from ui.hosting.window_process import WINDOW, WindowProcess
from ui.model.lobby import LOBBY, Offer
from ui.model.playing.rules_sheet import rules_lines
from ui.model.playing.seat_words import seat_in_common, seat_sentences

PRACTICE = Study(map="practice", templates="practice", robots=1)
"""Study of the practice game: a map with a hall and two rooms, and treasures that no other set has."""


def practice_setting(game: StudySetting) -> StudySetting:
    """Return the setting of the practice game.

    Random seed, server, sound, answers and language are those of the game that follows the practice game.
    """
    study = game.study
    participant = dataclasses.replace(PRACTICE.participant, sound=study.participant.sound)
    own = setting_of(dataclasses.replace(PRACTICE, seed=study.seed, server=study.server, participant=participant), None)
    return dataclasses.replace(own, templates=own.templates.answering_as(game.templates), texts=game.texts)


def offer_of(setting: StudySetting, given: bool, languages: Mapping[str, str] | None = None, seat: str = "") -> Offer:
    """Return the offer for the start page: texts, numbers of robots, rules of the game, and the text to agree to.

    Args:
        setting: setting of the game; `participant: robots` of its study gives the numbers of robots.
        given: True if an option sets the number of robots. This number is then the only choice.
        languages: languages that the participant may choose, by name. If None, the study determines the language.
        seat: name of the participant's seat. If it is empty in a game with several, the rules hold for all seats.
    """
    study = setting.study
    game, consent = study.game, setting.consent or ""
    seats, texts = seats_of(study.seats), setting.texts
    own = seat_named(seats, seat) or seat_in_common(seats)
    rules = rules_lines(
        setting.texts,
        picture_cost=game.picture_cost,
        identify_cost=game.identify_cost,
        energy=game.energy,
        wrong_share=game.wrong_share if study.participant.shows.points and own.sees_score else None,
        by_position=setting.by_position,
        properties=setting.set_words.properties,
        seat=own,
    )
    if study.participant.robots is None or given:
        least = most = study.robots
    else:
        least, most = study.participant.robots
    usual = min(max(study.robots, least), most)
    others = texts.listed(each.label for each in seats if each.name != seat) if seats else ""
    if seats and seat:
        you_are = texts.text("pages.your_seat", seat=own.label, others=others)
        rules = (f"{you_are} {seat_sentences(texts, own)}", *rules)
    elif seats:
        rules = (texts.text("seats.depends", seats=others), *rules)
    return Offer(texts, least, most, usual, rules, consent, languages or {})


@dataclass(slots=True)
class WindowGames:
    """Games that a participant can start in the window, in the last chosen language.

    Attributes:
        study: study to play.
        file: file of the study; relative paths start from its folder.
        options: options of a game; if its bag is None, the default path is used.
        report: True to write a report of each recording.
        hosts: callbacks that report the start of the ROS graph and of the ports for watching, MAVLink and Foxglove.
        seat: name of the participant's seat; empty in a game with one participant. Other programs or simulated
            participants take the other seats.
    """

    study: Study
    file: Path | None
    options: PlayOptions
    report: bool
    hosts: StartupCallbacks
    seat: str = ""

    def setting(self, robots: int) -> StudySetting:
        """Return the study with this number of robots; end the program if the study does not allow this."""
        return setting_of(with_team_size(self.study, robots), self.file)

    def speak(self, offer: Offer, language: str) -> Offer:
        """Use another language from now on; return the offer in this language."""
        talk = dataclasses.replace(self.study.dialogue, language=language)
        self.study = dataclasses.replace(self.study, dialogue=talk)
        return offer_of(self.setting(offer.usual), offer.least == offer.most, offer.languages, self.seat)

    def game(self, robots: int) -> PlayGame:
        """Return a game with this number of robots; the game is recorded."""
        setting = self.setting(robots)
        bag = self.options.bag or usual_bag(setting)

        async def play(visit: GameVisit) -> None:
            make_ready(bag, setting.study.recording.compression)
            options = dataclasses.replace(self.options, bag=bag, left=visit.has_left, run=secrets.token_hex(8))
            outcome = await self._played(setting, options, visit, teammates_of(setting, self.seat))
            if outcome is None:
                return
            show_outcome(outcome)
            if self.report:
                with bad_input():
                    await asyncio.to_thread(write_report, bag, bag.with_suffix(".html"))

        return play

    def practice(self) -> PlayGame:
        """Return a short game for learning the rules; it is not recorded."""
        setting = practice_setting(self.setting(self.study.robots))

        async def play(visit: GameVisit) -> None:
            options = dataclasses.replace(
                self.options,
                bag=None,
                graph=None,
                watch=None,
                foxglove=None,
                outside=frozenset(),
                participant="",
                mavlink=None,
                keys=None,
                left=visit.has_left,
            )
            await self._played(setting, options, visit)

        return play

    async def _played(
        self, setting: StudySetting, options: PlayOptions, visit: GameVisit, teammates: Sequence[TabUI] = ()
    ) -> HuntOutcome | None:
        """Play a game; return None if the window was closed before the game began."""

        def ready(where: ListeningAddress | CannotListen) -> None:
            if isinstance(where, CannotListen):
                fail(FAILED, str(where))
            note(f"Other programs can join at {where.host}:{where.port}.")
            visit.ready(where)

        rooms = setting.map.room_names

        def story(moment: TickRecord) -> None:
            print_story(moment, rooms)

        # Messages of the window are answered at any time, even during a game.
        await asyncio.to_thread(compile_ahead, whole_hunt=options.rate > 0.0)
        try:
            return await hunt.play(setting, teammates, options, ready, story, self.hosts)
        except ParticipantDeclined:
            if visit.ended is None:
                raise  # Ctrl-C: the program ends.
            return None
        except HuntUnfinished as early:
            if early.stopped and visit.ended is None:
                raise  # Ctrl-C: the program ends.
            return early.outcome


def play_in_window(games: WindowGames, offer: Offer, arguments: tuple[str, ...] = ()) -> None:
    """Open the window, and play games until the participant leaves.

    Args:
        games: games to choose from.
        offer: offer for the start page.
        arguments: arguments for the window's command line.
    """
    window = WindowProcess((*WINDOW, *arguments), LOBBY)
    program = host(window, offer, secrets.token_hex(8), games.game, games.practice, games.speak, games.seat)
    try:
        with bad_input(FAILED):
            answer = asyncio.run(program)
    except ParticipantDeclined:
        fail(FAILED, NOT_TAKING_PART)
    except HuntUnfinished:
        fail(FAILED, "The hunt was stopped. The recording is complete up to this point.")
    if window.given_up and answer is not Answer.NO:
        fail(FAILED, "The window crashes each time it is opened. Play without it: --headless, or --participant person.")
    if answer is not Answer.YES:
        fail(DECLINED, NOT_TAKING_PART)
