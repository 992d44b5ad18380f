"""Versions and machine of this process. They can change results, like the study, the seed and the inputs."""

import os
import platform
import re
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from llvmlite import binding as llvm
from numpy._core._multiarray_umath import __cpu_features__  # type: ignore[import-not-found]  # not in its stubs

from thbridge.files.plugins import package_of

RECORDED_PACKAGES = (
    "thbridge",
    "numpy",
    "scipy",
    "numba",
    "llvmlite",
    "msgspec",
    "rosbags",
    "pyyaml",
    "pymavlink",
    "pyvrp",
    "clingo",
)
"""Packages whose versions a bag records, because other versions may lead to other results of the same study."""


def versions(plugins: Iterable[str] = ()) -> dict[str, str]:
    """Return the versions of this program and of the installed packages that can change results.

    Args:
        plugins: keys of plug-ins, from `plugins_of` or from recorded versions; other keys are ignored. For each
            installed plug-in, the result contains the name and version of the plug-in's package.
    """
    found = {"python": platform.python_version()}
    for package in RECORDED_PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue  # Clingo is optional.
    return found | {key: version for key in plugins if (version := package_of(key)) is not None}


def machine() -> dict[str, str]:
    """Return the properties of this machine, by their names in `MACHINE`.

    The features of the processor are the features that numpy and the compiler of our kernels can use. Environment
    variables can turn features off.
    """
    features = {name: bool(has) for name, has in __cpu_features__.items()}
    compiled = llvm.get_host_cpu_features()
    return {
        "architecture": platform.machine(),
        "libc": " ".join(platform.libc_ver()),
        "processor": _processor(),
        "processor features": " ".join(sorted(name for name, has in features.items() if has)),
        "compiler target": os.environ.get("NUMBA_CPU_NAME", llvm.get_host_cpu_name()),
        "compiler features": " ".join(sorted(name for name, has in compiled.items() if has)),
    }


def _processor() -> str:
    """Return the model of the processor as reported by Linux; on other systems, as reported by Python."""
    try:
        cpuinfo = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        cpuinfo = ""
    named = re.search(r"^(?:model name|Model|cpu model)\s*:\s*(.+)$", cpuinfo, re.MULTILINE)
    return named[1] if named else platform.processor() or "unknown"
