import logging

from thbridge.sockets.warn_once import WarnOnce


def test_different_warnings_come_to_an_end(caplog):
    warnings = WarnOnce(logging.getLogger("test"))
    with caplog.at_level(logging.WARNING):
        for number in range(10_000):
            warnings.warn(f"stranger {number}")
            warnings.warn("stranger 0")
    assert 0 < len(caplog.records) < 1000
