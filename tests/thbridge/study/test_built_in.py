"""Built-in studies, and the promise that older study files keep."""

from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.study.built_in import STANDARD, study_at
from thbridge.study.study_file import Study


def test_a_name_is_a_built_in_study_and_a_file_of_that_name_comes_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert study_at(Path("standard")) == (STANDARD, None)
    assert study_at(Path("original-2016")) == (Study(), None)
    with pytest.raises(BadFile, match=r"no such file.* standard or original-2016"):
        study_at(Path("original-2017"))
    Path("standard").write_text("robots: 5\n")
    study, file = study_at(Path("standard"))
    assert (study.robots, file is None) == (5, False)


def test_what_an_older_file_leaves_out_is_as_in_2016(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots: 2\n")
    study, _ = study_at(tmp_path / "study.yaml")
    assert study == Study() == study_at(None)[0]
    assert study.templates == "original-2016"
