"""Refusal of HTTP where it is not spoken: a page in a browser of this machine can send any body to any port of it."""

import re

_REQUEST = re.compile(rb"(GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI) \S*")


def begins_http(first: bytes) -> bool:
    """True for the first bytes of a connection that can only be those of a request of HTTP."""
    return _REQUEST.match(first) is not None
