"""All tables of a template set."""

from collections.abc import Sequence
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.treasure_files import TREASURES, TREASURES_YAML
from thbridge.files.yaml.tree import parse
from ui.model.template_set.list_sheet import ListSheet
from ui.model.template_set.sheet import Sheet, Texts
from ui.model.template_set.yaml_sheets import PropertySheet, TreasureSheet


def sheets_of(texts: Texts, pictures: Sequence[str] = ()) -> dict[str, Sheet]:
    """Return the tables for the readable files of a set, by title.

    Args:
        texts: texts of the set's files, by the names of the files.
        pictures: names of the set's pictures.
    """
    if TREASURES in texts:
        return {"Treasures": ListSheet(texts, pictures)}
    try:
        tree = parse(Path(TREASURES_YAML), texts[TREASURES_YAML])
    except BadFile:
        return {}
    return {"Treasures": TreasureSheet(texts, tree, pictures), "Properties": PropertySheet(texts, tree)}
