"""The section `mavlink`: addresses, the origin, and what is wrong with them."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.files.errors import BadFiles
from thbridge.mavlink.values.options import AutopilotIdentity, Failsafe
from thbridge.sockets.addresses import Address, UdpTarget, parse_address
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study, read_study_text
from thbridge.study.text import resolved

FILE = Path("study.yaml")


def test_robots_are_no_vehicles_unless_the_study_says_so():
    section = Study().mavlink
    assert not section.on
    assert [str(target) for target in section.targets] == ["127.0.0.1:14550", "127.0.0.1:14540"]


def test_what_a_study_says_of_vehicles_is_read_and_written_again():
    text = """
mavlink:
  on: true
  identity: ardupilot
  udp: ["[::1]:14550", ground.example:1/2]
  tcp: 127.0.0.1:5760
  signing_key: keys/one.key
  origin: [-33.9, 18.4, 1080]
  lost_after: 3
  failsafe: home
  position_rate: 10
  tlog: true
"""
    study = read_study_text(FILE, text)
    section = study.mavlink
    assert section.on
    assert section.tlog
    assert section.targets == (UdpTarget(Address("::1", 14550)), UdpTarget(Address("ground.example", 1), 2))
    assert section.options.identity is AutopilotIdentity.ARDUPILOT
    assert section.options.failsafe is Failsafe.HOME
    assert (section.options.origin.latitude, section.options.origin.altitude) == (-33.9, 1080.0)
    assert read_study_text(FILE, resolved(study)) == study


@pytest.mark.parametrize(
    ("mavlink", "key", "problem"),
    [
        ("{udp: [14550]}", "mavlink.udp[0]", "'14550' is not an address"),
        ("{udp: ['127.0.0.1:0']}", "mavlink.udp[0]", "is not an address"),
        ("{udp: ['a:1', 'b:2', 'a:1/1']}", "mavlink.udp[2]", "a:1 is in this list twice"),
        ("{udp: ['a:1/2', 'b:2/3']}", "mavlink.udp[1]", "there is no robot 3: the study has 2"),
        ("{tcp: '::1:5760'}", "mavlink.tcp", "is not an address"),
        ("{origin: [90, 0, 0]}", "mavlink.origin", "90 degrees north is not within -85 to 85"),
        ("{origin: [0, 181, 0]}", "mavlink.origin", "181 degrees east is not within -180 to 180"),
        ("{origin: [0, 0, 1e5]}", "mavlink.origin", "100000 m above sea level is not within -500 to 9000"),
    ],
)
def test_what_is_wrong_is_told_with_its_key(mavlink: str, key: str, problem: str):
    with pytest.raises(BadFiles) as raised:
        read_study_text(FILE, f"mavlink: {mavlink}")
    (fault,) = raised.value.faults
    assert (fault.key, fault.line) == (key, 1)
    assert problem in fault.problem


HOSTS = st.from_regex(r"[a-z0-9]([a-z0-9.-]{0,20}[a-z0-9])?", fullmatch=True) | st.ip_addresses(v=6).map(str)


@given(HOSTS, st.integers(1, 65535))
def test_an_address_is_read_as_it_is_written(host: str, port: int):
    assert parse_address(str(Address(host, port))) == Address(host, port)


@given(st.text(max_size=30))
def test_any_text_is_an_address_or_none(text: str):
    address = parse_address(text)
    assert address is None or parse_address(str(address)) == address


def test_vehicles_are_told_what_they_need():
    options = MavlinkSection(lost_after=7.0, position_rate=2.0).options
    assert (options.lost_after, options.position_rate) == (7.0, 2.0)


@pytest.mark.parametrize("text", ["a\0b:1", "x" * 300 + ":1", "a:" + "9" * 5000, "a\x1b:1"])
def test_what_no_machine_can_be_called_is_no_address(text: str) -> None:
    assert parse_address(text) is None
