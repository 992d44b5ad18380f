"""Notices keep the kinds that they have on the wire, whatever their classes are called."""

from typing import get_args

from thbridge.roles.notices import StateNotice, kind_of

ON_THE_WIRE = """
    RobotsReady Orders Status HiderReady HidePlease HideTreasures Reply ParticipantReady Subscribe Whereabouts Ways
    House Picture Unfit
"""


def test_kinds_on_the_wire_stay():
    assert [kind_of(notice_class) for notice_class in get_args(StateNotice)] == ON_THE_WIRE.split()
