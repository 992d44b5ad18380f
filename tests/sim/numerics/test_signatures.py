import json

import pytest

from sim.numerics.signatures import RECORDED, _read, as_line, missing
from tests.support.programs.compiling import compile_kernels

CALLS = RECORDED.read_text().splitlines()


@pytest.mark.parametrize("call", CALLS, ids=lambda call: json.loads(call)["kernel"])
def test_recorded_calls_are_read_as_they_were_written(call: str) -> None:
    kernel, arguments = _read(call)
    assert as_line(kernel, arguments, moves=json.loads(call)["moves"]) == call


def test_hunts_call_kernels_as_recorded() -> None:
    compile_kernels()
    assert not missing(before_moves=False), "kernels changed: run scripts/record_signatures.py"
