"""Foxglove server, which shows a running session in Foxglove. It sends the same messages that a bag contains.

Foxglove reads ROS 1's messages and definitions, so nothing is converted. Foxglove can only watch: messages from it
have no effect. foxglove-sdk handles sockets and clients on its own threads. A client that reads too slowly loses its
oldest pending messages.

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
"""Seconds that the library has to end its connections. Without this limit, an open connection could block the end of a
session."""

_MOST_WAITING = 4096
"""Maximum number of messages that may wait for one client. This is enough for some seconds of a team's messages."""


class FoxgloveServer(ServerListener):
    """Server that sends a session's messages to all connected Foxglove windows.

    Args:
        topics: topics that are advertised from the start. Other topics are advertised with their first message.
        definitions: definitions of their types.
    """

    def __init__(self, topics: Iterable[Topic], definitions: Definitions) -> None:
        self._definitions = definitions
        self._context = Context()
        self._channels = {topic.name: self._channel(topic) for topic in topics}
        self._latched: dict[int, tuple[Channel, RosMessage]] = {}
        self._server: WebSocketServer | None = None

    def start(self, host: str, port: int) -> ListeningAddress | CannotListen:
        """Listen at this address. Port 0 selects any free port."""
        try:
            self._server = start_server(
                name="thbridge",
                host=host,
                port=port,
                # With this capability, Foxglove shows the time of the session.
                capabilities=[Capability.Time],
                server_listener=self,
                context=self._context,
                # The id is random. Otherwise Foxglove would confuse a later session at this address with this session.
                session_id=secrets.token_hex(8),
                message_backlog_size=_MOST_WAITING,
            )
        except RuntimeError as error:
            # Of the library's message, keep only the system's reason.
            return CannotListen(host, port, str(error).rpartition(": ")[2].partition(" (os error")[0])
        return ListeningAddress(host, self._server.port)

    def stop(self) -> None:
        """Close all connections, with a timeout."""
        if self._server is None:
            return
        # The library waits without limit for connections in an unfinished handshake. So a daemon thread stops it.
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

        All other subscribers of the topic also receive this message again, which has no effect.
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
