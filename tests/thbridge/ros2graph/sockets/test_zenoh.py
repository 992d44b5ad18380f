"""The zenoh carrier over a real router: topics, latched topics, services, the graph, floods, and a lost router."""

import asyncio
import json
import logging
import os
import socket
import threading
from contextlib import suppress
from pathlib import Path

import pytest
import zenoh
from zenoh.handlers import Callback

from tests.support.programs.ports import free_port
from tests.support.ros.zenoh_graphs import ADD, DOMAIN, NODE, OTHER, STRING, carriers, router, run, until
from thbridge.ros2.qos import DEFAULT, LATCHED, SENSOR_DATA, Durability, QosProfile
from thbridge.ros2graph.sockets import zenoh_endpoints
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.sockets.zenoh_settings import peer_settings
from thbridge.ros2graph.values.graph import EndpointRole
from thbridge.ros2graph.wire.zenoh.attachments import Attachment
from thbridge.ros2graph.wire.zenoh.graph import UNANNOUNCED
from thbridge.ros2graph.wire.zenoh.keys import SessionKeys, data_key
from thbridge.sockets.addresses import Address
from thbridge.sockets.errors import CannotReach
from thbridge.sockets.warn_once import WarnOnce

TOPIC = "/robot1/chatter"
KEY = data_key(DOMAIN, TOPIC, STRING.dds_name, STRING.hash)


def stranger(at: Address) -> zenoh.Session:
    """Return a session of a program that does not keep the rules of rmw_zenoh."""
    return zenoh.open(peer_settings("abc", at))


def break_connection(one: zenoh.Session, other: zenoh.Session) -> None:
    """Break the connection of two sessions of this process."""
    for link in one.info.links():
        ends = {link.src, link.dst} if str(link.zid) == str(other.zid()) else set()
        for each in Path("/dev/fd").iterdir():
            with suppress(OSError), socket.socket(fileno=os.dup(int(each.name))) as found:
                names = found.getsockname(), found.getpeername()
                if {f"tcp/127.0.0.1:{name[1]}" for name in names if isinstance(name, tuple)} == ends:
                    found.shutdown(socket.SHUT_RDWR)


def test_messages_arrive_in_order_with_their_publisher():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            got, own = [], []
            writer = here.publish(NODE, TOPIC, STRING, DEFAULT)
            here.subscribe(NODE, TOPIC, STRING, DEFAULT, lambda message, gid: own.append(message))
            there.subscribe(OTHER, TOPIC, STRING, DEFAULT, lambda message, gid: got.append((message, gid)))
            assert writer.readers == 0
            await until(lambda: writer.readers and there.endpoints())
            for number in range(5):
                writer.write(bytes([number]))
            await until(lambda: len(got) == 5)
            assert [message for message, _ in got] == [bytes([number]) for number in range(5)]
            assert {there.node_of(gid) for _, gid in got} == {"/robot1/amcl"}
            assert there.node_of(bytes(16)) == UNANNOUNCED
            assert (own, writer.readers) == ([], 1)

    run(scenario)


def test_late_subscribers_get_the_last_latched_messages_of_others_only():
    async def scenario():
        async with router() as at:
            here = ZenohCarrier(DOMAIN, at)
            writer = here.publish(NODE, "/map", STRING, LATCHED)
            writer.write(b"old")
            writer.write(b"map")  # before the start, like a node that publishes its map at once
            assert await here.start() is None
            got, own = [], []
            here.subscribe(NODE, "/map", STRING, LATCHED, lambda message, gid: own.append(message))
            async with carriers(1, at) as (there,):
                there.subscribe(OTHER, "/map", STRING, LATCHED, lambda message, gid: got.append(message))
                await until(lambda: got)
                writer.write(b"next")
                await until(lambda: len(got) == 2)
            assert got == [b"map", b"next"]
            assert own == []
            await here.stop()

    run(scenario)


def test_latched_messages_of_a_publisher_that_comes_later_arrive():
    async def scenario():
        async with router() as at, carriers(1, at) as (there,):
            got = []
            there.subscribe(OTHER, "/map", STRING, LATCHED, lambda message, gid: got.append(message))
            async with carriers(1, at) as (here,):
                here.publish(NODE, "/map", STRING, LATCHED).write(b"map")
                await until(lambda: got == [b"map"])

    run(scenario)


def test_late_subscribers_get_no_latched_messages_above_their_lifespan():
    async def scenario():
        qos = {"depth": 5, "durability": Durability.TRANSIENT_LOCAL}
        async with router() as at, carriers(2, at) as (here, there):
            short = here.publish(NODE, "/short", STRING, QosProfile(**qos, lifespan_ns=100_000_000))
            long = here.publish(NODE, "/long", STRING, QosProfile(**qos, lifespan_ns=100_000_000_000))
            for writer in (short, long):
                writer.write(b"old")
            await until(lambda: not short._publishers.declared)
            got = {"/short": [b"old"], "/long": []}
            there.subscribe(OTHER, "/long", STRING, LATCHED, lambda message, gid: got["/long"].append(message))
            await until(lambda: got["/long"])
            assert got["/long"] == [b"old"]
            while b"old" in got["/short"]:  # zenoh ends a publisher a moment later.
                short.write(b"new")
                late = got["/short"] = []
                there.subscribe(OTHER, "/short", STRING, LATCHED, lambda message, gid, to=late: to.append(message))
                await until(lambda to=late: b"new" in to)

    run(scenario)


@pytest.mark.slow
def test_a_client_that_does_not_read_its_responses_delays_nobody():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            got, served, responses, released = [], [], [], threading.Event()
            here.serve(NODE, "/add", ADD, lambda request, gid, reply: (served.append(reply), reply(bytes(100_000))))
            there.subscribe(OTHER, TOPIC, STRING, DEFAULT, lambda message, gid: got.append(message))
            writer, client = here.publish(NODE, TOPIC, STRING, DEFAULT), there.client(OTHER, "/add", ADD)
            await until(lambda: writer.readers and client.has_server)
            hostile = stranger(at)
            waits = Callback(lambda sample: released.wait() and None, indirect=False)
            subscribed = hostile.declare_subscriber(KEY, waits)
            key = data_key(DOMAIN, "/add", ADD.dds_name, ADD.hash)

            def request(number: int) -> None:
                # A new gid for each request does not make another client of it.
                valid = Attachment(number, 1, number.to_bytes(16)).write()
                hostile.get(key, waits, target=zenoh.QueryTarget.ALL_COMPLETE, payload=b"", attachment=valid)

            while not served:  # The first requests come before zenoh knows the way.
                request(0)
                with suppress(TimeoutError):
                    async with asyncio.timeout(0.2):
                        await until(lambda: served)
            for number in range(600):
                request(number)
            await until(lambda: len(served) > 64)
            # zenoh waits 5 s for a client before it closes the connection.
            async with asyncio.timeout(3.0):
                for number in range(30):
                    writer.write(b"%d" % number)
                    await until(lambda number=number: len(got) > number)
                client.call(b"honest", responses.append)
                await until(lambda: responses)
            released.set()
            await asyncio.to_thread(hostile.close)
            assert subscribed

    run(scenario)


def test_services_answer_at_once_and_later():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            replies, clients, responses = [], [], []

            def on_request(request, gid, reply):
                clients.append(there.node_of(gid) if request == b"first" else None)
                replies.append((request, reply))

            there.serve(OTHER, "/add", ADD, on_request)
            client = here.client(NODE, "/add", ADD)
            assert not client.has_server
            await until(lambda: client.has_server and there.nodes())
            client.call(b"first", responses.append)
            client.call(b"second", responses.append)
            await until(lambda: len(replies) == 2)
            for request, reply in reversed(replies):
                reply(request.upper())
                reply(b"again")  # This has no effect.
            await until(lambda: len(responses) == 2)
            assert sorted(responses) == [b"FIRST", b"SECOND"]
            assert clients[0] == "/robot1/amcl"
            client.call(b"late", responses.append)
            await until(lambda: len(replies) == 3)
            client.close()
            replies[2][1](b"nobody reads this")
            await until(lambda: not [each for each in there.endpoints() if each.role is EndpointRole.CLIENT])
            assert len(responses) == 2

    run(scenario)


def test_the_graph_knows_nodes_and_endpoints_of_the_same_domain():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there), carriers(1, at, DOMAIN + 1) as (elsewhere,):
            here.publish(NODE, TOPIC, STRING, SENSOR_DATA)
            here.subscribe(NODE, "/map", STRING, LATCHED, lambda message, gid: None)
            here.client(NODE, "/add", ADD)
            there.add_node(OTHER)
            await until(lambda: len(there.endpoints()) == 3 and here.nodes() == [OTHER])
            found = {each.role: each for each in there.endpoints()}
            publisher = found[EndpointRole.PUBLISHER]
            assert (publisher.node, publisher.name, publisher.type) == (NODE, TOPIC, STRING.name)
            assert (publisher.hash, publisher.qos) == (STRING.hash, SENSOR_DATA)
            assert found[EndpointRole.SUBSCRIPTION].qos == LATCHED
            assert found[EndpointRole.CLIENT].type == ADD.name
            assert there.nodes() == [NODE]
            assert elsewhere.nodes() == []
            await here.stop()
            await until(lambda: not there.nodes() and not there.endpoints())

    run(scenario)


def test_a_restarted_router_is_joined_again():
    async def scenario():
        port, got = free_port(), []
        async with router(port) as at:
            here, there = ZenohCarrier(DOMAIN, at), ZenohCarrier(DOMAIN, at)
            assert await here.start() is None
            writer = here.publish(NODE, "/map", STRING, LATCHED)
            writer.write(b"map")
        async with router(port):
            # Only a new router can bring the two programs together.
            while await there.start() is not None:
                await asyncio.sleep(0.05)
            there.subscribe(OTHER, "/map", STRING, LATCHED, lambda message, gid: got.append(message))
            await until(lambda: got and here.nodes())
            assert got == [b"map"]
            assert here.nodes() == [OTHER]
            await here.stop()
            await there.stop()

    run(scenario)


def test_without_a_router_the_reason_names_the_remedy():
    async def scenario():
        carrier = ZenohCarrier(DOMAIN, Address("127.0.0.1", free_port()))
        found = await carrier.start()
        assert isinstance(found, CannotReach)
        assert "Connection refused. Start one with `thbridge ros2 router`" in str(found)
        await carrier.stop()

    run(scenario)


def test_another_program_at_the_address_is_no_router(monkeypatch):
    monkeypatch.setattr("thbridge.ros2graph.sockets.zenoh_link._CONNECT_SECONDS", 0.3)

    async def scenario():
        async with await asyncio.start_server(lambda reader, writer: writer.close(), "127.0.0.1", 0) as other:
            carrier = ZenohCarrier(DOMAIN, Address(*other.sockets[0].getsockname()))
            assert "is no zenoh router" in str(await carrier.start())

    run(scenario)


def test_a_peer_whose_connection_breaks_is_connected_again_until_it_ends(monkeypatch):
    monkeypatch.setattr("thbridge.ros2graph.sockets.zenoh_lost_peers._PAUSE_SECONDS", 0.05)

    async def scenario():
        async with router() as at, carriers(1, at) as (here,):
            session, lost = here._link._session, here._link._lost
            writer = here.publish(NODE, TOPIC, STRING, DEFAULT)
            with stranger(at) as other:
                got = []
                take = Callback(lambda sample: got.append(sample.payload.to_bytes()), indirect=False)
                kept = other.declare_subscriber(KEY, take)
                for message in (b"first", b"second", b"third"):

                    def arrives(message: bytes = message) -> bool:
                        # zenoh drops messages until it knows the subscriber.
                        writer.write(message)
                        return message in got

                    await until(arrives)
                    break_connection(session, other)
                    await until(lambda: lost._lost)
                    await until(lambda: not lost._lost)
                assert session.info.peers_zid()
                kept.undeclare()
            await until(lambda: not (lost._lost or session.info.peers_zid()))

    run(scenario)


def test_garbage_collection_ends_requests_while_another_response_is_posted():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            kept = []
            here.serve(NODE, "/add", ADD, lambda request, gid, reply: kept.append(reply))
            client = there.client(OTHER, "/add", ADD)
            await until(lambda: client.has_server)
            client.call(b"", lambda response: None)
            await until(lambda: kept)
            collection = threading.Thread(target=kept.clear, daemon=True)
            with here._link._replies._pool._shutdown_lock:  # A thread has this lock while it posts a response.
                collection.start()
                collection.join(10)
                assert not collection.is_alive()

    run(scenario)


def test_a_flood_while_the_loop_is_busy_keeps_the_last_messages(caplog, monkeypatch):
    # Other tests may have used up the warnings of this process.
    monkeypatch.setattr(zenoh_endpoints, "_warnings", WarnOnce(logging.getLogger("flooded")))

    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            got, flooded = [], threading.Event()
            there.subscribe(OTHER, TOPIC, STRING, QosProfile(3), lambda message, gid: got.append(message))
            there.subscribe(OTHER, "/end", STRING, DEFAULT, lambda message, gid: None)
            writer = here.publish(NODE, TOPIC, STRING, QosProfile(5000))
            await until(lambda: writer.readers)
            for number in range(2000):
                writer.write(b"%d" % number)
            here._link.call(lambda session: flooded.set())
            assert flooded.wait(30)  # The loop, which both carriers share, does nothing in the meantime.
            await until(lambda: b"1999" in got)
            assert len(got) < 2000
            assert got == sorted(got, key=int)

    run(scenario)
    assert [each.name for each in caplog.records].count("flooded") == 1
    assert "the last 3 are kept" in caplog.text


def test_hostile_messages_and_requests_are_dropped_and_the_honest_ones_arrive():
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            got, requests = [], []
            here.subscribe(NODE, TOPIC, STRING, DEFAULT, lambda message, gid: got.append(message))
            here.serve(NODE, "/add", ADD, lambda request, gid, reply: (requests.append(request), reply(request)))
            writer, client = there.publish(OTHER, TOPIC, STRING, DEFAULT), there.client(OTHER, "/add", ADD)
            await until(lambda: writer.readers and client.has_server)
            with stranger(at) as hostile:
                valid = Attachment(1, 1, bytes(16)).write()

                def is_connected() -> bool:
                    # zenoh drops messages until it knows the subscriber.
                    hostile.put(KEY, b"first", attachment=valid)
                    return bool(got)

                await until(is_connected)
                hostile.put(KEY, b"no attachment")
                hostile.put(KEY, b"short", attachment=b"x" * 32)
                hostile.put(KEY, b"wrong", attachment=b"x" * 33)
                hostile.delete(KEY, attachment=valid)
                key = data_key(DOMAIN, "/add", ADD.dds_name, ADD.hash)
                replies = [[*hostile.get(key, payload=b"no attachment")], [*hostile.get(key)]]
                hostile.put(KEY, b"", attachment=valid)
                await until(lambda: b"" in got)
            responses = []
            writer.write(b"honest")
            client.call(b"honest", responses.append)
            await until(lambda: b"honest" in got and responses)
            assert (set(got), requests, replies) == ({b"first", b"", b"honest"}, [b"honest"], [[], []])

    run(scenario)


def test_hostile_announcements_change_nothing(caplog):
    async def scenario():
        async with router() as at, carriers(2, at) as (here, there):
            keys = SessionKeys(DOMAIN, "abc").endpoint(
                1, 2, NODE, EndpointRole.SUBSCRIPTION, TOPIC, STRING.dds_name, STRING.hash, DEFAULT
            )
            there.add_node(OTHER)
            with stranger(at) as hostile:
                texts = [
                    f"@ros2_lv/{DOMAIN}/x",
                    f"@ros2_lv/{DOMAIN}/{'a/' * 500}b",
                    keys.liveliness.replace("::,10", "::,x"),
                    keys.liveliness.replace("amcl", "ü"),
                    *(f"@ros2_lv/{DOMAIN}/flood/{number}" for number in range(500)),
                ]
                kept = [hostile.liveliness().declare_token(text) for text in texts]
                kept.append(hostile.liveliness().declare_token(keys.liveliness))
                await until(lambda: here.endpoints() and here.nodes())
                assert [each.gid for each in here.endpoints()] == [keys.gid]
                assert here.nodes() == [OTHER]
            await until(lambda: not here.endpoints())

    run(scenario)
    assert "is invalid" in caplog.text


def test_it_listens_on_this_machine_only():
    settings = json.loads(str(peer_settings("a", Address("robot", 7447))))
    assert settings["listen"]["endpoints"] == ["tcp/127.0.0.1:0"]
    assert settings["connect"]["endpoints"] == ["tcp/robot:7447"]
    assert settings["scouting"]["multicast"]["enabled"] is False
    assert settings["mode"] == "client"
    assert json.loads(str(peer_settings("a", Address("localhost", 7447))))["mode"] == "peer"
