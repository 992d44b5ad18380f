"""Editor's view of a template set: texts of the files, and all faults that `templates check` would find."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.set_words import WORDS, languages_beside
from thbridge.files.template_files import DIALOGUE_TEXT, TemplateSet, read_template_set
from thbridge.files.treasure_files import PARTICIPANT_TREASURES, TREASURES, TREASURES_YAML


@dataclass(frozen=True, slots=True)
class TemplateDraft:
    """Texts of a set, and the result of reading them.

    Attributes:
        folder: folder of the set.
        texts: text of each edited file, by the path of the file within the folder.
        templates: the set; None while there are faults.
        faults: all faults; faults in edited texts name the paths of the files.
    """

    folder: Path
    texts: Mapping[str, str]
    templates: TemplateSet | None
    faults: tuple[BadFile, ...]


def edited_names(folder: Path) -> tuple[str, ...]:
    """Return the paths, within a set's folder, of the files that people can edit.

    These files contain the sentences, the treasures, and the words in further languages.
    """
    names = (DIALOGUE_TEXT, WORDS)
    beside = [f"{language}/{name}" for language in languages_beside(folder, names) for name in names]
    spoken = [name for name in beside if (folder / name).exists()]
    if not (folder / TREASURES).exists():
        return (DIALOGUE_TEXT, TREASURES_YAML, *spoken)
    copy = (PARTICIPANT_TREASURES,) if (folder / PARTICIPANT_TREASURES).exists() else ()
    return (DIALOGUE_TEXT, TREASURES, *copy, *spoken)


def template_draft(folder: Path, texts: Mapping[str, str], pictures: Mapping[str, bytes]) -> TemplateDraft:
    """Check a set with these texts and pictures in place of its files; nothing is written into its folder.

    The check uses a temporary folder of links, because the reader of sets only reads folders.

    Args:
        folder: folder of the set.
        texts: text of each edited file, by the path of the file within the folder. If `texts` has a file of a
            language's folder, it must have all files of that folder.
        pictures: new or replaced image files, by name.
    """
    with tempfile.TemporaryDirectory(prefix="thbridge-") as scratch:
        mirror = Path(scratch) / folder.resolve().name
        mirror.mkdir()
        written = {Path(name).parts[0] for name in texts}
        for path in folder.iterdir():
            if path.name not in written:
                (mirror / path.name).symlink_to(path.resolve())
        for name, text in texts.items():
            (mirror / name).parent.mkdir(exist_ok=True)
            (mirror / name).write_text(text, encoding="utf-8", newline="")
        try:
            return TemplateDraft(folder, texts, read_template_set(mirror, pictures), ())
        except BadFiles as several:
            found = several.faults
        except BadFile as fault:
            found = (fault,)
        return TemplateDraft(folder, texts, None, tuple(_in_its_folder(fault, mirror, folder) for fault in found))


def _in_its_folder(fault: BadFile, mirror: Path, folder: Path) -> BadFile:
    if not fault.path.is_relative_to(mirror):
        return fault
    path = folder / fault.path.relative_to(mirror)
    remedy = fault.remedy.replace(str(mirror), str(folder))
    return BadFile(path, fault.problem, remedy, fault.line, fault.key)
