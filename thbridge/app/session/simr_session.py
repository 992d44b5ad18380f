"""Session of the robots alone, at a text server of another process."""

from collections.abc import Sequence

from thbridge.app.session.inputs import ClientRequest, Input, MessageForwarded, NameAccepted
from thbridge.app.session.session import TickRecord, TickRecorder
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.shared.robot_requests import GameRequest, Request
from thbridge.roles.simr.simr import SimR
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import Forwarded


class SimrSession:
    """Session of SimR at a text server of another process.

    Args:
        simr: the robots' role.
        recorders: recorders that record every tick.

    Attributes:
        tick: number of the next tick.
    """

    def __init__(self, simr: SimR, recorders: Sequence[TickRecorder] = ()) -> None:
        self.tick = 0
        self._simr = simr
        self._recorders = tuple(recorders)
        self._inputs: list[Input] = []

    # Inputs from outside

    def ask(self, sender: str, request: Request) -> None:
        """Pass a request to the robots, in the name of the sender.

        Raises:
            ValueError: the request is to the game, which runs in another program.
        """
        if isinstance(request, GameRequest):
            raise ValueError("the game runs in another program")
        self._simr.ask(request, sender)
        self._inputs.append(ClientRequest(sender, request))

    def connected(self) -> None:
        """Record that the server has accepted the name, for the first time or again."""
        self._inputs.append(NameAccepted())
        self._simr.connected()

    def receive(self, message: TextMessage) -> None:
        """Pass a message to SimR."""
        self._inputs.append(MessageForwarded(message))

    # The tick

    def step(self) -> list[TextMessage]:
        """Run one tick, and return SimR's messages for the server.

        Raises:
            Exception: a recorder cannot write; the program must then end.
        """
        inputs, self._inputs = tuple(self._inputs), []
        received = [item.message for item in inputs if isinstance(item, MessageForwarded)]
        sent = self._simr.step(self.tick, received)
        forwarded = tuple(Forwarded(message, True, False) for message in (*received, *sent))
        record = TickRecord(self.tick, inputs, self._simr.snapshot, forwarded, (), (), WizardState(), None)
        for recorder in self._recorders:
            recorder.record(record)
        self.tick += 1
        return sent
