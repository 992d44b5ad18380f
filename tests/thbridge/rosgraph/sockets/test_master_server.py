"""The master over real sockets: notifications in order, one at a time for each node, none held up by another."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

import pytest

from thbridge.rosgraph.sockets import deliveries
from thbridge.rosgraph.sockets.http_client import XmlRpcClient
from thbridge.rosgraph.sockets.http_server import XmlRpcServer
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.wire.master import NodeShutdown, Notification
from thbridge.rosgraph.wire.xmlrpc import Fault, MethodCall, MethodResponse, XmlRpcValue
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen

PATIENCE = 120
STRING = "std_msgs/String"


def run(scenario: Callable[[], Awaitable[None]]) -> None:
    async def within_patience() -> None:
        async with asyncio.timeout(PATIENCE):
            await scenario()
        assert asyncio.all_tasks() == {asyncio.current_task()}

    asyncio.run(within_patience())


class Slave:
    """A node's slave API; what it is told waits in `told`, and its answers wait for `ready`."""

    def __init__(self, status: int = 1) -> None:
        self.told: asyncio.Queue[tuple[XmlRpcValue, ...]] = asyncio.Queue()
        self.ready = asyncio.Event()
        self.ready.set()
        self.at_once = 0
        self.most_at_once = 0
        self.uri = ""
        self._status = status
        self._server = XmlRpcServer(("publisherUpdate", "paramUpdate", "shutdown"), self._answer)

    async def _answer(self, call: MethodCall, peer: str) -> XmlRpcValue:
        assert call.params[0] == "/master"
        self.at_once += 1
        self.most_at_once = max(self.most_at_once, self.at_once)
        await self.told.put((call.method, *call.params[1:]))
        await self.ready.wait()
        self.at_once -= 1
        return [self._status, "", 0]

    async def __aenter__(self) -> "Slave":
        where = await self._server.start()
        assert isinstance(where, ListeningAddress)
        self.uri = f"http://{where.host}:{where.port}/"
        return self

    async def __aexit__(self, *error: object) -> None:
        await self._server.stop()


@asynccontextmanager
async def serving(**options: float) -> AsyncIterator[MasterServer]:
    async with MasterServer(port=0, **options) as master:
        assert isinstance(master, MasterServer)
        yield master


def test_calls_over_sockets_and_without():
    async def scenario():
        async with serving() as master:
            client = XmlRpcClient()
            assert await client.call(master.uri, "setParam", "/x", "/speed", 1.5) == MethodResponse(
                [1, "parameter /speed set", 0]
            )
            assert master.call("getParam", "/y", "/speed").value == 1.5
            assert await client.call(master.uri, "getUri", "/x") == MethodResponse([1, "", master.uri])
            await client.close()

    run(scenario)


def test_what_roscore_sets_is_set():
    async def scenario():
        async with serving() as master:
            names = master.call("getParamNames", "/x").value
            assert names == ["/run_id", "/rosdistro", "/rosversion"]

    run(scenario)


def test_a_slow_subscriber_hears_the_newest_and_one_thing_at_a_time():
    async def scenario():
        async with serving() as master, Slave() as slave:
            master.call("registerSubscriber", "/s", "/chat", STRING, slave.uri)
            master.call("subscribeParam", "/s", slave.uri, "/p")
            slave.ready.clear()
            master.call("registerPublisher", "/p1", "/chat", STRING, "http://h:1/")
            assert await slave.told.get() == ("publisherUpdate", "/chat", ["http://h:1/"])
            for number in range(2, 30):  # while it is busy
                master.call("registerPublisher", f"/p{number}", "/chat", STRING, f"http://h:{number}/")
                master.call("setParam", "/x", "/p", number)
            slave.ready.set()
            method, topic, publishers = await slave.told.get()
            assert (method, topic, len(publishers)) == ("publisherUpdate", "/chat", 29)
            assert await slave.told.get() == ("paramUpdate", "/p/", 29)
            assert slave.told.empty() and slave.most_at_once == 1

    run(scenario)


def test_dead_and_silent_subscribers_hold_up_nobody():
    async def scenario():
        async with serving(timeout=0.2) as master, Slave() as silent, Slave() as well:
            silent.ready.clear()
            for number, uri in enumerate(["http://127.0.0.1:1/", "rosrpc://h:1", silent.uri, well.uri]):
                master.call("registerSubscriber", f"/s{number}", "/chat", STRING, uri)
            for number in range(3):
                master.call("registerPublisher", f"/p{number}", "/chat", STRING, f"http://h:{number}/")
                _, _, publishers = await well.told.get()
                assert len(publishers) == number + 1
            assert silent.told.qsize() == 1
            silent.ready.set()

    run(scenario)


def test_nodes_that_do_not_answer_hold_up_each_other_alone_however_many_they_are(monkeypatch):
    monkeypatch.setattr(deliveries, "AT_ONCE", 2)
    asked = 0

    async def never_answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        nonlocal asked
        asked += 1
        with suppress(OSError):
            await reader.read()
        writer.close()

    async def scenario():
        silent = [await asyncio.start_server(never_answer, "127.0.0.1", 0) for _ in range(10)]
        async with serving(timeout=PATIENCE) as master, Slave() as well:
            master.call("registerSubscriber", "/well", "/chat", STRING, well.uri)
            master.call("registerPublisher", "/p", "/chat", STRING, "http://h:1/")
            await well.told.get()
            for number, server in enumerate(silent):
                uri = f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}/"
                master.call("registerSubscriber", f"/s{number}", "/chat", STRING, uri)
            for number in range(20):
                master.call("registerPublisher", f"/p{number}", "/chat", STRING, f"http://h:{number}/")
                await well.told.get()
            assert asked == 2
        for server in silent:
            server.close()
            await server.wait_closed()
        while len(asyncio.all_tasks()) > 1:
            await asyncio.sleep(0.001)

    run(scenario)


def test_one_address_is_called_once_at_a_time_under_whatever_paths_it_registers():
    async def scenario():
        async with serving() as master, Slave() as slave:
            slave.ready.clear()
            for number in range(50):
                master.call("registerSubscriber", f"/s{number}", "/chat", STRING, f"{slave.uri}{number}")
            master.call("registerPublisher", "/p", "/chat", STRING, "http://h:1/")
            await slave.told.get()
            slave.ready.set()
            for _ in range(49):
                await slave.told.get()
            assert slave.most_at_once == 1

    run(scenario)


def test_notifications_that_wait_have_a_bound_and_nodes_that_answer_are_dropped_last(monkeypatch):
    monkeypatch.setattr(deliveries, "AT_ONCE", 1)
    monkeypatch.setattr(deliveries, "MOST_WAITING", 3)
    told: list[str] = []
    held = asyncio.Event()

    async def deliver(notification: Notification) -> bool:
        told.append(notification.api)
        await held.wait()
        return True

    async def scenario():
        queue = deliveries.Deliveries(deliver)
        for number in range(6):
            queue.post(NodeShutdown(f"http://h:{number}/", "/n", "enough"))
            while number == 0 and not told:
                await asyncio.sleep(0)
        held.set()
        while queue.calls:
            await asyncio.sleep(0)
        assert told == [f"http://h:{number}/" for number in (0, 3, 4, 5)]
        await queue.stop()

    run(scenario)


def test_other_calls_are_answered_while_one_asks_for_thousands_at_once():
    async def scenario():
        async with serving() as master:
            many, one = XmlRpcClient(), XmlRpcClient()
            await one.call(master.uri, "getPid", "/x")
            calls: list[XmlRpcValue] = [{"methodName": "getPid", "params": ["/x"]}] * 2000
            asking = asyncio.ensure_future(many.call(master.uri, "system.multicall", calls, timeout=PATIENCE))
            while master.connections < 2:
                await asyncio.sleep(0)
            for _ in range(20):
                await one.call(master.uri, "getPid", "/x")
            assert not asking.done()
            assert isinstance(await asking, MethodResponse)
            await many.close()
            await one.close()

    run(scenario)


def test_a_node_whose_name_is_taken_is_told_to_end():
    async def scenario():
        async with serving() as master, Slave() as old:
            master.call("registerPublisher", "/node", "/chat", STRING, old.uri)
            master.call("registerPublisher", "/node", "/chat", STRING, "http://127.0.0.1:1/")
            assert await old.told.get() == ("shutdown", "[/node] Reason: new node registered with same name")

    run(scenario)


def test_a_node_that_refuses_a_parameter_is_not_told_again():
    async def scenario():
        async with serving() as master, Slave(status=-1) as refusing, Slave() as taking:
            master.call("subscribeParam", "/r", refusing.uri, "/p")
            master.call("subscribeParam", "/t", taking.uri, "/p")
            for number in range(10):
                master.call("setParam", "/x", "/p", number)
                assert await taking.told.get() == ("paramUpdate", "/p/", number)
            assert refusing.told.qsize() < 5

    run(scenario)


def test_what_is_asked_for_too_often_at_once_is_refused_and_the_master_goes_on():
    async def scenario():
        async with serving() as master:
            client = XmlRpcClient()
            assert master.call("setParam", "/x", "/big", "x" * 100_000).status == 1
            calls: list[XmlRpcValue] = [{"methodName": "getParam", "params": ["/x", "/"]}] * 200
            refused = await client.call(master.uri, "system.multicall", calls)
            assert isinstance(refused, Fault) and "longer" in refused.text
            assert isinstance(await client.call(master.uri, "getParam", "/x", "/big"), MethodResponse)
            await client.close()

    run(scenario)


def test_a_parameter_that_is_too_long_to_be_told_keeps_nothing_else_back():
    async def scenario():
        async with serving() as master, Slave() as slave:
            master.call("subscribeParam", "/s", slave.uri, "/p")
            master.call("setParam", "/x", "/p", "&" * 5_000_000)
            master.call("setParam", "/x", "/p/inner", 2)
            assert await slave.told.get() == ("paramUpdate", "/p/inner/", 2)

    run(scenario)


def test_shutdown_ends_it():
    async def scenario():
        async with serving() as master:
            client = XmlRpcClient()
            assert await client.call(master.uri, "shutdown", "/x", "enough") == MethodResponse([1, "shutdown", 0])
            await master.stopped()
            await client.close()

    run(scenario)


def test_a_port_in_use_is_a_value():
    async def scenario():
        async with serving() as master:
            port = int(master.uri.rstrip("/").rpartition(":")[2])
            async with MasterServer(port=port) as second:
                assert isinstance(second, CannotListen)

    run(scenario)


@pytest.mark.parametrize(("host", "uri"), [("::1", "http://[::1]:"), ("127.0.0.1", "http://127.0.0.1:")])
def test_its_uri_leads_to_it(host, uri):
    async def scenario():
        async with MasterServer(host, 0) as master:
            if isinstance(master, CannotListen):
                pytest.skip(str(master))
            assert master.uri.startswith(uri)
            client = XmlRpcClient()
            assert await client.call(master.uri, "getUri", "/x") == MethodResponse([1, "", master.uri])
            await client.close()

    run(scenario)
