import importlib.util
import sys

import numpy as np
import pytest
from PIL import Image

from tests.support.project import ROOT


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("treasures", ROOT / "scripts" / "draw" / "treasures.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_every_picture_of_the_templates_is_drawn_by_the_script(script):
    drawn = {ROOT / "templates" / name for name in script.PICTURES}
    assert drawn == set((ROOT / "templates").glob("*/pictures/*"))


@pytest.mark.slow
def test_the_script_draws_the_picture_that_is_there(script):
    name = "original-2016/pictures/rsz_t3.jpg"
    again = np.asarray(script.draw(script.PICTURES[name]())).astype(float)
    with Image.open(ROOT / "templates" / name) as picture:
        kept = np.asarray(picture).astype(float)
    # JPEG loses a little along edges.
    assert np.abs(again - kept).mean() < 2.0
