"""Checks of Python and packages: the version, the required packages, and the packages of each extra."""

import platform
import sys
from collections.abc import Iterator, Sequence
from importlib import metadata

from packaging.requirements import Requirement

from ui.commands.doctor.result import HealthCheck, fault, ok, warning


def check_packages() -> Iterator[HealthCheck]:
    """Check the version of Python, the required packages, and the packages of the extras."""
    known = metadata.metadata("thbridge")
    wanted = known["Requires-Python"]
    version = platform.python_version()
    if Requirement(f"python{wanted}").specifier.contains(version, prereleases=True):
        yield ok("python", f"{version} ({sys.executable})")
    else:
        remedy = "Install Python 3.11 with `uv python install 3.11`, or on Ubuntu from ppa:deadsnakes/ppa"
        yield fault("python", f"version {version} does not meet {wanted}", remedy)
    requirements = [Requirement(line) for line in metadata.requires("thbridge") or ()]
    lacks = list(lacking(requirements, ""))
    if lacks:
        yield fault("packages", "; ".join(lacks), "Install thbridge again with its dependencies")
    else:
        yield ok("packages", f"thbridge {known['Version']} has all required packages")
    for extra in known.get_all("Provides-Extra") or ():
        lacks = list(lacking(requirements, extra))
        if lacks:
            yield warning(f"extra {extra}", "; ".join(lacks), f"If you need it, run: pip install 'thbridge[{extra}]'")
        else:
            yield ok(f"extra {extra}", "installed")


def lacking(requirements: Sequence[Requirement], extra: str) -> Iterator[str]:
    """Yield sentences about missing packages of an extra and about wrong versions.

    If the extra's name is empty, check the required packages.
    """
    for each in requirements:
        if each.marker is None:
            is_asked = not extra
        else:
            is_asked = each.marker.evaluate({"extra": extra}) and (not extra or not each.marker.evaluate({"extra": ""}))
        if not is_asked:
            continue
        try:
            version = metadata.version(each.name)
        except metadata.PackageNotFoundError:
            yield f"{each.name} is not installed"
            continue
        if not each.specifier.contains(version, prereleases=True):
            yield f"{each.name} has version {version}, but {each.specifier} is required"
