"""Notices keep the kinds that they have on the wire, whatever their classes are called, and come back as they went."""

from collections.abc import Mapping
from typing import get_args, get_type_hints

from hypothesis import given, reject
from hypothesis import strategies as st

from thbridge.roles.shared import notices
from thbridge.roles.shared.team_notices import TeamTalk
from thbridge.roles.shared.view import DeclineConsent, ParticipantRequest, View
from thbridge.text_protocol.wire.notice_format import decode_notice, encode_notice, kind_of, parse_notice

STATES = [
    each
    for each in vars(notices).values()
    if isinstance(each, type) and issubclass(each, notices.NoticeValue) and each is not notices.NoticeValue
]
VALUES = (*STATES, View, TeamTalk, DeclineConsent, *get_args(ParticipantRequest))
ON_THE_WIRE = """
    RobotsReady Orders Status MoveCosts HiderReady HidePlease HideTreasures Reply ParticipantReady Failed Subscribe
    Whereabouts Ways House Texts Picture MayRecord Recordable Unfit
    View Talk Decline Agree Select Unsure Answer SendRobot CallBack AskBack HandOver Sense Discuss
    TakePicture Identify Leave TakeUp GiveUp PlayAgain Measure Tell Say Read Vote Object
"""


# Else hypothesis makes mappings that JSON does not know.
st.register_type_strategy(Mapping, lambda kind: st.dictionaries(*map(st.from_type, get_args(kind)), max_size=3))


def any_of(value_class: type) -> st.SearchStrategy:
    hints = get_type_hints(value_class)
    fields = {name: st.from_type(hints[name]) for name in value_class.__struct_fields__}
    return st.fixed_dictionaries(fields).map(lambda fields: value_class(**fields))


def test_kinds_on_the_wire_stay():
    assert [kind_of(each) for each in VALUES] == ON_THE_WIRE.split()


@given(st.one_of(*map(any_of, VALUES)))
def test_any_notice_comes_back_as_it_went(value):
    try:
        message = encode_notice("A", "B", value)
    except ValueError:  # JSON has no word for a number that is not finite
        reject()
    assert decode_notice(parse_notice(message), type(value)) == value
