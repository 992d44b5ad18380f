"""Metadata files for ground stations: the list of files about a vehicle, and descriptions of its parameters.

Source: the MAVLink developer guide, "Component Metadata Protocol"; the schemas in `component_metadata` of MAVLink's
repository.
Differences from the source: files are not compressed. Compressed bytes depend on the library, but a replay must send
the same bytes on any machine. The parameter file has version 1, although a newer version exists, because QGroundControl
reads only version 1.
"""

import json
import zlib
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from math import isfinite
from types import MappingProxyType

from thbridge.mavlink.values.vehicle_interface import ParameterDescription, ParameterSettings

GENERAL = "general.json"
PARAMETERS = "parameters.json"

_VERSION = 1
_TYPE_PARAMETER = 1
"""Code of COMP_METADATA_TYPE."""

_KEPT = 16
"""Number of parameter sets whose files are cached. Most robots of a study have the same set."""


class MetadataFiles:
    """Metadata files of one vehicle. They never change, as the protocol requires.

    Args:
        settings: its parameters.
    """

    def __init__(self, settings: ParameterSettings) -> None:
        self._settings = settings

    @cached_property
    def contents(self) -> Mapping[str, bytes]:
        """Contents by file name."""
        return _contents(tuple(self._settings.descriptions()))


def uri(name: str) -> str:
    """Return the URI of a file of this component."""
    return f"mftp://{name}"


def checksum(content: bytes) -> int:
    """Return a file's checksum as MAVLink FTP defines it: CRC-32 with start value 0 and without final inversion."""
    # zlib inverts the start value and the result. These two inversions undo both.
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


@lru_cache(_KEPT)
def _contents(descriptions: tuple[ParameterDescription, ...]) -> Mapping[str, bytes]:
    parameters = _as_json({"version": _VERSION, "parameters": [_parameter(each) for each in descriptions]})
    about = {"type": _TYPE_PARAMETER, "uri": uri(PARAMETERS), "fileCrc": checksum(parameters)}
    general = {"version": _VERSION, "vendorName": "thbridge", "modelName": "rover", "metadataTypes": [about]}
    return MappingProxyType({GENERAL: _as_json(general), PARAMETERS: parameters})


def _parameter(described: ParameterDescription) -> dict[str, object]:
    """Return a parameter's entry by the schema. Values that are equal to the schema's defaults are omitted."""
    entry: dict[str, object] = {
        "name": described.name,
        "type": "Float",
        "shortDesc": described.meaning,
        "longDesc": described.details,
        "category": described.section,
        "group": described.group,
    }
    if described.unit:
        entry["units"] = described.unit
    for key, number in (("default", described.default), ("min", described.minimum), ("max", described.maximum)):
        if number is not None and isfinite(number):
            entry[key] = int(number) if number == int(number) else number
    if described.whole:
        entry |= {"decimalPlaces": 0, "increment": 1}
    if described.words:
        entry["values"] = [{"value": place, "description": word} for place, word in enumerate(described.words)]
    if described.fixed:
        entry["readOnly"] = True
    return entry


def _as_json(content: Mapping[str, object] | Sequence[object]) -> bytes:
    return json.dumps(content, separators=(",", ":"), allow_nan=False).encode("ascii")
