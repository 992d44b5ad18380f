"""Open votes of the participants, as they are shown, and the results of ended votes in words."""

import math
from collections.abc import Iterator

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.team_notices import DecisionView, SettledView, Vote, VoteView
from thbridge.roles.shared.view import TeamView, View
from ui.model.playing.keys import question_keys
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.people import shown_text
from ui.model.playing.screen import Action, CastVote, OpenVote, VoteAct
from ui.model.playing.seat_view import decision_about, decisions, label_of
from ui.model.playing.words import clock_words


def open_votes(hunt: HuntMemory) -> tuple[OpenVote, ...]:
    """Return the open votes, oldest first. The first that waits for the participant has the keys."""
    team = hunt.view.team
    if team is None or hunt.view.over is not None:
        return ()
    waiting = next((each.decision for each in team.decisions if _awaits(hunt, team, each)), None)
    return tuple(_vote(hunt, team, each, has_keys=each.decision == waiting) for each in team.decisions)


def vote_on_name(hunt: HuntMemory, room: int) -> str | None:
    """Return a sentence if there is a vote on the name of the treasure in a room, or None."""
    decision = decision_about(hunt.view, room=room)
    if decision is None:
        return None
    return hunt.texts.text("votes.on_name", name=hunt.view.word_for(decision.name))


def vote_on_end(hunt: HuntMemory) -> str | None:
    """Return a sentence if there is a vote on the end of the game, or None."""
    return None if decision_about(hunt.view) is None else hunt.texts.text("votes.on_end")


def proposal(texts: Texts, view: View, decision: DecisionView) -> str:
    """Return a sentence that says who proposes what."""
    own = view.team is not None and view.team.own.name == decision.seat
    return _about(texts, view, decision, "by_you" if own else "by_teammate", seat=label_of(view, decision.seat))


def news_of(texts: Texts, before: View, view: View) -> Iterator[str]:
    """Yield sentences about proposals, votes and results that are new in a view."""
    known = {each.decision: each.votes for each in decisions(before)}
    for each in decisions(view):
        if each.decision not in known:
            yield proposal(texts, view, each)
        yield from _new_votes(texts, view, each, known.get(each.decision, ()))
    for ended in _newly_settled(before, view):
        yield from _new_votes(texts, view, ended.decision, known.get(ended.decision.decision, ()))
        yield _about(texts, view, ended.decision, ended.outcome)


def results_of(texts: Texts, before: View, view: View) -> str:
    """Return sentences about the results of votes that are new in a view; empty if there are none."""
    return " ".join(_about(texts, view, each.decision, each.outcome) for each in _newly_settled(before, view))


def _newly_settled(before: View, view: View) -> Iterator[SettledView]:
    known = () if before.team is None else before.team.settled
    return (each for each in (() if view.team is None else view.team.settled) if each not in known)


def vote_words(texts: Texts, view: View, vote: VoteView) -> str:
    """Return a vote as a sentence, with the reason."""
    own = view.team is not None and view.team.own.name == vote.seat
    key = f"votes.{'you_' if own else ''}{'agree' if vote.agrees else 'disagree'}{'' if own else 's'}"
    if not vote.reason:
        return texts.text(key, seat=label_of(view, vote.seat))
    return texts.text(f"{key}_because", seat=label_of(view, vote.seat), reason=shown_text(vote.reason))


def needed(texts: Texts, view: View, decision: DecisionView) -> str:
    """Return the number of people who must still agree, as a sentence."""
    mates = () if view.team is None else view.team.teammates
    # People who have left cannot agree any more.
    most = 1 + sum(mate.present for mate in mates)
    agreed = 1 + sum(vote.agrees for vote in decision.votes)
    return texts.text("votes.needed", count=max(1, min(decision.needs, most) - agreed))


def awaits_own(view: View, decision: DecisionView) -> bool:
    """Return True if the participant has not voted on a decision yet."""
    own = "" if view.team is None else view.team.own.name
    return own not in {decision.seat, *(vote.seat for vote in decision.votes)}


def _awaits(hunt: HuntMemory, team: TeamView, decision: DecisionView) -> bool:
    pending = (each for each in hunt.pending.requests if isinstance(each, Vote))
    return awaits_own(hunt.view, decision) and all(each.decision != decision.decision for each in pending)


def _vote(hunt: HuntMemory, team: TeamView, decision: DecisionView, *, has_keys: bool) -> OpenVote:
    texts, own = hunt.texts, decision.seat == team.own.name
    yes, no = (binding.keys[0] if has_keys else "" for binding in question_keys(texts))
    return OpenVote(
        decision=decision.decision,
        robot=decision.robot,
        title=proposal(texts, hunt.view, decision),
        votes=tuple(CastVote(vote_words(texts, hunt.view, vote), vote.agrees) for vote in decision.votes),
        needed=needed(texts, hunt.view, decision) + (f" {texts.text('votes.others_vote')}" if own else ""),
        left=_left(hunt, decision),
        agree=None if own else _button(hunt, team, decision, yes, agrees=True),
        disagree=None if own else _button(hunt, team, decision, no, agrees=False),
    )


def _button(hunt: HuntMemory, team: TeamView, decision: DecisionView, key: str, *, agrees: bool) -> Action:
    texts, word = hunt.texts, "agree" if agrees else "disagree"
    voted = any(vote.seat == team.own.name and vote.agrees == agrees for vote in decision.votes)
    busy = any(
        isinstance(each, Vote) and (each.decision, each.agrees) == (decision.decision, agrees)
        for each in hunt.pending.requests
    )
    hint = texts.text(f"votes.have_{word}d") if voted else ""
    return Action(VoteAct(decision.decision, agrees), texts.text(f"votes.{word}"), key, not voted, hint, busy)


def _left(hunt: HuntMemory, decision: DecisionView) -> str:
    """Return the time until a vote ends; empty before the first telemetry of the robots."""
    if hunt.ticks is None:
        return ""
    seconds = max(0, math.ceil(decision.ends_at - hunt.ticks[1] / TICKS_PER_SECOND))
    return hunt.texts.text("votes.left", time=clock_words(seconds))


def _new_votes(texts: Texts, view: View, decision: DecisionView, known: tuple[VoteView, ...]) -> Iterator[str]:
    return (vote_words(texts, view, vote) for vote in decision.votes if vote not in known)


def _about(texts: Texts, view: View, decision: DecisionView, suffix: str, seat: str = "") -> str:
    return texts.text(
        f"votes.{decision.kind}_{suffix}",
        seat=seat,
        robot=decision.robot or 0,
        room=decision.room or 0,
        name=view.word_for(decision.name),
    )
