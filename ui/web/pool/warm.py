"""Warm process from which workers are forked: importing this module loads all code, and compiles what is missing.

Forked processes share its memory: modules, compiled kernels, maps.
"""

from sim.numerics.signatures import compile_call, recorded_calls
from thbridge.app import play  # noqa: F401 - workers use it
from ui.web import seat  # noqa: F401

for call in recorded_calls():
    compile_call(call)
