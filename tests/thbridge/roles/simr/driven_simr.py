"""SimR alone, and what it says."""

from thbridge.roles.shared.notices import KEEPER, MoveOrder, Orders
from thbridge.roles.simr.simr import SimR
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, decode_notice, encode_notice, parse_notice


class DrivenSimR:
    """Steps one SimR and keeps what it says."""

    def __init__(self, simr: SimR) -> None:
        self.simr = simr
        self.tick = 0
        self.said: list[TextMessage] = []

    def run(self, ticks: int, *messages: TextMessage) -> list[TextMessage]:
        said = []
        for step in range(ticks):
            said += self.simr.step(self.tick, messages if step == 0 else ())
            self.tick += 1
        self.said += said
        return said

    def until(self, line: str, ticks: int = 3000) -> None:
        for _ in range(ticks):
            if any(message.line() == line for message in self.run(1)):
                return
        raise TimeoutError(line)

    def levels(self, kind: type) -> list:
        notices = [parse_notice(message) for message in self.said]
        return [level for n in notices if isinstance(n, Notice) and (level := decode_notice(n, kind)) is not None]


def orders(game: int, *moves: MoveOrder | None, at=(0, 0), poses=None) -> TextMessage:
    return encode_notice(KEEPER, legacy.SIMR, Orders(game, moves, (90.0, 80.0), at, poses))
