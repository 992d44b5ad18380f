"""Studies that have a name and no file: `standard` and `original-2016`."""

from collections.abc import Mapping
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.study.study_file import Study, load_study

STANDARD = Study(templates="everyday-things")
"""Study that is played if the user names no study. The price of a move depends on the robot's position. Robots speak
whole sentences, and each answer states what will happen. In a study file, omitted keys have their values of 2016, so
that older files do not change their meaning."""

BUILT_IN: Mapping[str, Study] = {"standard": STANDARD, "original-2016": Study()}
"""All built-in studies, by name."""


def study_at(path: Path | None) -> tuple[Study, Loaded[Study] | None]:
    """Return a study and its parsed file. For a built-in study, the file is None.

    Args:
        path: path of the file, or name of a built-in study. If None, all values are defaults.

    Raises:
        BadFile: there is no file at this path, or the file has faults; see `load_study`.
    """
    if path is None:
        return Study(), None
    # A file with the name of a built-in study has priority: it was playable before built-in studies existed.
    if str(path) in BUILT_IN and not path.exists():
        return BUILT_IN[str(path)], None
    if not path.suffix and not path.exists():
        remedy = f"check the name and the folder, or write the name of a built-in study: {' or '.join(BUILT_IN)}"
        raise BadFile(path, "there is no such file", remedy)
    loaded = load_study(path)
    return loaded.value, loaded
