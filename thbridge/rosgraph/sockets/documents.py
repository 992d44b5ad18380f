"""Decoding and encoding of XML-RPC documents without blocking the event loop, which also runs the game.

Short documents need at most some milliseconds, and are processed at once. Long documents are processed on a thread,
one after the other.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue, written_size

SHORT = 16 * 1024
"""Maximum number of bytes of a document that is processed at once."""

_Result = TypeVar("_Result")

_thread = ThreadPoolExecutor(1, thread_name_prefix="xmlrpc")


async def read_document(decode: Callable[[bytes], _Result], document: bytes) -> _Result:
    """Decode a document."""
    if len(document) <= SHORT:
        return decode(document)
    return await asyncio.get_running_loop().run_in_executor(_thread, decode, document)


async def write_document(encode: Callable[[], bytes], value: XmlRpcValue) -> bytes:
    """Encode a document with this value in it.

    Raises:
        ValueError: XML-RPC cannot represent the value.
    """
    if written_size(value, SHORT) <= SHORT:
        return encode()
    return await asyncio.get_running_loop().run_in_executor(_thread, encode)
