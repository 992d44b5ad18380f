"""Write the pages of keys in `docs/reference`, from the code: `study-file.md` and other pages named `study-*.md`.

python scripts/write_study_keys.py [FOLDER]
"""

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentFile
from thbridge.experiment.questionnaires.form import Form
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.files.yaml.tree import parse
from thbridge.study.study_file import Study, StudyFile
from ui.model.study_form.form import FieldKind, FormField, FormGroup, form_of, hint_of

ROOT = Path(__file__).parents[1]

STUDY_HEAD = """\
# Keys of a study file

For researchers and admins: every key of the YAML file that `thbridge play` and all other commands read.

`scripts/write_study_keys.py` writes this page from the code. `thbridge study init study.yaml` writes the same keys as
a commented file, and `thbridge study edit` shows them as a form. The parameters of robots and their world (sections
`robot` and `world`) have [a page of their own](parameters.md), and so have the sections `seats` and `team`
of [games with several people](study-seats.md), and the sections `fleet` and `ros2` of [real robots and ROS 2
graphs](study-ros.md).

## At the top
"""
SEATS_HEAD = """\
# Keys of games with several people

For researchers who study teams: the sections `seats` and `team` of a [study file](study-file.md).

`scripts/write_study_keys.py` writes this page from the code. [Several people in one
game](../how-to/several-people.md) explains how seats, texts and votes work together.
"""
ROS_HEAD = """\
# Keys of real robots and ROS 2 graphs

For roboticists: the sections `fleet` and `ros2` of a [study file](study-file.md).

`scripts/write_study_keys.py` writes this page from the code. [Play with real robots](../how-to/real-robots.md) explains
how the keys are used.
"""
HEAD = """\
# Keys of a study with people

For researchers: every key of the files in a study's folder.

`scripts/write_study_keys.py` writes this page from the code. [Studies with people](../how-to/studies-with-people.md)
explains how the files work together; `thbridge study edit FOLDER` shows them as a form.

A complete questionnaire:

```yaml
title: How you feel
instructions: Think of the game that you have just played.
shuffle: true                 # another order for each participant
page: 4                       # items on a page
like: {scale: likert, points: 7, low: not at all, high: very much}      # for all items
items:
  - {id: calm, text: I felt calm., subscale: ease}
  - {id: hasty, text: I felt hasty., subscale: ease, reverse: true}
  - {id: load, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
  - {id: pace, scale: differential, low: slow, high: quick}
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99}
  - {id: games, text: Which games do you play?, scale: choice, options: [chess, go, none of these], several: true}
  - {id: why, text: Is there anything else?, scale: text, required: false}
```
"""
FILES = (
    ("experiment.yaml", "title: x\nsteps: [{step: trial}]\n", ExperimentFile(title=""), {"steps[0]": "A step"}),
    ("A questionnaire", "title: x\nitems: [{}]\n", Form(title=""), {"items[0]": "An item"}),
    ("rehearsal.yaml", "effects: [{}]\n", SimulatedPeople(), {"effects[0]": "An effect"}),
)
"""Parts of a page: heading, a small file with one section of each kind, defaults of missing keys, and headings of these
sections."""


LISTS = {"seats": "Keys of a seat", "things": "Keys of an obstacle"}
"""Sections of a study that are lists, with the line above the keys of an entry."""
OF_SEATS = {"seats", "team"}
"""Sections of games with several people."""
OF_ROS = {"fleet", "ros2"}
"""Sections of real robots and ROS 2 graphs."""
ELSEWHERE = {"robot", "world", *OF_SEATS, *OF_ROS}
"""Sections of a study file that have pages of their own."""


def study_page() -> str:
    """Return the page of a study file's keys."""
    form = _study_form()
    parts = [STUDY_HEAD, *_table(_row(field, field.key) for field in form.fields)]
    parts += _sections(section for section in form.groups if section.key not in ELSEWHERE)
    return "\n".join(parts) + "\n"


def seats_page() -> str:
    """Return the page of the keys of games with several people."""
    sections = _sections(section for section in _study_form().groups if section.key in OF_SEATS)
    return SEATS_HEAD + "\n".join(sections) + "\n"


def ros_page() -> str:
    """Return the page of the keys of real robots and ROS 2 graphs."""
    sections = _sections(section for section in _study_form().groups if section.key in OF_ROS)
    return ROS_HEAD + "\n".join(sections) + "\n"


def document() -> str:
    """Return the page of the keys of a study with people."""
    parts = [HEAD]
    for heading, text, start, sections in FILES:
        form = form_of(text, parse(Path("file"), text), start)
        parts.append(f"\n## {heading}\n")
        parts += _table(_own_rows(form, sections))
        groups = {group.key: group for group in form.all_groups()}
        for key, title in sections.items():
            parts.append(f"\n### {title}\n")
            parts += _table(_row(field, field.key.rpartition(".")[2]) for field in groups[key].fields)
    return "\n".join(parts) + "\n"


def _study_form() -> FormGroup:
    text = "".join(f"{key}: [{{}}]\n" for key in LISTS)
    return form_of(text, parse(Path("file"), text), StudyFile.of(Study()))


def _sections(sections: Iterable[FormGroup]) -> Iterator[str]:
    for section in sections:
        yield f"\n## `{section.key}`\n\n{section.help[:1].upper()}{section.help[1:]}.\n"
        if section.key in LISTS:
            entry = next(group for group in section.all_groups() if group.key == f"{section.key}[0]")
            yield f"{LISTS[section.key]}:\n"
            yield from _table(_row(field, field.key.rpartition(".")[2]) for field in entry.fields)
        else:
            yield from _table(_own_rows(section, {}))


def _own_rows(form: FormGroup, sections: dict[str, str]) -> Iterator[str]:
    for group in form.all_groups():
        if group.key not in sections:
            if group.key and not group.groups:
                yield f"| `{group.key}` | {group.help} |  |  |"
            yield from (_row(field, field.key) for field in group.fields)


def _row(field: FormField, name: str) -> str:
    limits = ", ".join(field.choices) if field.kind is FieldKind.CHOICE else hint_of(field)
    unit = f" ({field.unit})" if field.unit else ""
    cells = (f"`{name}`", f"{field.help}{unit}", field.default, limits)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _table(rows: Iterator[str]) -> list[str]:
    return ["| key | meaning | default | values |\n|---|---|---|---|", *rows]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", default=ROOT / "docs" / "reference")
    folder = parser.parse_args().folder
    (folder / "study-file.md").write_text(study_page(), encoding="utf-8")
    (folder / "study-seats.md").write_text(seats_page(), encoding="utf-8")
    (folder / "study-ros.md").write_text(ros_page(), encoding="utf-8")
    (folder / "study-keys.md").write_text(document(), encoding="utf-8")
