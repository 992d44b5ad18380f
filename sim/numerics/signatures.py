"""Recorded signatures of kernels that hunts usually need. With them, kernels can be compiled before their first call.

Signatures that are not recorded, or have changed, are compiled at their first call.
"""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
from numba import from_dtype, types

from sim.numerics.compiled_files import read
from sim.numerics.kernels import file_of

RECORDED = Path(__file__).with_suffix(".jsonl")
"""File with one call per line (see `as_line`), slowest compilation first. `scripts/record_signatures.py` writes it."""


def recorded_calls() -> list[str]:
    """Return all recorded calls."""
    return RECORDED.read_text(encoding="utf-8").splitlines()


def missing(*, before_moves: bool) -> list[str]:
    """Return the recorded calls that have no stored code, or only damaged code.

    Args:
        before_moves: True to return only the calls in the first tick, when no robot has a goal yet.
    """
    asked = (call for call in recorded_calls() if not (before_moves and json.loads(call)["moves"]))
    return [call for call in asked if read(kept_at(call)) is None]


def compile_call(call: str) -> None:
    """Compile the kernel of a recorded call, including all kernels that it calls."""
    kernel, arguments = _read(call)
    kernel.compile(arguments)  # type: ignore[attr-defined]  # numba's


def kept_at(call: str) -> Path:
    """Return the file with the code of a recorded call."""
    return file_of(*_read(call))


def as_line(kernel: object, arguments: tuple[types.Type, ...], *, moves: bool) -> str:
    """Return the line for a kernel and its argument types. `moves` is True if only robots with goals call it."""
    name = f"{kernel.__module__}:{kernel.__name__}"  # type: ignore[attr-defined]
    return json.dumps({"kernel": name, "arguments": list(map(_encoded, arguments)), "moves": moves})


def is_kernel(compiled: object) -> bool:
    """Return True for a kernel of this project that can be found by its name."""
    module, name = compiled.__module__, compiled.__name__  # type: ignore[attr-defined]
    return module.startswith(("sim.", "thbridge.")) and getattr(sys.modules[module], name, None) is compiled


def _read(call: str) -> tuple[object, tuple[types.Type, ...]]:
    recorded = json.loads(call)
    return _named(recorded["kernel"]), tuple(map(_decoded, recorded["arguments"]))


def _named(name: str) -> object:
    module, _, thing = name.partition(":")
    return getattr(importlib.import_module(module), thing)


def _encoded(kind: types.Type) -> object:
    """Encode a scalar by its name, an array by its layout, a tuple by its class and items."""
    match kind:
        case types.Array():
            return {"array": str(kind.dtype), "ndim": kind.ndim, "layout": kind.layout, "readonly": not kind.mutable}
        case types.NamedTuple() | types.NamedUniTuple():
            held, made = [*map(_encoded, kind)], kind.instance_class
            return {"tuple": f"{made.__module__}:{made.__name__}", "of": held}
        case types.BaseTuple():
            return {"tuple": None, "of": [*map(_encoded, kind)]}
        case _:
            return str(kind)


def _decoded(kind: dict[str, object] | str) -> types.Type:
    match kind:
        case {"array": str(dtype), "ndim": int(ndim), "layout": str(layout), "readonly": bool(readonly)}:
            return types.Array(from_dtype(np.dtype(dtype)), ndim, layout, readonly=readonly)
        case {"tuple": None, "of": list(held)}:
            return types.BaseTuple.from_types(tuple(map(_decoded, held)))
        case {"tuple": str(name), "of": list(held)}:
            return types.BaseTuple.from_types(tuple(map(_decoded, held)), _named(name))
        case str():
            return from_dtype(np.dtype(kind))
        case _:
            raise ValueError(kind)
