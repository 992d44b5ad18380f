"""Limits of clients at the gateway."""

import logging

import pytest

from ui.web.gateway.limits import RateLimit, RefusalLog, network_of


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_a_rate_admits_a_burst_and_then_its_rate_for_each_key() -> None:
    clock = Clock()
    limit = RateLimit(3, 0.5, clock)
    assert [limit.admits("a") for _ in range(4)] == [True, True, True, False]
    assert limit.admits("b")
    assert limit.delay("a") == 2.0
    clock.now = 2.0
    assert [limit.admits("a") for _ in range(2)] == [True, False]


def test_a_rate_forgets_keys_instead_of_growing() -> None:
    limit = RateLimit(1, 0.1, Clock())
    for number in range(20_000):
        limit.take(str(number))
    assert len(limit._left) <= 4096
    assert not limit.admits("19999")


def test_a_refused_client_is_logged_once_in_a_period(caplog: pytest.LogCaptureFixture) -> None:
    clock = Clock()
    log = RefusalLog(logging.getLogger("refusals"), clock)
    for now in (0.0, 30.0, 59.0, 60.0, 61.0):
        clock.now = now
        log.warn("10.0.0.7 is refused.")
    assert len(caplog.records) == 2


@pytest.mark.parametrize(
    ("host", "network"),
    [
        ("10.0.0.7", "10.0.0.7"),
        ("::ffff:10.0.0.7", "10.0.0.7"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
    ],
)
def test_all_addresses_of_an_ipv6_client_count_as_one(host: str, network: str) -> None:
    assert network_of(host) == network
