"""Foxglove server: shows a session in Foxglove while it is under way, every message as a bag has it.

Foxglove reads ROS 1's messages and definitions as they are, so nothing is converted. It can only look: nothing that it
sends has an effect. Sockets and clients are foxglove-sdk's, on threads of its own. A client that reads too slowly loses
the oldest of what waits for it.

Source: the Foxglove WebSocket protocol, `ros1` messages with `ros1msg` schemas.
"""

import logging
import secrets
import threading
from collections.abc import Iterable

from foxglove import Capability, Channel, Context, Schema, start_server
from foxglove.websocket import ChannelView, Client, ServerListener, WebSocketServer

from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.topics import RosMessage, Topic
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen

_log = logging.getLogger(__name__)

_STOP_SECONDS = 3.0
"""Seconds that the library has to end its connections: a session must end, whoever holds one."""

_MOST_WAITING = 4096
"""Messages that may wait for one client: some seconds of a team."""


class FoxgloveServer(ServerListener):
    """Sends a session's messages to all who look on with Foxglove.

    Args:
        topics: advertised from the start; others are advertised with their first message.
        definitions: of their types.
    """

    def __init__(self, topics: Iterable[Topic], definitions: Definitions) -> None:
        self._definitions = definitions
        self._context = Context()
        self._channels = {topic.name: self._channel(topic) for topic in topics}
        self._latched: dict[int, tuple[Channel, RosMessage]] = {}
        self._server: WebSocketServer | None = None

    def start(self, host: str, port: int) -> ListeningAddress | CannotListen:
        """Listen at this address; port 0 takes any that is free."""
        try:
            self._server = start_server(
                name="thbridge",
                host=host,
                port=port,
                # The time that Foxglove shows is the session's.
                capabilities=[Capability.Time],
                server_listener=self,
                context=self._context,
                # Another session at the same address must not be taken for this one come back.
                session_id=secrets.token_hex(8),
                message_backlog_size=_MOST_WAITING,
            )
        except RuntimeError as error:
            return CannotListen(host, port, str(error).rpartition(": ")[2].partition(" (os error")[0])
        return ListeningAddress(host, self._server.port)

    def stop(self) -> None:
        """Close all connections, as far as the library does: those that are left in a handshake hold it for ever."""
        if self._server is None:
            return
        stopping = threading.Thread(target=self._server.stop, name="foxglove", daemon=True)
        stopping.start()
        stopping.join(_STOP_SECONDS)
        if stopping.is_alive():
            _log.warning("Foxglove's connections did not close in time; they end with the program")

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Send the messages of one tick."""
        for message in messages:
            channel = self._channels.get(message.topic.name)
            if channel is None:
                channel = self._channels[message.topic.name] = self._channel(message.topic)
            if message.topic.latched:
                self._latched[channel.id()] = channel, message
            channel.log(message.data, log_time=message.stamp_ns)
        if self._server is not None:
            self._server.broadcast_time(stamp_ns(tick))

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Send the last message of a latched topic to a new subscriber, on a thread of foxglove-sdk.

        All its subscribers get it once more, which does no harm: it is what they have already.
        """
        latched = self._latched.get(channel.id)
        if latched is not None:
            sender, message = latched
            sender.log(message.data, log_time=message.stamp_ns)

    def _channel(self, topic: Topic) -> Channel:
        definition = self._definitions.of(topic.msgtype)
        schema = Schema(name=topic.msgtype, encoding="ros1msg", data=definition.text.encode())
        metadata = {"latching": "true"} if topic.latched else {}
        return Channel(topic.name, schema=schema, message_encoding="ros1", metadata=metadata, context=self._context)
