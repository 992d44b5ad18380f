"""What vehicles said and heard is found in a bag by other people's means: rosbags reads messages, pymavlink frames."""

import re
from collections import defaultdict
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader

from tests.support.mavlink.recorded_stations import Tour, record

DOCUMENT = Path(__file__).parents[3] / "docs" / "reference" / "bags.md"


def test_frames_are_read_as_the_document_says(tmp_path: Path) -> None:
    (recipe,) = re.findall(r"```python\n(.*?def said_in.*?)```", DOCUMENT.read_text(), re.DOTALL)
    names: dict[str, Any] = {}
    exec(recipe, names)
    record(tmp_path / "hunt.bag", 120, Tour({1: [5], 2: [4]}))
    said = defaultdict(list)
    with AnyReader([tmp_path / "hunt.bag"]) as bag:
        chosen = [connection for connection in bag.connections if connection.msgtype == "mavros_msgs/msg/Mavlink"]
        for connection, _, data in bag.messages(chosen):
            said[connection.topic].append(names["said_in"](bag.deserialize(data, connection.msgtype)))
    for robot in (1, 2):
        heard, told = said[f"/robot{robot}/mavlink/to"], said[f"/robot{robot}/mavlink/from"]
        assert [one.command for one in heard if one.get_type() == "COMMAND_LONG"] == [400]
        assert {one.get_srcSystem() for one in told} == {robot}
        assert {"HEARTBEAT", "LOCAL_POSITION_NED", "COMMAND_ACK"} <= {one.get_type() for one in told}
        counts = [one.get_seq() for one in told]
        assert counts == [number % 256 for number in range(len(told))]
