"""Client of ROS services, like a node in another program."""

import asyncio
from urllib.parse import urlsplit

from thbridge.rosgraph.sockets.http_client import XmlRpcClient
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.tcpros import decode_header, encode_header, frame
from thbridge.rosgraph.wire.xmlrpc import MethodResponse


async def call_service(master: str, service: str, md5: str, request: bytes) -> bytes | ServiceFailed:
    """Ask the master at this URI for a service's address, and call the service."""
    client = XmlRpcClient()
    found = await client.call(master, "lookupService", "/caller", service)
    await client.close()
    if not isinstance(found, MethodResponse) or found.value[0] != 1:
        return ServiceFailed(f"nobody serves {service}")
    parts = urlsplit(found.value[2])
    reader, writer = await asyncio.open_connection(parts.hostname, parts.port)
    try:
        writer.write(encode_header({"callerid": "/caller", "md5sum": md5, "service": service}))
        header = decode_header(await _frame(reader))
        assert isinstance(header, dict)
        if "error" in header:
            return ServiceFailed(header["error"])
        writer.write(frame(request))
        (done,) = await reader.readexactly(1)
        answer = await _frame(reader)
        return answer if done else ServiceFailed(answer.decode())
    except asyncio.IncompleteReadError:
        return ServiceFailed("the connection was closed before the answer")
    finally:
        writer.close()


async def _frame(reader: asyncio.StreamReader) -> bytes:
    return await reader.readexactly(int.from_bytes(await reader.readexactly(4), "little"))
