"""Modules become one script, because browsers load no modules from disk."""

from pathlib import Path

import pytest

from ui.web.player import bundle as bundled_from
from ui.web.player.bundle import bundle

ENTRY = Path(bundled_from.__file__).with_name("static") / "player.js"


def _write(folder: Path, **modules: str) -> Path:
    for name, text in modules.items():
        (folder / f"{name}.js").write_text(text)
    return folder / f"{next(iter(modules))}.js"


def test_a_module_is_a_function_that_returns_its_exports_and_comes_after_what_it_imports(tmp_path: Path) -> None:
    entry = _write(
        tmp_path,
        first='import { twice, three } from "./second.js";\nconst at = twice(three);\n',
        second="export const three = 3;\nexport function twice(number) {\n  return 2 * number;\n}\nconst at = 1;\n",
    )
    script = bundle(entry)
    assert "import " not in script
    assert "export " not in script
    assert script.index("const $second = (() => {") < script.index("const $first = (() => {")
    assert "return { three, twice };\n})();" in script
    assert "const { twice, three } = $second;" in script


def test_the_module_of_the_map_is_part_of_the_player() -> None:
    script = bundle(ENTRY)
    assert "class GameMap" in script
    assert script.count("const $dom = ") == 1
    assert "</script" not in script


@pytest.mark.parametrize(
    "text",
    [
        'import all from "./second.js";',
        'import {\n  a,\n} from "./second.js";',
        "export default class A {}",
        "export { a };",
        "export let a = 1;",
    ],
)
def test_a_form_that_the_bundle_does_not_know_is_an_error(text: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"first\.js: the bundle cannot contain"):
        bundle(_write(tmp_path, first=text, second="export const a = 1;\n"))


def test_modules_that_import_each_other_are_an_error(tmp_path: Path) -> None:
    entry = _write(
        tmp_path,
        first='import { b } from "./second.js";\nexport const a = 1;\n',
        second='import { a } from "./first.js";\nexport const b = 1;\n',
    )
    with pytest.raises(ValueError, match=r"first\.js imports itself in a circle: first\.js, second\.js"):
        bundle(entry)
