"""Disk that loses unsynced data at a power cut: a file system of our own, which the kernel calls through FUSE.

It keeps two states. The state that programs see changes with every call. The durable state changes only by fsync: fsync
of a file makes its bytes durable, fsync of a folder its names (files created, renamed and removed in it). A power cut
stops the machine in the middle of a call. Afterwards, only what POSIX guarantees is there: a file whose name was not
synced may be gone, a file that was renamed without a sync of its bytes may be empty, and a rename may not have
happened.

    with ForgettingDisk(folder) as disk:
        disk.cut_after(7)  # the machine stops at the seventh change from now on
        process = Popen([...], cwd=disk.folder)
        disk.wait(process)
        disk.cut(process)  # all that was not synced is gone
        disk.cut(seed=3)  # the same cut again: some unsynced data remain, and half of a write

Permissions and times are durable at once, unlike all other data. The file system runs in its own process. It can
therefore answer even while a caller waits for the disk and holds Python's global lock.
"""

import contextlib
import ctypes
import errno
import itertools
import os
import random
import select
import stat
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, Self

DEVICE = "/dev/fuse"
_DETACH = 2  # flag of umount2


def why_not() -> str | None:
    """Return the reason why no such disk can be mounted here; None if it can be."""
    try:
        os.close(os.open(DEVICE, os.O_RDWR))
    except OSError as error:
        return f"{DEVICE} is not ours to open ({error.strerror})"
    if os.getuid() != 0:
        return "only root mounts a file system"
    with tempfile.TemporaryDirectory() as folder:
        try:
            device = _mounted(folder)
        except OSError as error:
            return f"no file system can be mounted here ({error.strerror})"
        _libc.umount2(folder.encode(), _DETACH)
        os.close(device)
    return None


class Killable(Protocol):
    """Process that can be killed, such as a `subprocess.Popen` or a `multiprocessing.Process`."""

    pid: int | None

    def kill(self) -> None: ...


# State on the disk


@dataclass(eq=False)
class Node:
    """File, folder or link.

    Attributes:
        content: bytes of a file as programs see them, or the target of a link.
        durable: bytes that are durable.
        writes: writes since the last sync, each an offset and the bytes written there, or a new size and None.
        names: entries of a folder as programs see them.
        durable_names: entries of a folder that are durable.
    """

    mode: int
    user: int = 0
    group: int = 0
    changed_ns: int = field(default_factory=time.time_ns)
    number: int = field(default_factory=itertools.count(1).__next__)
    content: bytearray = field(default_factory=bytearray)
    durable: bytearray = field(default_factory=bytearray)
    writes: list[tuple[int, bytes | None]] = field(default_factory=list)
    names: dict[bytes, "Node"] = field(default_factory=dict)
    durable_names: dict[bytes, "Node"] = field(default_factory=dict)

    @property
    def is_folder(self) -> bool:
        return stat.S_ISDIR(self.mode)

    def write(self, place: int, data: bytes | None) -> None:
        """Write bytes at an offset. If `data` is None, the offset becomes the file's size."""
        _applied(self.content, place, data)
        self.writes.append((place, data))
        self.changed_ns = time.time_ns()

    def sync(self) -> None:
        for place, data in self.writes:
            _applied(self.durable, place, data)
        self.writes.clear()

    def remains(self, chance: random.Random | None) -> bytearray:
        """Return the bytes after a power cut. If `chance` is None, they are exactly the synced ones."""
        left = bytearray(self.durable)
        if chance is None or not self.writes:
            return left
        kept = chance.choice((0, len(self.writes), chance.randrange(len(self.writes) + 1)))
        for place, data in self.writes[:kept]:
            _applied(left, place, data)
        if kept < len(self.writes) and (data := self.writes[kept][1]) is not None:
            # An interrupted write: either its first bytes are there, or zeros, or nothing.
            piece = data[: chance.randrange(len(data) + 1)]
            _applied(left, self.writes[kept][0], chance.choice((b"", piece, bytes(len(piece)))))
        return left


def _applied(content: bytearray, place: int, data: bytes | None) -> None:
    if data is None:
        del content[place:]
    if data is None or place > len(content):
        content.extend(bytes(max(0, place - len(content))))
    if data:
        content[place : place + len(data)] = data


@dataclass(frozen=True)
class Change:
    """Unsynced change of names: a removed name, an added name, or both in one step."""

    gone: tuple[Node, bytes] | None
    come: tuple[Node, bytes, Node] | None

    @property
    def folders(self) -> set[int]:
        return {place[0].number for place in (self.gone, self.come) if place is not None}


class Disk:
    """All files of a disk, in the state that programs see and in the durable state."""

    def __init__(self, root: Node | None = None) -> None:
        self.root = root or Node(stat.S_IFDIR | 0o755)
        self.changes: list[Change] = []

    def change(self, gone: tuple[Node, bytes] | None, come: tuple[Node, bytes, Node] | None) -> None:
        self.changes.append(Change(gone, come))
        if gone is not None:
            del gone[0].names[gone[1]]
            gone[0].changed_ns = time.time_ns()
        if come is not None:
            come[0].names[come[1]] = come[2]
            come[0].changed_ns = time.time_ns()

    def sync_names(self, folder: Node) -> None:
        """Make the names of a folder durable, and those of all folders that unsynced moves connect with it."""
        numbers = {folder.number}
        while more := {n for each in self.changes if each.folders & numbers for n in each.folders} - numbers:
            numbers |= more
        for each in [each for each in self.changes if each.folders & numbers]:
            for place in (each.gone, each.come):
                if place is not None:
                    place[0].durable_names = dict(place[0].names)
            self.changes.remove(each)
        folder.durable_names = dict(folder.names)

    def settle(self) -> None:
        """Make everything durable."""
        self.changes.clear()
        folders = [self.root]
        while folders:
            folder = folders.pop()
            folder.durable_names = dict(folder.names)
            for node in folder.names.values():
                node.sync()
                if node.is_folder:
                    folders.append(node)

    def after_cut(self, chance: random.Random | None) -> "Disk":
        """Return the disk after a power cut. If `chance` is None, it has exactly what was synced."""
        names: dict[int, dict[bytes, Node]] = {}

        def of(folder: Node) -> dict[bytes, Node]:
            return names.setdefault(folder.number, dict(folder.durable_names))

        share = 0.0 if chance is None else chance.choice((0.0, 0.5, 1.0))
        for change in self.changes:
            if chance is None or chance.random() >= share:
                continue
            if change.gone is not None:
                of(change.gone[0]).pop(change.gone[1], None)
            if change.come is not None:
                of(change.come[0])[change.come[1]] = change.come[2]
        copies: dict[int, Node] = {}

        def copied(node: Node) -> Node:
            if node.number not in copies:
                copy = copies[node.number] = Node(node.mode, node.user, node.group, node.changed_ns)
                copy.content = bytearray(node.content) if stat.S_ISLNK(node.mode) else node.remains(chance)
                copy.durable = bytearray(copy.content)
                copy.names = {name: copied(each) for name, each in of(node).items()}
                copy.durable_names = dict(copy.names)
            return copies[node.number]

        return Disk(copied(self.root))


# The kernel's protocol, version 7.31 (linux/fuse.h)

_IN = struct.Struct("<IIQQIIIHH")
_OUT = struct.Struct("<IiQ")
_ATTR = struct.Struct("<6Q10I")
_VALID_S = 3600
"""Seconds for which the kernel may cache answers: only the kernel changes this disk."""
_LARGEST_WRITE = 1 << 20
_CHANGING = {"create", "mknod", "mkdir", "symlink", "unlink", "rmdir", "rename", "rename2", "link", "write", "setattr"}
_CHANGING |= {"fsync", "fsyncdir"}
_OPCODES = {
    1: "lookup",
    3: "getattr",
    4: "setattr",
    5: "readlink",
    6: "symlink",
    8: "mknod",
    9: "mkdir",
    10: "unlink",
    11: "rmdir",
    12: "rename",
    13: "link",
    14: "open",
    15: "read",
    16: "write",
    17: "statfs",
    18: "release",
    20: "fsync",
    25: "flush",
    26: "init",
    27: "opendir",
    28: "readdir",
    29: "release",
    30: "fsyncdir",
    35: "create",
    43: "fallocate",
    45: "rename2",
}
_UNANSWERED = {2, 36, 42}  # forget, interrupt, batch_forget


class _Served:
    """Requests of the kernel to the disk: one method per kind of request, called with node, arguments, user and
    group."""

    def __init__(self, disk: Disk) -> None:
        self.disk = disk
        self._nodes: dict[int, Node] = {1: disk.root}
        self._listings: dict[int, list[tuple[bytes, Node]]] = {}
        self._handles = itertools.count(1)

    def ask(self, kind: str, number: int, arguments: memoryview, user: int, group: int) -> bytes:
        answer: bytes = getattr(self, kind)(self._nodes.get(number), bytes(arguments), user, group)
        return answer

    def init(self, _node: Node, arguments: bytes, *_: int) -> bytes:
        _, _, readahead, flags = struct.unpack_from("<4I", arguments)
        wanted = flags & (1 | 1 << 5 | 1 << 22)  # asynchronous reads, big writes, max_pages
        pages = _LARGEST_WRITE >> 12
        return struct.pack("<4IHHIIHHII24x", 7, 31, readahead, wanted, 12, 9, _LARGEST_WRITE, 1, pages, 0, 0, 0)

    def lookup(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        return self._entry(self._at(folder, arguments[:-1]))

    def getattr(self, node: Node, *_: object) -> bytes:
        return struct.pack("<QII", _VALID_S, 0, 0) + self._attributes(node)

    def setattr(self, node: Node, arguments: bytes, *_: int) -> bytes:
        valid, _, _, size, _, _, mtime, _, _, mtime_ns, _, mode, _, user, group, _ = struct.unpack(
            "<IIQQQQQQIIIIIIII", arguments
        )
        if valid & 1:
            node.mode = stat.S_IFMT(node.mode) | stat.S_IMODE(mode)
        if valid & 2:
            node.user = user
        if valid & 4:
            node.group = group
        if valid & 8:
            node.write(size, None)
        if valid & 32:
            node.changed_ns = time.time_ns() if valid & 256 else mtime * 10**9 + mtime_ns
        return self.getattr(node)

    def readlink(self, node: Node, *_: object) -> bytes:
        return bytes(node.content)

    def symlink(self, folder: Node, arguments: bytes, user: int, group: int) -> bytes:
        name, target, _ = arguments.split(b"\0")
        node = Node(stat.S_IFLNK | 0o777, user, group)
        node.content[:] = target
        return self._made(folder, name, node)

    def mknod(self, folder: Node, arguments: bytes, user: int, group: int) -> bytes:
        return self._made(folder, arguments[16:-1], Node(struct.unpack_from("<I", arguments)[0], user, group))

    def mkdir(self, folder: Node, arguments: bytes, user: int, group: int) -> bytes:
        mode = struct.unpack_from("<I", arguments)[0]
        return self._made(folder, arguments[8:-1], Node(stat.S_IFDIR | mode, user, group))

    def create(self, folder: Node, arguments: bytes, user: int, group: int) -> bytes:
        mode = struct.unpack_from("<II", arguments)[1]
        return self._made(folder, arguments[16:-1], Node(mode, user, group)) + self.open(folder)

    def unlink(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        self._at(folder, arguments[:-1])
        self.disk.change((folder, arguments[:-1]), None)
        return b""

    def rmdir(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        if self._at(folder, arguments[:-1]).names:
            raise OSError(errno.ENOTEMPTY, "")
        return self.unlink(folder, arguments)

    def rename(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        return self._renamed(folder, struct.unpack_from("<Q", arguments)[0], 0, arguments[8:])

    def rename2(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        return self._renamed(folder, *struct.unpack_from("<QI", arguments), arguments[16:])

    def _renamed(self, folder: Node, to: int, flags: int, names: bytes) -> bytes:
        old, new, _ = names.split(b"\0")
        node, other = self._at(folder, old), self._nodes[to]
        there = other.names.get(new)
        if flags & ~1:
            raise OSError(errno.EINVAL, "")
        if there is not None and (flags or there.names):
            raise OSError(errno.EEXIST if flags else errno.ENOTEMPTY, "")
        if there is not node:
            self.disk.change((folder, old), (other, new, node))
        return b""

    def link(self, folder: Node, arguments: bytes, *_: int) -> bytes:
        return self._made(folder, arguments[8:-1], self._nodes[struct.unpack_from("<Q", arguments)[0]])

    def open(self, _node: Node, *_: object) -> bytes:
        return struct.pack("<QII", next(self._handles), 2, 0)  # keep the cached pages

    def read(self, node: Node, arguments: bytes, *_: int) -> bytes:
        _, place, size = struct.unpack_from("<QQI", arguments)
        return bytes(node.content[place : place + size])

    def write(self, node: Node, arguments: bytes, *_: int) -> bytes:
        _, place, size = struct.unpack_from("<QQI", arguments)
        node.write(place, arguments[40 : 40 + size])
        return struct.pack("<II", size, 0)

    def statfs(self, *_: object) -> bytes:
        return struct.pack("<5Q4I24x", 1 << 24, 1 << 23, 1 << 23, 1 << 20, 1 << 19, 4096, 255, 4096, 0)

    def release(self, *_: object) -> bytes:
        return b""

    flush = release

    def fallocate(self, _node: Node, arguments: bytes, *_: int) -> bytes:
        if struct.unpack_from("<QQQI", arguments)[3] != 1:  # only KEEP_SIZE is supported
            raise OSError(errno.EOPNOTSUPP, "")
        return b""

    def fsync(self, node: Node, *_: object) -> bytes:
        node.sync()
        return b""

    def fsyncdir(self, node: Node, *_: object) -> bytes:
        self.disk.sync_names(node)
        return b""

    def opendir(self, node: Node, *_: object) -> bytes:
        handle = next(self._handles)
        self._listings[handle] = list(node.names.items())
        return struct.pack("<QII", handle, 0, 0)

    def readdir(self, _node: Node, arguments: bytes, *_: int) -> bytes:
        handle, place, size = struct.unpack_from("<QQI", arguments)
        told = b""
        for number, (name, node) in enumerate(self._listings[handle][place:], place + 1):
            entry = struct.pack("<QQII", node.number, number, len(name), stat.S_IFMT(node.mode) >> 12) + name
            entry += bytes(-len(entry) % 8)
            if len(told) + len(entry) > size:
                break
            told += entry
        return told

    def _at(self, folder: Node, name: bytes) -> Node:
        node = folder.names.get(name)
        if node is None:
            raise OSError(errno.ENOENT, "")
        return node

    def _made(self, folder: Node, name: bytes, node: Node) -> bytes:
        if name in folder.names:
            raise OSError(errno.EEXIST, "")
        self.disk.change(None, (folder, name, node))
        return self._entry(node)

    def _entry(self, node: Node) -> bytes:
        number = 1 if node is self.disk.root else node.number + 1
        self._nodes[number] = node
        return struct.pack("<4Q2I", number, 0, _VALID_S, _VALID_S, 0, 0) + self._attributes(node)

    def _attributes(self, node: Node) -> bytes:
        seconds, rest = divmod(node.changed_ns, 10**9)
        size = len(node.content)
        links = self._links(node)
        return _ATTR.pack(
            node.number, size, (size + 511) // 512, seconds, seconds, seconds, rest, rest, rest, node.mode, links,
            node.user, node.group, 0, 4096, 0,
        )  # fmt: skip

    def _links(self, node: Node) -> int:
        if node.is_folder:
            return 2
        folders, count = [self.disk.root], 0
        while folders:
            for each in folders.pop().names.values():
                count += each is node
                if each.is_folder:
                    folders.append(each)
        return count


_libc = ctypes.CDLL(None, use_errno=True)
_DETACH = 2


def _mounted(folder: str) -> int:
    device = os.open(DEVICE, os.O_RDWR)
    options = f"fd={device},rootmode=40755,user_id=0,group_id=0,default_permissions,allow_other"
    if _libc.mount(b"forgetting", folder.encode(), b"fuse", 0, options.encode()):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), folder)
    return device


def serve(folder: str) -> None:
    """Serve a disk that is mounted on a folder; read commands from standard input until it ends."""
    device, served = _mounted(folder), _Served(Disk())
    buffer = bytearray(_LARGEST_WRITE + 4096)
    view = memoryview(buffer)
    left: int | None = None  # changes left until the machine stops
    counts = dict.fromkeys(_CHANGING, 0)
    state = "on"  # in state stopped, the machine does nothing; in state off, each call fails, and programs die
    before = served.disk

    def tell(word: str) -> None:
        sys.stdout.write(f"{word}\n")
        sys.stdout.flush()

    tell("ready")
    while True:
        ready, _, _ = select.select([0] if state == "stopped" else [0, device], [], [])
        if 0 in ready:
            command, *arguments = _command()
            match command:
                case "after":
                    left = int(arguments[0])
                case "stop":
                    state, before = "stopped", served.disk
                    tell("stopped")
                case "off":
                    state = "off"
                case "on":
                    state = "on"
                    tell("on")
                case "cut":
                    # Writes still cached in memory must not reach the disk any more.
                    os.close(device)
                    _libc.umount2(folder.encode(), _DETACH)
                    served = _Served(before.after_cut(random.Random(arguments[0]) if arguments else None))
                    device, state, left = _mounted(folder), "on", None
                    tell("cut")
                case "fresh":
                    os.close(device)
                    _libc.umount2(folder.encode(), _DETACH)
                    served = _Served(Disk())
                    device, state, left = _mounted(folder), "on", None
                    tell("fresh")
                case "settle":
                    served.disk.settle()
                    tell("settled")
                case "counts":
                    tell(" ".join(f"{name}={count}" for name, count in counts.items()))
                case "end":
                    os.close(device)
                    _libc.umount2(folder.encode(), _DETACH)
                    return
            continue
        try:
            size = os.readv(device, [buffer])
        except OSError as error:
            if error.errno in {errno.ENOENT, errno.EINTR, errno.EAGAIN}:
                continue
            raise
        _, opcode, unique, number, user, group, *_ = _IN.unpack_from(buffer)
        if opcode in _UNANSWERED:
            continue
        kind, fault, answer = _OPCODES.get(opcode, ""), 0, b""
        if kind in _CHANGING and state == "on":
            counts[kind] += 1
            if left is not None:
                left -= 1
                if left <= 0:
                    # The machine stops in the middle of this call: the change is not made, and the caller gets no
                    # answer.
                    state, before, left = "stopped", served.disk, None
                    tell("stopped")
                    held = unique
                    while (command := _command()[0]) != "off":
                        if command == "end":
                            return
                    state = "off"
                    _answer(device, held, errno.EIO, b"")
                    continue
        if state == "off":
            fault = 0 if kind in {"release", "flush"} else errno.EIO
        elif not kind:
            fault = errno.ENOSYS
        else:
            try:
                answer = served.ask(kind, number, view[_IN.size : size], user, group)
            except OSError as error:
                fault = error.errno or errno.EIO
        _answer(device, unique, fault, answer)


def _command() -> list[str]:
    """Read one command, and no byte after it."""
    line = b""
    while not line.endswith(b"\n"):
        if not (sign := os.read(0, 1)):
            return ["end"]
        line += sign
    return line.decode().split()


def _answer(device: int, unique: int, fault: int, answer: bytes) -> None:
    with contextlib.suppress(FileNotFoundError):  # the caller was interrupted
        os.writev(device, [_OUT.pack(_OUT.size + len(answer), -fault, unique), answer])


# Interface for tests


class ForgettingDisk:
    """Mounted disk; see the module. Use it in `with`.

    Args:
        folder: mount point; it is created.

    Attributes:
        folder: mount point.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self._server = subprocess.Popen(
            [sys.executable, __file__, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        self._heard = b""
        self._stopped = False
        self._expect("ready")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Unmount the disk. Closing it twice does nothing."""
        if self._server.poll() is None:
            assert self._server.stdin is not None
            self._server.stdin.close()
            self._server.wait(30)

    def cut_after(self, changes: int) -> None:
        """Stop the machine in the middle of the `changes`-th change from now on."""
        self._say(f"after {changes}")

    def wait(self, *processes: Killable) -> bool:
        """Wait until the machine has stopped; return False if all processes ended before that."""
        with contextlib.ExitStack() as opened:
            ends = set()
            for process in processes:
                assert process.pid is not None
                with contextlib.suppress(ProcessLookupError):
                    end = os.pidfd_open(process.pid)
                    opened.callback(os.close, end)
                    ends.add(end)
            assert self._server.stdout is not None
            while ends and not self._stopped:
                ready, _, _ = select.select([self._server.stdout, *ends], [], [])
                if self._server.stdout in ready:
                    self._expect("stopped")
                    self._stopped = True
                ends -= set(ready)
        return self._stopped

    def stop(self) -> None:
        """Stop the machine now, between two calls."""
        if not self._stopped:
            self._say("stop")
            self._expect("stopped")
            self._stopped = True

    def cut(self, *processes: Killable, seed: int | None = None) -> None:
        """Cut the power: the processes die, and only what was synced remains.

        With a seed, some of the rest remains, too.

        A second call without processes repeats the same cut with another outcome; all changes since the first one are
        lost.
        """
        if processes or not self._stopped:
            self.stop()
            ends = [os.pidfd_open(process.pid) for process in processes if process.pid and _runs(process.pid)]
            for process in processes:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
            self._say("off")
            for end in ends:
                select.select([end], [], [])
                os.close(end)
        self._say("cut" if seed is None else f"cut {seed}")
        self._expect("cut")

    def kill(self, process: Killable) -> None:
        """Kill a process during the change at which the machine has stopped, and continue without a power cut."""
        assert self._stopped
        assert process.pid is not None
        end = os.pidfd_open(process.pid)
        process.kill()
        self._say("off")
        select.select([end], [], [])
        os.close(end)
        self._say("on")
        self._expect("on")
        self._stopped = False

    def on(self) -> None:
        """Continue with the disk as it is after a cut; the next cut is a new one."""
        self._stopped = False

    def fresh(self) -> None:
        """Replace the disk by an empty one."""
        self._say("fresh")
        self._expect("fresh")
        self._stopped = False

    def settle(self) -> None:
        """Make everything durable, as happens after a minute without a power cut."""
        self._say("settle")
        self._expect("settled")

    def counts(self) -> dict[str, int]:
        """Return the number of changes so far, by kind."""
        self._say("counts")
        return {name: int(count) for name, count in (each.split("=") for each in self._line().split())}

    def _say(self, words: str) -> None:
        assert self._server.stdin is not None
        self._server.stdin.write(f"{words}\n".encode())

    def _expect(self, word: str) -> None:
        line = self._line()
        assert line == word, f"the disk says {line!r} instead of {word!r}"

    def _line(self) -> str:
        assert self._server.stdout is not None
        while b"\n" not in self._heard:
            piece = os.read(self._server.stdout.fileno(), 4096)
            assert piece, "the disk has ended"
            self._heard += piece
        line, _, self._heard = self._heard.partition(b"\n")
        return line.decode()


def _runs(process: int) -> bool:
    with contextlib.suppress(ProcessLookupError):
        os.close(os.pidfd_open(process))
        return True
    return False


if __name__ == "__main__":
    serve(sys.argv[1])
