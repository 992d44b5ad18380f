"""Bundle of JavaScript modules: one script, because browsers load no modules from disk."""

import re
from pathlib import Path

_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "(\.{1,2}/[\w./-]+\.js)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const) (\w+))", re.MULTILINE)
_OTHER = re.compile(r"^(?:import|export)\b.*", re.MULTILINE)


def bundle(entry: Path) -> str:
    """Return a module and all modules that it imports as one script; the script does the same as the module.

    Each module becomes a function that is called once and returns what the module exports, so that names of different
    modules do not clash.

    Raises:
        ValueError: modules import each other in a circle, two modules have the same file name, or a module has another
            form than `import { a, b } from "./c.js";` in one line, and `export` before a function, class or constant.
    """
    modules: dict[Path, str] = {}
    _add(entry.resolve(), modules, ())
    if len({_name(path) for path in modules}) < len(modules):
        raise ValueError(f"two modules have the same file name: {', '.join(map(str, modules))}")
    return '"use strict";\n' + "\n".join(modules.values())


def _add(path: Path, modules: dict[Path, str], importers: tuple[Path, ...]) -> None:
    """Add a module to `modules`, after the modules that it imports."""
    if path in importers:
        raise ValueError(f"{path.name} imports itself in a circle: {', '.join(each.name for each in importers)}")
    if path in modules:
        return
    text = path.read_text(encoding="utf-8")
    for _, imported in _IMPORT.findall(text):
        _add((path.parent / imported).resolve(), modules, (*importers, path))
    names = _EXPORT.findall(text)
    body = _EXPORT.sub("", _IMPORT.sub(lambda found: f"const {{ {found[1]} }} = {_name(Path(found[2]))};", text))
    if other := _OTHER.search(body):
        raise ValueError(f"{path.name}: the bundle cannot contain `{other[0]}`")
    modules[path] = f"const {_name(path)} = (() => {{\n{body}\nreturn {{ {', '.join(names)} }};\n}})();\n"


def _name(path: Path) -> str:
    return "$" + re.sub(r"\W", "_", path.stem)
