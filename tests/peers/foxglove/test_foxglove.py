"""Foxglove's own client and message readers look on at a hunt, and read each message of every topic."""

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tests.peers.node import NEEDS_NODE, run_script
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.messages.stamps import TICK_NS

pytestmark = NEEDS_NODE

TICKS = 200
"""Number of ticks that Foxglove looks on."""

LOOKS_ON = """
import foxglove from "@foxglove/ws-protocol";
import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg-serialization";
import WebSocket from "ws";

const [address, ticks] = [process.argv[2], Number(process.argv[3])];
const client = new foxglove.FoxgloveClient({ ws: new WebSocket(address, ["foxglove.sdk.v1"]) });
const channels = new Map(), messages = [], times = [];
let server = null, map = null;
client.on("error", (error) => { console.log(JSON.stringify({ error: String(error) })); process.exit(1); });
client.on("serverInfo", (info) => { server = info.name; });
client.on("advertise", (list) => {
  // One after the other is subscribed to; once the last one's messages come, those of all do.
  list.sort((a, b) => (a.topic === "/tf") - (b.topic === "/tf"));
  for (const channel of list) {
    const reader = new serialization.MessageReader(rosmsg.parse(channel.schema, { ros2: false }));
    channels.set(client.subscribe(channel.id), { channel, reader });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { channel, reader } = channels.get(subscriptionId);
  const message = reader.readMessage(data);
  messages.push([channel.topic, Number(timestamp)]);
  if (channel.topic === "/map") {
    map = [message.info.width, message.info.height, message.data.length];
  }
});
client.on("time", ({ timestamp }) => {
  times.push(Number(timestamp));
  if (times.length === ticks) {
    console.log(JSON.stringify({ server, messages, map, times }));
    process.exit(0);
  }
});
"""


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[dict, Path]]:
    folder = tmp_path_factory.mktemp("foxglove")
    bag, port = folder / "hunt.bag", free_port()
    hunt = Program(
        folder, "play", "--headless", "--rate", "5", "--port", "0", "--foxglove", str(port), "--bag", str(bag)
    )
    try:
        until("Foxglove's server to listen", lambda: f"ws://127.0.0.1:{port}" in hunt.text, [hunt])
        said = run_script(LOOKS_ON, f"ws://127.0.0.1:{port}", str(TICKS))
        hunt.stop()
        yield json.loads(said.splitlines()[-1]), bag
    finally:
        hunt.close()


def test_foxglove_reads_each_message_that_the_bag_holds(seen: tuple[dict, Path]) -> None:
    told, bag = seen
    assert told["server"] == "thbridge"
    first = next(stamp for topic, stamp in told["messages"] if topic == "/tf")
    last = max(stamp for _, stamp in told["messages"])  # the time goes another way, and may come before messages
    wanted = {(publisher.topic, stamp) for publisher, stamp, _ in recorded(bag) if first <= stamp < last}
    assert {topic for topic, _ in wanted} >= {"/tf", "/robot1/scan", "/robot1/particlecloud", "/robot2/odom"}
    assert wanted <= {(topic, stamp) for topic, stamp in told["messages"]}


def test_the_map_comes_though_it_was_published_before_foxglove_did(seen: tuple[dict, Path]) -> None:
    grid = read_map(shipped().find("maps", "arena8", Path())).grid
    assert seen[0]["map"] == [grid.cols, grid.rows, grid.rows * grid.cols]


def test_foxgloves_clock_is_the_sessions(seen: tuple[dict, Path]) -> None:
    steps = {later - earlier for earlier, later in pairwise(seen[0]["times"])}
    assert steps == {TICK_NS}
