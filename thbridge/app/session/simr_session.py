"""The session of the robots alone, at a text server of another process."""

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
        recorders: record every tick.

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
        """Pass on a request to the robots, in the name of its sender.

        Raises:
            ValueError: it is a request to the game, which another program runs.
        """
        if isinstance(request, GameRequest):
            raise ValueError("the game is not in this process")
        self._simr.ask(request, sender)
        self._inputs.append(ClientRequest(sender, request))

    def connected(self) -> None:
        """Note that the server has (again) accepted the name."""
        self._inputs.append(NameAccepted())
        self._simr.connected()

    def receive(self, message: TextMessage) -> None:
        """Accept a message to SimR."""
        self._inputs.append(MessageForwarded(message))

    # The tick

    def step(self) -> list[TextMessage]:
        """Run one tick; return SimR's messages for the server.

        Raises:
            Exception: raised by a recorder that cannot write; the program must end then.
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
