"""Replies of simulated participants: by attitude, bounded, and the same for the same seed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.dialogue.games.strategies import Attitude
from thbridge.roles.participant.reply_policy import MOST_REPLIES, MOST_TALK, Opinion, ReplyPolicy
from thbridge.roles.shared.team_notices import REASONS
from thbridge.roles.shared.view import DialogueView

SCRIPT = ("continue", "stop")
CLAIMED = ("accept", "challenge", "open-questions", "leave")
WEIGHED = ("accept", "reject", "open-questions", "leave")
DEFENDED = ("assert", "assert", "override", "open-questions", "leave")
ASKED = ("enquire", "enquire", "close-questions")
QUESTIONED = ("assert", "assert", "assert", "open-questions", "leave")
ENDED = ("assert", "question", "leave")
OFFERS = [SCRIPT, CLAIMED, WEIGHED, DEFENDED, ASKED, QUESTIONED, ENDED]
OPINIONS = st.builds(Opinion, st.booleans(), st.booleans(), st.booleans())


def offer(acts: tuple[str, ...], number: int = 1, replies: int = 0) -> DialogueView:
    """A dialogue in which the participant has replied so often, and may do this now."""
    speakers = ("robot", "person") * replies + ("robot",)
    said = ("...",) * len(speakers)
    return DialogueView(number, len(said), 0, "select-room", 1, said, acts, acts, speakers)


def act(attitude: Attitude, dialogue: DialogueView, opinion: Opinion, seed: int = 1) -> str:
    return dialogue.acts[ReplyPolicy(attitude, seed).reply(dialogue, opinion)]


@given(st.sampled_from(OFFERS), st.integers(0, MOST_TALK - 1), OPINIONS)
def test_the_credulous_make_the_first_choice(acts, replies, opinion):
    assert ReplyPolicy(Attitude.CREDULOUS, 1).reply(offer(acts, replies=replies), opinion) == 0


@pytest.mark.parametrize(
    ("acts", "opinion", "done"),
    [
        (CLAIMED, Opinion(), "challenge"),
        (CLAIMED, Opinion(is_liked=True), "accept"),
        (WEIGHED, Opinion(is_dear=True), "accept"),
        (DEFENDED, Opinion(is_own=True), "assert"),
        (ENDED, Opinion(is_own=True), "question"),
        (QUESTIONED, Opinion(), "assert"),
        (SCRIPT, Opinion(), "continue"),
        (SCRIPT, Opinion(is_dear=True), "stop"),
        (SCRIPT, Opinion(is_own=True, is_dear=True), "continue"),
    ],
)
def test_the_cautious_ask_for_reasons_of_what_they_would_not_choose_and_accept_them(acts, opinion, done):
    assert act(Attitude.CAUTIOUS, offer(acts), opinion) == done


def test_sceptics_challenge_hold_to_their_choice_reject_ask_and_put_forward_several_reasons():
    def acts_of(acts: tuple[str, ...], opinion: Opinion) -> set[str]:
        return {act(Attitude.SCEPTICAL, offer(acts, number), opinion) for number in range(100)}

    assert acts_of(CLAIMED, Opinion()) == {"challenge", "open-questions"}
    assert acts_of(WEIGHED, Opinion()) == {"accept", "reject", "open-questions"}
    assert acts_of(DEFENDED, Opinion(is_own=True)) == {"override", "open-questions"}
    assert acts_of(ENDED, Opinion(is_own=True)) == {"assert"}
    assert acts_of(ENDED, Opinion()) == {"question"}
    assert acts_of(SCRIPT, Opinion()) == {"continue", "stop"}
    assert acts_of(SCRIPT, Opinion(is_own=True)) == {"continue"}
    assert acts_of(QUESTIONED, Opinion()) == {"assert", "open-questions"}
    sceptic = ReplyPolicy(Attitude.SCEPTICAL, 1)
    assert {sceptic.reply(offer(QUESTIONED, number), Opinion()) for number in range(50)} == {0, 1, 2, 3}
    assert {sceptic.reply(offer(ASKED, number), Opinion()) for number in range(20)} == {0, 1}


@given(
    st.sampled_from([CLAIMED, WEIGHED, DEFENDED, ENDED]), st.integers(0, 99), st.integers(MOST_REPLIES, 30), OPINIONS
)
def test_a_sceptic_who_has_talked_long_gives_in_insists_or_leaves(acts, number, replies, opinion):
    assert act(Attitude.SCEPTICAL, offer(acts, number, replies), opinion) in {"accept", "override", "leave"}


@given(st.sampled_from(Attitude), st.sampled_from([CLAIMED, WEIGHED, DEFENDED, ENDED]), OPINIONS)
def test_everybody_leaves_in_the_end(attitude, acts, opinion):
    assert act(attitude, offer(acts, replies=MOST_TALK), opinion) == "leave"


@given(st.sampled_from(Attitude), st.sampled_from(OFFERS), st.integers(0, 20), OPINIONS, st.integers(0, 9))
def test_replies_are_functions_of_view_and_seed(attitude, acts, replies, opinion, seed):
    dialogue = offer(acts, replies=replies)
    assert act(attitude, dialogue, opinion, seed) == act(attitude, dialogue, opinion, seed)
    assert (
        ReplyPolicy(attitude, seed).reply(DialogueView(1, 1, 0, "select-room", 1, ("...",), ("Yes", "No")), opinion)
        == 0
    )


@pytest.mark.parametrize("attitude", Attitude)
def test_only_sceptics_object_and_only_in_some_dialogues(attitude):
    dialogues = [offer(SCRIPT, number) for number in range(1, 101)]
    raised = [ReplyPolicy(attitude, 1).objection(each, is_dear=False) for each in dialogues]
    assert {*raised} <= {None, *REASONS["select-room"]}
    count = sum(each is not None for each in raised)
    assert 10 <= count <= 30 if attitude is Attitude.SCEPTICAL else count == 0
    assert raised == [ReplyPolicy(attitude, 1).objection(each, is_dear=False) for each in dialogues]
