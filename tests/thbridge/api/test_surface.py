"""The public surface, name by name and argument by argument, is that of `surface.txt`.

Who changes it on purpose writes it anew by `python -m tests.thbridge.api.test_surface`, and says in the changelog what
changed, by the rules of docs/reference/api.md.
"""

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from thbridge import api
from thbridge.api import learning

FILE = Path(__file__).with_name("surface.txt")
MADE_BY_CALLERS = {"AbstractHuntEnv", "HuntEnv", "HuntRecording", "HuntSession", "HuntStudy"}
OF_PETTINGZOO = {"max_num_agents", "num_agents", "unwrapped"}


def public_classes() -> dict[str, type]:
    """Return the classes that `thbridge.api` and `thbridge.api.learning` name."""
    named = [*inspect.getmembers(api, inspect.isclass), *inspect.getmembers(learning, inspect.isclass)]
    return {thing.__name__: thing for _, thing in named}


def members(kind: type) -> Iterator[tuple[str, str, str]]:
    """Yield name, form and documentation of each public member, those among the attributes of its docstring last."""
    for name in dir(kind):
        if name.startswith("_") or name in OF_PETTINGZOO or hasattr(Exception, name):
            continue
        member = inspect.getattr_static(kind, name)
        getter = getattr(member, "fget", getattr(member, "func", None))
        if getter is not None:
            yield name, "", inspect.getdoc(getter) or ""
        elif callable(member):
            yield name, arguments(member), inspect.getdoc(member) or ""
    _, _, attributes = (inspect.getdoc(kind) or "").partition("\nAttributes:\n")
    for name, meaning in re.findall(r"^    (\w+): (.*)", attributes, re.MULTILINE):
        yield name, "", meaning


def arguments(function: Callable[..., object]) -> str:
    """Return names and defaults of a function's arguments; types are checked by mypy, and named otherwise by numpys."""
    given = [
        each.replace(annotation=inspect.Parameter.empty) for each in inspect.signature(function).parameters.values()
    ]
    return str(inspect.Signature([each for each in given if each.name != "self"]))


def surface() -> str:
    """Return all of it as text, a line a member."""
    lines: list[str] = []
    for name, kind in sorted(public_classes().items()):
        lines.append(f"{name}{arguments(kind) if name in MADE_BY_CALLERS else ''}")
        lines += sorted({f"{name}.{member}{form}" for member, form, _ in members(kind)})
    return "\n".join(lines) + "\n"


def test_the_public_surface_is_what_it_was() -> None:
    assert surface() == FILE.read_text()


def test_every_public_member_says_what_it_is() -> None:
    silent = [
        f"{name}.{member}" for name, kind in public_classes().items() for member, _, told in members(kind) if not told
    ]
    assert silent == []


def test_nothing_but_classes_of_the_interface_is_public() -> None:
    assert all(kind.__module__.startswith("thbridge.api.") for kind in public_classes().values())
    routines = [name for module in (api, learning) for name, _ in inspect.getmembers(module, inspect.isroutine)]
    assert [name for name in routines if not name.startswith("_")] == []


if __name__ == "__main__":
    FILE.write_text(surface())
