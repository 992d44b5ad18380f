"""The robots by themselves, at a text server of another process: what comes from outside, and the tick."""

from collections.abc import Sequence

from thbridge.app.session.inputs import Asked, Heard, Input, Registered
from thbridge.app.session.session import TickRecord, TickRecorder
from thbridge.roles.keeper.wizard import WizardState
from thbridge.roles.robot_requests import GameRequest, Request
from thbridge.roles.simr.simr import SimR
from thbridge.wire.router import Forwarded
from thbridge.wire.text import TextMessage


class SimrSession:
    """The robots by themselves, at a text server of another process.

    Args:
        simr: the robots' role.
        witnesses: who record.

    Attributes:
        tick: the number of the next tick.
    """

    def __init__(self, simr: SimR, recorders: Sequence[TickRecorder] = ()) -> None:
        self.tick = 0
        self._simr = simr
        self._witnesses = tuple(recorders)
        self._inputs: list[Input] = []

    # What comes from outside

    def ask(self, sender: str, request: Request) -> None:
        """Ask something of the robots, in the name of whoever wants it.

        Raises:
            ValueError: it is asked of the game, which is another program's.
        """
        if isinstance(request, GameRequest):
            raise ValueError("the game is not in this process")
        self._simr.ask(request, sender)
        self._inputs.append(Asked(sender, request))

    def connected(self) -> None:
        """The server has (again) accepted the name."""
        self._inputs.append(Registered())
        self._simr.connected()

    def receive(self, message: TextMessage) -> None:
        """Somebody said something to the robots."""
        self._inputs.append(Heard(message))

    # The tick

    def step(self) -> list[TextMessage]:
        """One tick; what SimR says in it, for the server.

        Raises:
            Exception: whatever a witness raises when it cannot write; the program must end then.
        """
        inputs, self._inputs = tuple(self._inputs), []
        heard = [item.message for item in inputs if isinstance(item, Heard)]
        said = self._simr.step(self.tick, heard)
        passed = tuple(Forwarded(message, True, False) for message in (*heard, *said))
        moment = TickRecord(self.tick, inputs, self._simr.snapshot, passed, (), (), WizardState(), None)
        for witness in self._witnesses:
            witness.record(moment)
        self.tick += 1
        return said
