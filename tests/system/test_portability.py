"""Sessions say the same, byte for byte, whatever the processor, the libraries' code for it, and the interpreter are.

What another machine would have is taken from this one by the environment: numpy, libm, BLAS and numba then choose other
code. Other interpreters take part in the slow test where they are named, as in
`THBRIDGE_PYTHONS=/path/to/python3.13:...`, each with the packages of the program itself;
`scripts/make_aarch64_python.sh` makes one of another architecture.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path

import pytest
from numpy._core._multiarray_umath import __cpu_features__

from tests.support.programs.processes import THBRIDGE
from tests.support.programs.processor_features import DISPATCHED, LIBM_WITHOUT_FMA, NUMPY_PLAIN
from tests.support.project import ROOT
from tests.system.portable_studies import STUDIES, bag_of
from thbridge.recording.bag.reading.reader import RawMessage, messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.digest import digest_of
from thbridge.ros import names
from thbridge.ros.messages.differences import differences
from thbridge.ros.messages.stamps import START_NS
from thbridge.ros.topics import RosMessage, Topic

SHORT = ("two robots", "kalman filter, dwa")

NUMPY_WITHOUT_AVX512 = {
    "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in DISPATCHED if name.startswith(("AVX512", "X86_V4")))
}
BLAS_OF_OLD = {"OPENBLAS_CORETYPE": "Nehalem"}
ELSEWHERE = {"PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo", "LC_ALL": "de_DE.UTF-8", "OPENBLAS_CORETYPE": "Haswell"}

QUICK = {
    "libm and numpy without fma, blas of old": {**LIBM_WITHOUT_FMA, **NUMPY_PLAIN, **BLAS_OF_OLD},
    "elsewhere": ELSEWHERE,
}
SETTINGS = {
    "again": {},
    "numpy without avx512": NUMPY_WITHOUT_AVX512,
    "numpy without avx2 and fma": NUMPY_PLAIN,
    "libm without fma and avx2": LIBM_WITHOUT_FMA,
    "blas of haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "blas of nehalem": BLAS_OF_OLD,
    "kernels without svml": {"NUMBA_DISABLE_INTEL_SVML": "1"},
    "kernels for any processor": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "elsewhere": ELSEWHERE,
}
PYTHONS = [path for path in os.environ.get("THBRIDGE_PYTHONS", "").split(os.pathsep) if path]

PROBE = """\
import math, numpy
x = numpy.arange(1, 100_000) * 0.000137
a = numpy.sin(1000.0 * x[:10_000]).reshape(100, 100)
libm = [f(v) for f in (math.sin, math.cos, math.exp) for v in x.tolist()]
print(*map(hash, (tuple(libm), numpy.log(x).tobytes(), (a @ a).tobytes())))
"""


def played(
    folder: Path, studies: Sequence[str], setting: Mapping[str, str] = {}, python: str = sys.executable
) -> dict[str, str]:
    """Play studies in a process of their own and return the digests of their messages."""
    done = subprocess.run(
        [python, "-m", "tests.system.portable_studies", str(folder), *studies],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT), **setting}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = [json.loads(line) for line in done.stdout.splitlines()]
    return {each["name"]: each["digest"] for each in told}


def first_difference(here: Path, there: Path) -> str:
    """Sentence on the first message in which two recordings differ, with the fields."""
    said = [(message for message in messages(bag) if message.topic != names.SESSION) for bag in (here, there)]
    for one, other in zip_longest(*said):
        if one != other:
            return _difference(one, other)
    return "nothing differs"


def _difference(one: RawMessage | None, other: RawMessage | None) -> str:
    if one is None or other is None or (one.topic, one.stamp_ns) != (other.topic, other.stamp_ns):
        return f"{one and (one.topic, one.stamp_ns)} here, {other and (other.topic, other.stamp_ns)} there"
    fields = "; ".join(
        f"{each.field} {each.was} here, {each.now} there" for each in differences(one.msgtype, one.data, other.data)[:3]
    )
    return f"{one.topic} at {(one.stamp_ns - START_NS) / 1e9} s: {fields}"


def assert_same(here: dict[str, str], there: dict[str, str], folders: tuple[Path, Path]) -> None:
    """Assert that digests are the same; else tell where each recording parts from the other."""
    assert here.keys() == there.keys()
    parted = {
        name: first_difference(*(bag_of(folder, name) for folder in folders))
        for name in here
        if here[name] != there[name]
    }
    assert parted == {}


def probed(setting: Mapping[str, str]) -> list[str]:
    """Return hashes of what libm, numpy and BLAS compute under a setting."""
    # The hash of bytes is to be the same in all processes.
    environment = {**os.environ, "PYTHONHASHSEED": "0", **setting}
    return subprocess.check_output([sys.executable, "-c", PROBE], env=environment, text=True).split()


@pytest.mark.skipif(not __cpu_features__.get("AVX512F"), reason="nothing can be taken from this processor")
def test_settings_have_the_machine_compute_otherwise() -> None:
    libm, logarithms, product = probed({})
    assert probed(LIBM_WITHOUT_FMA)[0] != libm
    assert probed(NUMPY_WITHOUT_AVX512)[1] != logarithms
    assert probed(BLAS_OF_OLD)[2] != product


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, str]]:
    """Folder and digests of short studies, as this machine plays them."""
    folder = tmp_path_factory.mktemp("here") / "short"
    return folder, played(folder, SHORT)


@pytest.mark.slow
@pytest.mark.parametrize("setting", QUICK)
def test_short_sessions_are_the_same(setting: str, short: tuple[Path, dict[str, str]], tmp_path: Path) -> None:
    folder, here = short
    assert_same(here, played(tmp_path / "there", SHORT, QUICK[setting]), (folder, tmp_path / "there"))


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, str]]:
    """Folder and digests of all studies, as this machine plays them."""
    folder = tmp_path_factory.mktemp("here") / "all"
    return folder, played(folder, list(STUDIES))


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("setting", SETTINGS)
def test_all_sessions_are_the_same(setting: str, every: tuple[Path, dict[str, str]], tmp_path: Path) -> None:
    folder, here = every
    assert_same(here, played(tmp_path / "there", list(STUDIES), SETTINGS[setting]), (folder, tmp_path / "there"))


@pytest.mark.slow
@pytest.mark.timeout(4 * 3600)
@pytest.mark.parametrize("python", PYTHONS)
def test_all_sessions_are_the_same_with_another_interpreter(
    python: str, every: tuple[Path, dict[str, str]], tmp_path: Path
) -> None:
    folder, here = every
    assert_same(here, played(tmp_path / "there", list(STUDIES), python=python), (folder, tmp_path / "there"))


def exported(bag: Path, folder: Path, setting: Mapping[str, str] = {}) -> dict[str, bytes]:
    """Tables of a recording, exported by a process of its own."""
    command = [*THBRIDGE, "bag", "export", str(bag), "--to", str(folder), "--format", "csv"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **setting}
    subprocess.run(command, env=environment, capture_output=True, check=True)
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.csv"))}


@pytest.mark.slow
def test_tables_of_a_recording_are_the_same(short: tuple[Path, dict[str, str]], tmp_path: Path) -> None:
    bag = bag_of(short[0], SHORT[0])
    here = exported(bag, tmp_path / "here")
    assert "poses.csv" in here
    there = exported(bag, tmp_path / "there", {**LIBM_WITHOUT_FMA, **NUMPY_PLAIN, **BLAS_OF_OLD, "PYTHONHASHSEED": "7"})
    assert {name for name in here if here[name] != there[name]} == set()


def test_the_first_difference_of_two_recordings_is_named(short: tuple[Path, dict[str, str]], tmp_path: Path) -> None:
    folder, here = short
    name = SHORT[0]
    with BagWriter(bag_of(tmp_path, name)) as writer:
        for message in messages(bag_of(folder, name)):
            is_late = message.topic == "/robot1/odom" and message.stamp_ns == START_NS + 5_000_000_000
            data = message.data[:-8] + bytes(8) if is_late else message.data
            writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, data))
    assert digest_of(bag_of(folder, name)) == here[name] != digest_of(bag_of(tmp_path, name))
    told = first_difference(bag_of(folder, name), bag_of(tmp_path, name))
    assert told == "/robot1/odom at 5.0 s: twist.covariance[35] 0.001 here, 0.0 there"
