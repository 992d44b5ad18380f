"""The pages of study keys agree with the code, and their example is right."""

import importlib.util
import re
from pathlib import Path

from tests.support.project import ROOT
from thbridge.experiment.questionnaires.form import form_of_tree
from thbridge.files.yaml.tree import parse

SCRIPT = ROOT / "scripts" / "write_study_keys.py"
FOLDER = ROOT / "docs" / "reference"
PAGE = (FOLDER / "study-keys.md").read_text(encoding="utf-8")


def test_the_pages_are_up_to_date() -> None:
    spec = importlib.util.spec_from_file_location("write_study_keys", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.document() == PAGE, "python scripts/write_study_keys.py"
    pages = {
        "study-file.md": module.study_page(),
        "study-seats.md": module.seats_page(),
        "study-ros.md": module.ros_page(),
    }
    for name, page in pages.items():
        assert page == (FOLDER / name).read_text(encoding="utf-8"), "python scripts/write_study_keys.py"


def test_the_questionnaire_of_the_page_has_no_faults() -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    form = form_of_tree(Path("page.yaml"), parse(Path("page.yaml"), text)).value
    assert len({item.scale for item in form.items}) == 6, "an item of each scale"
