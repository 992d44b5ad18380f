"""`make size` counts each line of the product once, for its feature."""

from pathlib import Path

from scripts.count_lines import lines_by_feature


def test_lines_count_for_the_folder_below_the_package(tmp_path: Path) -> None:
    for name, text in {
        "sim/__init__.py": '"""A."""\n',
        "sim/team.py": "a = 1\n\nb = 2",
        "ui/model/__init__.py": "",
        "ui/model/playing/words.py": "a = 1\n   \n",
        "ui/model/page.html": "<p>\n",
        "tests/test_team.py": "a = 1\n",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert lines_by_feature(tmp_path) == {"sim/team": (1, 2), "sim": (1, 1), "ui/model": (2, 1)}
