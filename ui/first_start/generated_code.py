"""Code that `dataclasses` generates, kept between starts, as Python keeps the code of modules."""

import atexit
import dataclasses
import hashlib
import marshal
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from sim.numerics.compiled_files import mark_used, read, write


def keep_generated_code(file: Path) -> None:
    """Let `dataclasses` compile each generated method only once on this machine.

    A game imports 600 dataclasses, and `dataclasses` generates the text of about six methods for each of them.
    Compiling these texts would take a sixth of each start.

    Args:
        file: file of the compiled code. It depends on the version of Python.
    """
    content = read(file)
    # By the digest of the text: its compiled code.
    kept: dict[bytes, bytes] = {} if content is None else marshal.loads(content)
    before = len(kept)
    mark_used(file.parent)

    def execute(text: str, names: dict[str, object], results: Mapping[str, object]) -> None:
        digest = hashlib.blake2b(text.encode(), digest_size=16).digest()
        if digest not in kept:
            kept[digest] = marshal.dumps(compile(text, "<string>", "exec"))
        exec(marshal.loads(kept[digest]), names, results)

    def save() -> None:
        if len(kept) > before:
            with suppress(OSError):
                write(file, marshal.dumps(kept))

    # The module finds this name before the built-in function.
    vars(dataclasses)["exec"] = execute
    atexit.register(save)
