"""Detection of HTTP at other ports: a web page in a browser of this machine can send any text to any local port."""

import re

_REQUEST = re.compile(rb"(GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI) \S*")


def begins_http(first: bytes) -> bool:
    """Return True if the first bytes of a connection can only come from an HTTP request."""
    return _REQUEST.match(first) is not None
