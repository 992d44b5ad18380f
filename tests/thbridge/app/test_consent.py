"""Consent before anything is recorded: the desk before a session, and the log of a server."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from msgspec import structs

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from thbridge.app.compose.game import build_keeper
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.consent import ConsentDesk, introductions
from thbridge.app.server import ConsentedLog
from thbridge.app.session.session import Session
from thbridge.hunt.events import EndReason, GameEnded, TreasuresHidden
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.journal_folder import JournalStore
from thbridge.roles.keeper.disclosed.consent import ConsentStatus
from thbridge.roles.shared.notices import KEEPER, ParticipantReady
from thbridge.roles.shared.view import DeclineConsent, GiveConsent, View
from thbridge.study.seats import SeatEntry
from thbridge.study.study_file import ParticipantSection, Study
from thbridge.text_protocol.wire.lines import TextMessage, encode_line, parse_line
from thbridge.text_protocol.wire.notice_format import Notice, NoticeValue, encode_notice, parse_notice
from thbridge.text_protocol.wire.router import RouterOutput, SendToClient, TurnedAway

CONSENT = "We record what you do."


@pytest.fixture(scope="module")
def setting(tmp_path_factory: pytest.TempPathFactory) -> StudySetting:
    folder = tmp_path_factory.mktemp("study")
    (folder / "consent.txt").write_text(CONSENT)
    return read_setting(Study(robots=1, participant=ParticipantSection(consent=Path("consent.txt"))), folder)


def views_in(outputs: Sequence[RouterOutput]) -> list[View]:
    """Return the views that a router sends."""
    lines = [parse_line(output.data.decode()) for output in outputs if isinstance(output, SendToClient)]
    notices = [parse_notice(line) for line in lines if isinstance(line, TextMessage)]
    views = [View.of_notice(notice) for notice in notices if isinstance(notice, Notice)]
    return [view for view in views if view is not None]


class Visitor:
    """A program at a desk."""

    def __init__(self, setting: StudySetting, hello: bytes) -> None:
        self.desk = ConsentDesk(Session(build_keeper(setting), []).router, introductions(setting, ["TabUI"]))
        connection = self.desk.connect(0.0)
        assert not isinstance(connection, TurnedAway)
        self._connection = connection
        self._send(hello)

    def tell(self, value: NoticeValue) -> list[View]:
        """Send a notice to the keeper; return the views that come back."""
        return views_in(self._send(encode_line(encode_notice("TabUI", KEEPER, value).line())))

    def _send(self, data: bytes) -> Sequence[RouterOutput]:
        return self.desk.receive_data(self._connection, data, 0.0)


EXTENDED = b"%%setid TabUI extended t0\n"


def test_who_joins_is_shown_the_text_and_answers(setting: StudySetting) -> None:
    visitor = Visitor(setting, EXTENDED)
    (view,) = visitor.tell(ParticipantReady())
    assert (view.consent, view.ready, len(view.robots)) == (CONSENT, True, 1)
    assert visitor.desk.status is ConsentStatus.AWAITED
    visitor.tell(GiveConsent("2026-11-23T09:30:00Z"))
    assert visitor.desk.status is ConsentStatus.GIVEN


def test_a_no_stands_whatever_comes_after_it(setting: StudySetting) -> None:
    visitor = Visitor(setting, EXTENDED)
    visitor.tell(DeclineConsent())
    visitor.tell(GiveConsent())
    assert visitor.desk.status is ConsentStatus.DECLINED


def test_who_agreed_before_joining_is_shown_no_text(setting: StudySetting) -> None:
    visitor = Visitor(setting, EXTENDED)
    visitor.tell(GiveConsent())
    assert visitor.tell(ParticipantReady()) == []


def test_a_participant_of_2016_is_not_waited_for(setting: StudySetting) -> None:
    assert Visitor(setting, b"%%setid TabUI\n").desk.status is ConsentStatus.NOT_ASKED
    assert Visitor(setting, b"%%setid Hider\n").desk.status is ConsentStatus.AWAITED


def test_a_game_with_seats_starts_when_all_have_agreed(tmp_path: Path) -> None:
    (tmp_path / "consent.txt").write_text(CONSENT)
    seats = (SeatEntry("driver", robots=(1,)), SeatEntry("namer"))
    study = Study(robots=1, participant=ParticipantSection(consent=Path("consent.txt")), seats=seats)
    setting = read_setting(study, tmp_path)
    desk = ConsentDesk(
        Session(build_keeper(setting), []).router, introductions(setting, ["TabUI-driver", "TabUI-namer"])
    )

    def say(name: str, value: NoticeValue) -> Sequence[RouterOutput]:
        connection = desk.connect(0.0)
        assert not isinstance(connection, TurnedAway)
        line = encode_line(encode_notice(name, KEEPER, value).line())
        hello = encode_line(f"%%setid {name} extended t0")
        return [each for data in (hello, line) for each in desk.receive_data(connection, data, 0.0)]

    (view,) = views_in(say("TabUI-driver", ParticipantReady()))
    assert (view.consent, view.team.own.name) == (CONSENT, "driver")
    say("TabUI-driver", GiveConsent())
    assert desk.status is ConsentStatus.AWAITED
    say("TabUI", GiveConsent())
    say("Hider", GiveConsent())
    assert desk.status is ConsentStatus.AWAITED
    say("TabUI-namer", GiveConsent())
    assert desk.status is ConsentStatus.GIVEN


def test_a_server_writes_a_game_from_its_start_once_its_participant_has_agreed(tmp_path: Path) -> None:
    status = ConsentStatus.AWAITED
    hunt = HuntWithoutSimulator()
    hunt.run(6)
    started, *rest = hunt.log.events
    hidden = next(event for event in rest if isinstance(event, TreasuresHidden))
    log = ConsentedLog(JournalStore(tmp_path), lambda: status)
    log.append((started, hidden))
    assert list(tmp_path.iterdir()) == []
    status = ConsentStatus.GIVEN
    log.append(())
    ended = GameEnded(EndReason.GIVEN_UP, 0)
    # The next person plays on at the same server, and has not answered yet.
    status = ConsentStatus.AWAITED
    log.append((ended, structs.replace(started, game=2)))
    assert read_journal(journal_path(tmp_path, 1)).events == (hidden, ended)
    assert not journal_path(tmp_path, 2).exists()
