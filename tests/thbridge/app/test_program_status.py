"""Lines on how a program stands with its server."""

import logging

from thbridge.app.programs import ProgramStatus
from thbridge.roles.shared.notices import KEEPER, HideRequest
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice


def test_each_change_is_told_once(caplog):
    status = ProgramStatus(TextClient("Hider", "t", "127.0.0.1", 6009))
    with caplog.at_level(logging.WARNING):
        status.connected()
        status.heard(TextMessage.of(TextCommand.ERROR, legacy.TABUI, "Hider", '"3"'))
        for game in (1, 1, 2):
            status.heard(encode_notice(KEEPER, "Hider", HideRequest(game, 8)))
        status.connected()
        status.heard(encode_notice(KEEPER, "Hider", HideRequest(2, 8)))
    assert [record.getMessage() for record in caplog.records] == [
        "Hider is connected to 127.0.0.1:6009; waiting for the game",
        "Hider is in game 1",
        "Hider is in game 2",
        "Hider is connected again to 127.0.0.1:6009",
    ]
