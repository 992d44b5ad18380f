"""Studies that are known by name without a file: `standard`, and `original-2016`."""

from collections.abc import Mapping
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.study.study_file import Study, load_study

STANDARD = Study(templates="everyday-things")
"""The study that people play who name none: costs from where robots stand, whole sentences, answers that say what
happens. What a study file leaves out keeps its value of 2016, so that older files mean what they meant."""

BUILT_IN: Mapping[str, Study] = {"standard": STANDARD, "original-2016": Study()}
"""Each built-in study by its name."""


def study_at(path: Path | None) -> tuple[Study, Loaded[Study] | None]:
    """Return a study, and its file as it was read.

    Args:
        path: of the file, or the name of a built-in study, which has no file; None: a study that leaves all keys out.

    Raises:
        BadFile: as `load_study`.
    """
    if path is None:
        return Study(), None
    # A file of such a name comes first: it was played before there were built-in studies.
    if str(path) in BUILT_IN and not path.exists():
        return BUILT_IN[str(path)], None
    if not path.suffix and not path.exists():
        remedy = f"check the name and the folder, or name a built-in study: {' or '.join(BUILT_IN)}"
        raise BadFile(path, "there is no such file", remedy)
    loaded = load_study(path)
    return loaded.value, loaded
