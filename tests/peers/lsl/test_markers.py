"""A recorder of the Lab Streaming Layer, a program of its own, hears each event of a study's log."""

import itertools
import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import skip_if_crashed
from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.sockets.markers import MarkerStream
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks

try:
    import pylsl
except (ImportError, RuntimeError, OSError) as error:
    pytest.skip(f"pylsl or liblsl cannot be loaded: {error}", allow_module_level=True)

PATIENCE = 30.0
RECORDER = f"""
import json, sys
import pylsl
found = pylsl.resolve_byprop("source_id", sys.argv[1], timeout={PATIENCE})
assert len(found) == 1, found
info = found[0]
inlet = pylsl.StreamInlet(info)
inlet.open_stream(timeout={PATIENCE})
study = inlet.info(timeout={PATIENCE}).desc().child_value("study")
kind = [info.type(), info.channel_count(), info.nominal_srate(), info.channel_format(), study]
print(json.dumps(kind), flush=True)
while True:
    sample, stamp = inlet.pull_sample(timeout={PATIENCE})
    assert sample is not None
    print(json.dumps([json.loads(sample[0]), stamp]), flush=True)
    if json.loads(sample[0])["kind"] == "note":
        break
"""


def test_a_recorder_hears_each_event_with_the_times_of_the_log(tmp_path: Path) -> None:
    design = read_experiment(write_experiment(tmp_path))
    title = f"{design.file.title} {tmp_path.name}"
    stream = MarkerStream(title)
    ticks = itertools.count(1)
    source = stream.source
    recorder = subprocess.Popen((sys.executable, "-c", RECORDER, source), stdout=subprocess.PIPE, text=True)
    try:
        assert json.loads(recorder.stdout.readline()) == ["Markers", 1, 0.0, pylsl.cf_string, title]
        with ExperimentLog(tmp_path / "log") as log:
            clocks = stream.stamping(lambda: Clocks("2026-01-02T12:00:00Z", next(ticks)))
            conductor = Conductor(design, log, clocks, lambda most: next(ticks) % most)
            conductor.listeners.append(stream.push)
            run = conductor.admit()
            conductor.end(run.participant, conductor.begin(run.participant))
            conductor.note("the last one")
        told = [json.loads(line) for line in recorder.stdout]
        skip_if_crashed("the recorder of LSL", recorder.wait(PATIENCE))
        assert recorder.wait(PATIENCE) == 0
    finally:
        recorder.kill()
        stream.close()
    entries = read_log(tmp_path / "log")
    assert len(entries) == len(told) == 4
    for entry, (sample, stamp) in zip(entries, told, strict=True):
        event = entry.event
        assert stamp == event.clocks.lsl
        assert sample == {
            "sequence": entry.sequence,
            "kind": event.kind,
            "participant": event.participant,
            "step": event.step,
            "condition": event.condition,
            "wall": event.clocks.wall,
            "monotonic_ns": event.clocks.monotonic_ns,
            "simulated": None,
        }
    assert stream.troubles == ()
