"""What is in the files about a vehicle: as MAVLink's schemas have it, and as QGroundControl reads it."""

import json
import re

import pytest

from tests.support.mavlink.vehicle_with_stations import OPTIONS, VehicleWithStations, messages
from thbridge.mavlink.values.vehicle_interface import ParameterDescription
from thbridge.mavlink.vehicle.component_files.metadata_files import GENERAL, PARAMETERS, MetadataFiles, checksum
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import mav

NUMBER = (int, float)
OF_PARAMETERS = {
    "name": str, "type": str, "shortDesc": str, "longDesc": str, "units": str, "default": NUMBER,
    "decimalPlaces": int, "min": NUMBER, "max": NUMBER, "increment": NUMBER, "rebootRequired": bool, "group": str,
    "category": str, "volatile": bool, "values": list, "bitmask": list, "readOnly": bool,
}  # fmt: skip
"""The schema's keys, none of which is of another type, and beside which there are none."""

OF_METADATA = {"type": int, "uri": str, "fileCrc": int}


class Described:
    def __init__(self, *descriptions):
        self._descriptions = descriptions

    def descriptions(self):
        return self._descriptions


def files_of(*descriptions):
    return MetadataFiles(Described(*descriptions)).contents


def parameter(**about):
    content = json.loads(
        files_of(ParameterDescription("N", "a number", "of tests", "robot", "tests", **about))[PARAMETERS]
    )
    check_parameters(content)
    return content["parameters"][0]


def check_parameters(content):
    """As the schema and QGroundControl want the file of parameters."""
    assert set(content) == {"version", "parameters"}
    assert content["version"] == 1
    names = [told["name"] for told in content["parameters"]]
    assert len(set(names)) == len(names)
    for told in content["parameters"]:
        assert re.fullmatch(r"[A-Z0-9_]{1,16}", told["name"])
        assert told["type"] == "Float"
        for key, value in told.items():
            assert isinstance(value, OF_PARAMETERS[key]), (told["name"], key)
        for each in told.get("values", []):
            assert set(each) == {"value", "description"}
            assert isinstance(each["value"], NUMBER) and isinstance(each["description"], str)


def check_general(content):
    assert content["version"] == 1
    assert set(content) <= {"version", "vendorName", "modelName", "metadataTypes"}
    for about in content["metadataTypes"]:
        assert set(about) == set(OF_METADATA)
        assert all(isinstance(about[key], kind) for key, kind in OF_METADATA.items())


def test_the_one_tells_of_the_other():
    files = files_of(ParameterDescription("N", "a number", "", "robot", "tests"))
    general = json.loads(files[GENERAL])
    check_general(general)
    assert general["metadataTypes"] == [
        {"type": 1, "uri": f"mftp://{PARAMETERS}", "fileCrc": checksum(files[PARAMETERS])}
    ]


def test_a_number_has_its_bounds_unit_and_default():
    told = parameter(unit="m/s", default=0.5, minimum=0.0, maximum=1.5)
    assert {"units": "m/s", "default": 0.5, "min": 0, "max": 1.5, "shortDesc": "a number"}.items() <= told.items()
    assert {"longDesc": "of tests", "category": "robot", "group": "tests"}.items() <= told.items()
    assert not {"values", "readOnly", "decimalPlaces", "increment"} & set(told)


def test_what_there_is_not_is_left_out():
    assert set(parameter()) == {"name", "type", "shortDesc", "longDesc", "category", "group"}
    assert "max" not in parameter(maximum=float("inf"))


def test_words_stand_for_whole_numbers():
    told = parameter(whole=True, words=("off", "on"), default=1.0)
    assert told["values"] == [{"value": 0, "description": "off"}, {"value": 1, "description": "on"}]
    assert (told["decimalPlaces"], told["increment"], told["default"]) == (0, 1, 1)


def test_what_is_fixed_is_read_only():
    assert parameter(fixed=True)["readOnly"] is True


def asks(rig, sequence, opcode, size, data=b""):
    """Send a request of the file transfer to session 0; what is answered at once."""
    payload = [sequence, 0, 0, opcode, size, *[0] * 7, *data]
    target = rig.vehicle.system
    padded = payload + [0] * (251 - len(payload))
    return messages(rig.hear(mav.MAVLink_file_transfer_protocol_message(0, target, 1, padded)))


def download(rig, name):
    """A file of a vehicle, as it comes over a link."""
    (opened,) = asks(rig, 1, 4, len(name), name.encode())
    size = int.from_bytes(bytes(opened.payload[12:16]), "little")
    asks(rig, 3, 15, 239)
    pieces = messages(rig.run(size // 239 + 1), "FILE_TRANSFER_PROTOCOL")
    content = b"".join(bytes(piece.payload[12 : 12 + piece.payload[4]]) for piece in pieces)
    assert len(content) == size
    asks(rig, 5, 1, 0)
    return content


@pytest.mark.parametrize("message", [395, 397])
def test_stations_are_told_where_the_first_file_is(message):
    rig = VehicleWithStations()
    said = rig.hear(mav.MAVLink_command_long_message(3, 1, mav.MAV_CMD_REQUEST_MESSAGE, 0, message, 0, 0, 0, 0, 0, 0))
    told = messages(said)[-1].to_dict()
    prefix = "general_metadata_" if message == 395 else ""
    assert told[f"{prefix}uri"] == f"mftp://{GENERAL}"
    content = download(rig, GENERAL)
    check_general(json.loads(content))
    assert told[f"{prefix}file_crc"] == checksum(content)


def test_all_parameters_are_described_and_the_vehicle_s_own_come_first():
    rig = VehicleWithStations(lost_after=7.0)
    content = json.loads(download(rig, PARAMETERS))
    check_parameters(content)
    own, robot = content["parameters"][:3], content["parameters"][3:]
    assert [told["name"] for told in own] == ["SYSID_THISMAV", "FS_GCS_TIMEOUT", "FS_ACTION"]
    assert own[0]["readOnly"]
    assert "default" not in own[0]
    assert (own[1]["default"], own[1]["min"], own[1]["max"], own[1]["units"]) == (7, 1, 600, "s")
    assert [each["description"] for each in own[2]["values"]] == ["continue", "home", "stop"]
    assert [told["name"] for told in robot] == [*rig.robot.values]


def test_files_stay_as_they_were_and_are_the_same_for_each_robot_of_a_team():
    rig, other = VehicleWithStations(), VehicleWithStations()
    rig.hear(mav.MAVLink_param_set_message(3, 1, b"FS_GCS_TIMEOUT", 30.0, mav.MAV_PARAM_TYPE_REAL32))
    other.vehicle = Vehicle(4, other.robot, OPTIONS)
    other.run(1)
    assert download(rig, PARAMETERS) == download(other, PARAMETERS)
