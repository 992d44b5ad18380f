"""Write `docs/reference/study-keys.md`: every key of the files of a study with people, from where the program has them.

python scripts/write_study_keys.py [FILE]
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentFile
from thbridge.experiment.questionnaires.form import Form
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.files.yaml.tree import parse
from ui.model.study_form.form import FieldKind, FormField, FormGroup, form_of, hint_of

ROOT = Path(__file__).parents[1]

HEAD = """\
# Keys of a study with people

Every key of the files in a study's folder. `scripts/write_study_keys.py` writes this page from the classes that the
files are read into. [Studies with people](../how-to/studies-with-people.md) explains how they work together;
`thbridge study edit FOLDER` shows them as a form.

A questionnaire in full:

```yaml
title: How you feel
instructions: Think of the game that you have just played.
shuffle: true                 # another order for each participant
page: 4                       # items on a page
like: {scale: likert, points: 7, low: not at all, high: very much}      # what all items share
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
"""Heading, a small file that has one of each section, what holds where it is silent, headings of sections in it."""


def document() -> str:
    """Return the whole page."""
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
    page = ROOT / "docs" / "reference" / "study-keys.md"
    parser.add_argument(
        "file", nargs="?", type=Path, metavar="FILE", default=page, help="by default docs/reference/study-keys.md"
    )
    parser.parse_args().file.write_text(document(), encoding="utf-8")
