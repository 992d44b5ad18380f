"""Computation of the screen from the participant's memory."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import Condition
from thbridge.roles.shared.view import GiveConsent
from ui.model.playing.cards import cards, moved_cards, nothing_waits
from ui.model.playing.keys import HELP, WAITING_KEY, help_lines, is_letter, keyed, popup_keys
from ui.model.playing.memory.popup_queue import DestinationItem, PopupItem, TreasureItem
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.people import people_panel
from ui.model.playing.popups.confirmations import confirmation
from ui.model.playing.popups.dialogues import destination_popup, dialogue_title
from ui.model.playing.popups.game_over import game_over_page
from ui.model.playing.popups.treasures import PICTURE_TIMEOUT, treasure_popup
from ui.model.playing.rules_sheet import rules_of
from ui.model.playing.screen import (
    Action,
    Banner,
    DeclineConsentAct,
    DialoguePopup,
    EndGameAct,
    FitMap,
    FollowRobot,
    GiveConsentAct,
    Phase,
    RequestSuggestionAct,
    RobotCard,
    Screen,
    ShowHelp,
    ShowSettings,
    ShowWaiting,
    TreasurePopup,
    WaitingItem,
)
from ui.model.playing.seat_view import sees_map, sees_score
from ui.model.playing.sounds import why_silent
from ui.model.playing.tiles import dont_know, end, tiles
from ui.model.playing.votes import open_votes
from ui.model.playing.words import outcome_of, progress_of, verdict_words


def compose(memory: ParticipantMemory, now: float) -> Screen:
    """Return the present screen without announcements."""
    texts, hunt = memory.texts, memory.hunt
    phase = phase_of(memory)
    playing = hunt if phase is Phase.PLAYING else None
    team = () if hunt is None else cards(memory, hunt)
    screen = Screen(
        phase=phase,
        waiting_for=_waiting_for(memory) if phase is Phase.CONNECTING else "",
        consent="" if hunt is None or hunt.view.consent is None else hunt.view.consent,
        agree=_agree(memory),
        decline=keyed(DeclineConsentAct(), texts.text("game.decline"), hint=texts.text("game.decline_hint")),
        banner=_banner(memory, now),
        game=0 if hunt is None or memory.once else hunt.view.game,
        score=0 if hunt is None else hunt.view.score if sees_score(hunt.view) else None,
        progress="" if hunt is None else _progress(hunt),
        cards=team,
        tiles=() if hunt is None else tiles(memory, hunt),
        ask_advice=_not_now(texts, RequestSuggestionAct(), "tiles.dont_know")
        if playing is None
        else dont_know(memory, playing),
        end=_not_now(texts, EndGameAct(), "tiles.end") if playing is None else end(playing),
        tools=_tools(memory, playing),
        popup=None if playing is None else _popup(memory, playing, now),
        confirmation=None if playing is None else confirmation(memory, playing),
        waiting=() if playing is None else _waiting(playing),
        history=memory.history.lines,
        ending=game_over_page(hunt, memory.once) if hunt is not None and phase is Phase.OVER else None,
        help=_help(memory, hunt) if memory.help_open else (),
        typed=memory.typed,
        announcement="",
        announcement_number=0,
        rules=rules_of(texts, hunt.view) if hunt is not None and memory.help_open else (),
        nothing_waits="" if playing is None else _nothing_waits(playing, team),
        people=None if hunt is None else people_panel(memory, hunt),
        votes=() if playing is None else open_votes(playing),
        no_map=_no_map(hunt),
    )
    screen = _without_popup_keys(replace(screen, enlarged=_enlarged(hunt, screen)))
    match screen.popup:
        case TreasurePopup(asks_for_name=True):
            return _without_letters(screen)
        case DialoguePopup(numbered=True):
            return _without_digits(screen)
        case _:
            return screen


def with_motions(screen: Screen, memory: ParticipantMemory, moved: Collection[int]) -> Screen:
    """Return a screen after a change only of these robots' motions and of the time played."""
    hunt = memory.hunt
    if hunt is None:
        return screen
    team = moved_cards(hunt, screen.cards, memory.motions, moved)
    words = _nothing_waits(hunt, team) if screen.phase is Phase.PLAYING else screen.nothing_waits
    screen = replace(screen, cards=team, progress=_progress(hunt), nothing_waits=words)
    if not screen.votes:
        return screen
    return _without_popup_keys(replace(screen, votes=open_votes(hunt)))


def _no_map(hunt: HuntMemory | None) -> str:
    return "" if hunt is None or sees_map(hunt.view) else hunt.texts.text("seats.no_map")


def _nothing_waits(hunt: HuntMemory, team: Sequence[RobotCard]) -> str:
    return nothing_waits(hunt.texts, team, answering=hunt.popups.shown is not None)


def _progress(hunt: HuntMemory) -> str:
    left = sum(room.state != "visited" for room in hunt.view.rooms)
    return progress_of(hunt.texts, hunt.seconds, left, len(hunt.view.rooms))


def _enlarged(hunt: HuntMemory | None, screen: Screen) -> bytes | None:
    """Return the picture of the pop-up if the picture is enlarged and not covered; otherwise None."""
    if hunt is None or hunt.enlarged is None or screen.popup is None or screen.confirmation is not None or screen.help:
        return None
    return screen.popup.picture


def _without_digits(screen: Screen) -> Screen:
    """Return the screen without keys on the buttons of rooms, because digits are the keys of the pop-up's answers."""
    return replace(screen, tiles=tuple(replace(tile, choose=replace(tile.choose, key="")) for tile in screen.tiles))


def _without_popup_keys(screen: Screen) -> Screen:
    """Return the screen without keys on the buttons of votes and hand-overs that belong to the pop-up shown."""
    taken = popup_keys(screen)

    def bare(action: Action | None) -> Action | None:
        return replace(action, key="") if action is not None and action.key in taken else action

    if not taken or not (screen.votes or any(card.hand_over for card in screen.cards)):
        return screen
    return replace(
        screen,
        votes=tuple(replace(vote, agree=bare(vote.agree), disagree=bare(vote.disagree)) for vote in screen.votes),
        cards=tuple(replace(card, hand_over=bare(card.hand_over)) for card in screen.cards),
    )


def _without_letters(screen: Screen) -> Screen:
    """Return the screen without letter keys on buttons outside the pop-up.

    Letters select a name in the list of the pop-up.
    """

    def bare(action: Action) -> Action:
        return replace(action, key="") if is_letter(action.key) else action

    return replace(
        screen,
        cards=tuple(
            replace(card, stop=card.stop and bare(card.stop), ask_back=card.ask_back and bare(card.ask_back))
            for card in screen.cards
        ),
        ask_advice=bare(screen.ask_advice),
        end=bare(screen.end),
        tools=tuple(bare(tool) for tool in screen.tools),
        waiting=tuple(replace(item, show=bare(item.show)) for item in screen.waiting),
    )


def phase_of(memory: ParticipantMemory) -> Phase:
    """Return the kind of page to show."""
    if memory.hunt is None:
        return Phase.CONNECTING
    if memory.hunt.view.consent is not None:
        return Phase.CONSENT
    return Phase.PLAYING if memory.hunt.view.over is None else Phase.OVER


def next_change(memory: ParticipantMemory, now: float) -> float:
    """Return the time at which the screen changes if no event comes first; infinite if it does not change."""
    due = [memory.connection.next_change(now), memory.typed_until]
    if memory.note is not None:
        due.append(memory.note.until)
    if memory.hunt is not None:
        due += [since + PICTURE_TIMEOUT for since in memory.hunt.picture_times.values()]
        due += [memory.hunt.choice.until] if memory.hunt.choice is not None else []
    return min((time for time in due if time > now), default=float("inf"))


def _waiting_for(memory: ParticipantMemory) -> str:
    texts = memory.texts
    if memory.connection.is_lost:
        parts = (texts.text("game.unreachable"), memory.connection.why_lost, texts.text("game.reconnecting"))
        return " ".join(filter(None, parts))
    return texts.text("game.robots_get_ready" if memory.connection.is_there else "game.looking_for_game")


def _banner(memory: ParticipantMemory, now: float) -> Banner | None:
    texts, trouble = memory.texts, memory.connection.trouble(memory.texts, now)
    view = None if memory.hunt is None else memory.hunt.view
    if trouble is not None and memory.connection.is_lost:
        return Banner(trouble, "bad")
    if view is not None and not view.ready:
        return Banner(texts.text("game.robots_away"), "bad")
    if trouble is not None and view is not None and view.over is None:
        return Banner(trouble, "bad")
    if memory.note is not None and now < memory.note.until:
        # The page after the game already says that the game is over.
        twice = (
            view is not None and view.over is not None and memory.note.sentence == texts.text("hints.refused_game_over")
        )
        return None if twice else Banner(memory.note.sentence, "note")
    if view is not None and view.over is None and all(robot.condition is Condition.SILENT for robot in view.robots):
        return Banner(texts.text("game.all_silent"), "bad")
    if view is None or view.team is not None:
        return None
    if view.over is None and all(robot.has_other_commander for robot in view.robots):
        return Banner(texts.text("game.all_commanded"), "note")
    return None


def _agree(memory: ParticipantMemory) -> Action:
    act, texts, hunt = GiveConsentAct(), memory.texts, memory.hunt
    if hunt is None or hunt.view.consent is None:
        return _not_now(texts, act, "game.agree")
    busy = hunt.pending.has_kind(GiveConsent)
    return keyed(act, texts.text("game.agree"), not busy, texts.text("game.agree_hint"), busy)


def _not_now(texts: Texts, act: GiveConsentAct | RequestSuggestionAct | EndGameAct, label: str) -> Action:
    return keyed(act, texts.text(label), enabled=False, hint=texts.text("hints.not_now"))


def _help(memory: ParticipantMemory, hunt: HuntMemory | None) -> tuple[tuple[str, str], ...]:
    if hunt is None:
        return help_lines(memory.texts, 0)
    properties = any(not each.is_found for each in hunt.view.properties)
    argues, seats = hunt.view.has_last_word is not None, hunt.view.team
    return help_lines(
        hunt.texts,
        len(hunt.view.rooms),
        why_silent(memory, hunt),
        properties=properties,
        numbered=argues,
        team=seats is not None,
        has_map=sees_map(hunt.view),
        objects=seats is not None and seats.own.may_object,
    )


def _tools(memory: ParticipantMemory, hunt: HuntMemory | None) -> tuple[Action, ...]:
    texts = memory.texts
    sheet = Action(ShowHelp(), texts.text("game.help"), HELP.keys[0], hint=texts.text("game.help_hint"))
    settings = keyed(ShowSettings(), texts.text("settings.title"), hint=texts.text("settings.hint"))
    if hunt is None:
        return (sheet,)
    if not sees_map(hunt.view):
        return (settings, sheet)
    follow = texts.text("game.follow" if memory.followed is None else "game.unfollow")
    return (
        keyed(FollowRobot(), follow, hint=texts.text("game.follow_hint", robot=memory.selected)),
        keyed(FitMap(), texts.text("game.whole_map"), hint=texts.text("game.whole_map_hint")),
        settings,
        sheet,
    )


def _popup(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> DialoguePopup | TreasurePopup | None:
    match hunt.popups.shown:
        case DestinationItem() as item:
            return destination_popup(hunt, item)
        case TreasureItem() as find:
            return treasure_popup(hunt, memory.pictures, find, now)
        case None:
            return None


def _waiting(hunt: HuntMemory) -> tuple[WaitingItem, ...]:
    first, show = hunt.popups.next, hunt.texts.text("game.show")
    return tuple(
        WaitingItem(
            item.robot,
            _waits(hunt, item),
            Action(_showing(item), show, WAITING_KEY if item == first else "", hint=_waits(hunt, item)),
        )
        for item in hunt.popups.waiting
        if item not in hunt.popups.quiet
    )


def _showing(item: PopupItem) -> ShowWaiting:
    return ShowWaiting(item.robot, item.room) if isinstance(item, TreasureItem) else ShowWaiting(item.robot)


def _waits(hunt: HuntMemory, item: PopupItem) -> str:
    texts = hunt.texts
    if isinstance(item, DestinationItem):
        dialogue = hunt.destination_dialogue(item.robot)
        if dialogue is not None:
            return dialogue_title(hunt, dialogue)
        words = hunt.unread_words(item.robot)
        return texts.text("game.waits_asked", robot=item.robot) if words is None else outcome_of(texts, words)
    about = hunt.treasure_dialogue(item)
    if about is not None:
        return dialogue_title(hunt, about)
    room = hunt.view.room(item.room)
    if room.verdict is not None:
        word, points = hunt.view.word_for(room.verdict.name), room.verdict.points
        verdict = verdict_words(texts, word, points, shows_points=sees_score(hunt.view))
        return texts.text("history.named", room=item.room, verdict=verdict)
    if hunt.robot_in_room(item.room) is None:
        return texts.text("popups.found", robot=item.robot, room=item.room)
    found = "game.waits_found" if room.found else "game.waits_looking"
    return texts.text(found, robot=item.robot, room=item.room)
