"""Template set whose treasures have names, values and pictures that occur nowhere else."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from tests.support.project import ROOT

ORIGINAL = ROOT / "templates" / "original-2016"


@dataclass(frozen=True, slots=True)
class SecretTreasure:
    """Treasure of the set: what reveals it, by the event after which a person may know it.

    Attributes:
        name: name in the files.
        words: name and words for it in all languages.
        values: value of its property in all languages.
        picture: bytes of its picture.
        file: name of the file with the picture.
    """

    name: str
    words: tuple[str, ...]
    values: tuple[str, ...]
    picture: bytes
    file: str


def write_secret_set(folder: Path, count: int) -> tuple[SecretTreasure, ...]:
    """Write a template set with words in English and German; return its treasures."""
    shutil.copytree(ORIGINAL, folder)
    for name in ("treasures.participant", "mapTimes", "README.md"):
        (folder / name).unlink()
    shutil.rmtree(folder / "pictures")
    (folder / "pictures").mkdir()
    picture = (ORIGINAL / "pictures" / "rsz_t1.jpg").read_bytes()
    made = []
    for number in range(count):
        mark = f"{chr(97 + number // 26)}{chr(97 + number % 26)}"
        # Letters that JSON or HTML may write in another way belong to the words.
        name, german, value, farbe = f"xqname_{mark}", f"Xqnäme-{mark} & Co", f"Xqhue {mark}", f"xqtön <{mark}>"
        file = f"xqfile{mark}.jpg"
        # What follows the end of a JPEG file is not drawn, but makes each picture a different one.
        content = picture + f"xqpicture{mark}".encode() * 8
        (folder / "pictures" / file).write_bytes(content)
        words = (name, name.replace("_", " "), german)
        made.append(SecretTreasure(name, words, (value, farbe), content, file))
    rows = [f"{each.values[0]},Round and Large,10,{each.name},{each.file}" for each in made]
    (folder / "treasures").write_text("8\n" + "\n".join(rows) + "\n")
    lines = ["treasures:", *(f'  {each.name}: "{each.words[2]}"' for each in made), "properties:"]
    values = ", ".join(f'"{each.values[0]}": "{each.values[1]}"' for each in made)
    lines += ["  - name: colour", "    label: Farbe", f"    values: {{{values}}}"]
    lines += ["  - name: footprint", "    label: Form", "    values: {Round and Large: rund und groß}"]
    (folder / "de").mkdir()
    (folder / "de" / "words.yaml").write_text("\n".join(lines) + "\n")
    shutil.copy(ROOT / "templates" / "everyday-things" / "de" / "DialogueText", folder / "de" / "DialogueText")
    return tuple(made)
