"""Studies that have a name and no file: `standard` and `original-2016`."""

from collections.abc import Mapping
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.study.study_file import Study, load_study

STANDARD = Study(templates="everyday-things")
"""The study that is played if no study is named. Moves are priced from where robots stand, robots speak whole
sentences, and answers say what happens. In a study file, keys that are left out have their values of 2016, so that
older files keep their meaning."""

BUILT_IN: Mapping[str, Study] = {"standard": STANDARD, "original-2016": Study()}
"""Each built-in study by its name."""


def study_at(path: Path | None) -> tuple[Study, Loaded[Study] | None]:
    """Return a study, and its file as it was read. Built-in studies have no file.

    Args:
        path: path of the file, or name of a built-in study. If None, the study has only default values.

    Raises:
        BadFile: as `load_study`.
    """
    if path is None:
        return Study(), None
    # A file with such a name comes first: it was playable before built-in studies existed.
    if str(path) in BUILT_IN and not path.exists():
        return BUILT_IN[str(path)], None
    if not path.suffix and not path.exists():
        remedy = f"check the name and the folder, or name a built-in study: {' or '.join(BUILT_IN)}"
        raise BadFile(path, "there is no such file", remedy)
    loaded = load_study(path)
    return loaded.value, loaded
