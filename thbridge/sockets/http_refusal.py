"""Detection of HTTP at ports of other protocols. A web page in a local browser can send any text to any local port."""

import re

_REQUEST = re.compile(rb"(GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI) \S*")


def begins_http(first: bytes) -> bool:
    """Return True if the first bytes of a connection can only come from an HTTP request."""
    return _REQUEST.match(first) is not None
