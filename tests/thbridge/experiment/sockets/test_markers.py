"""Markers never hold a study up: whatever fails is told, and the study goes on."""

import sys
import threading
import types

import pytest

from thbridge.experiment.sockets.markers import MOST_WAITING, MarkerStream, why_no_markers
from thbridge.experiment.store.events import Clocks, LoggedEvent, NewEvent

NOON = Clocks("2026-01-02T12:00:00Z", 5_000_000_000, 12.5)


def push(stream: MarkerStream, count: int) -> None:
    for number in range(1, count + 1):
        stream.push(LoggedEvent(number, NewEvent("item-shown", "program", NOON)))


def faulty_lsl(monkeypatch: pytest.MonkeyPatch, push) -> None:
    """Put a pylsl in place whose outlets do this with a sample."""
    module = types.ModuleType("pylsl")

    class Element:
        def append_child(self, _name):
            return self

        def append_child_value(self, _name, _value):
            return self

        def desc(self):
            return self

    class Outlet:
        def __init__(self, _info):
            self.push_sample = push

    module.local_clock = lambda: 7.0
    module.IRREGULAR_RATE, module.cf_string = 0.0, 3
    module.StreamInfo = lambda *_: Element()
    module.StreamOutlet = Outlet
    monkeypatch.setitem(sys.modules, "pylsl", module)


def test_without_pylsl_it_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    stream = MarkerStream("x")
    push(stream, 3)
    assert stream.troubles == (
        "Markers: pylsl is not installed. Install pylsl: pip install 'thbridge[markers]'. 3 markers were not sent.",
    )
    assert stream.stamping(lambda: NOON)() == NOON
    stream.close()


def test_a_study_without_markers_loads_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    with MarkerStream("x", wanted=False) as stream:
        push(stream, 3)
        assert stream.stamping(lambda: NOON)() == NOON
    assert stream.troubles == ()


def test_without_liblsl_it_is_told_how_to_name_it(monkeypatch: pytest.MonkeyPatch) -> None:
    class NoLibrary:
        def find_spec(self, name, _path=None, _target=None):
            if name == "pylsl":
                raise RuntimeError("LSL binary library file was not found.\nLong advice.")

    monkeypatch.delitem(sys.modules, "pylsl", raising=False)
    monkeypatch.setattr(sys, "meta_path", [NoLibrary(), *sys.meta_path])
    told = why_no_markers()
    assert told.startswith("Markers: liblsl cannot be loaded (LSL binary library file was not found). Install liblsl")
    assert "PYLSL_LIB" in told


def test_an_outlet_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_sample, _stamp):
        raise RuntimeError("the network is gone\nsomewhere")

    faulty_lsl(monkeypatch, fail)
    stream = MarkerStream("x")
    assert stream.troubles == ()
    push(stream, 1)
    stream.close(60.0)
    push(stream, 2)
    assert stream.troubles == ("Markers: the network is gone. Restart the study program. 3 markers were not sent.",)


def test_an_outlet_that_hangs_holds_nobody_up(monkeypatch: pytest.MonkeyPatch) -> None:
    hangs = threading.Event()
    faulty_lsl(monkeypatch, lambda _sample, _stamp: hangs.wait())
    stream = MarkerStream("x")
    push(stream, MOST_WAITING + 50)
    assert stream.troubles[0].startswith("Markers: LSL no longer accepts markers.")
    assert "markers were not sent" in stream.troubles[0]
    stream.close(0.0)
    hangs.set()


def test_samples_have_the_clocks_of_their_events(monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[tuple[list[str], float]] = []
    faulty_lsl(monkeypatch, lambda sample, stamp: sent.append((sample, stamp)))
    stream = MarkerStream("x")
    stamped = stream.stamping(lambda: NOON)()
    assert stamped.lsl == 7.0
    stream.push(LoggedEvent(4, NewEvent("step-begun", "program", stamped, "P-AAAA", 2, "supervisor")))
    stream.close(60.0)
    assert sent == [
        (
            [
                '{"sequence": 4, "kind": "step-begun", "participant": "P-AAAA", "step": 2, "condition": "supervisor", '
                '"wall": "2026-01-02T12:00:00Z", "monotonic_ns": 5000000000, "simulated": 12.5}'
            ],
            7.0,
        )
    ]
    assert stream.troubles == ()
