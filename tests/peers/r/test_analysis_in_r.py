"""R reads exports and says of them what pandas does."""

import runpy
import shutil
from pathlib import Path

import pandas as pd
import pytest

from tests.support.programs.peer_programs import run_peer
from tests.support.studies.rehearsed_studies import rehearsed_export

pytestmark = pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")

TYPES = """\
lines <- readLines("analysis.R")
here <- "."
eval(parse(text = lines[grep("^outcomes_of", lines):(grep("^factors <-", lines) - 1)]))
answers <- read_table("answers")
people <- read_table("participants")
steps <- read_table("steps")
stopifnot(
  identical(levels(answers[["dialogue.condition"]]), c("supervisor", "collaborator", "adviser")),
  is.logical(answers$counts), all(answers$counts), is.logical(answers$right),
  is.numeric(steps$duration_s), inherits(people$began, "POSIXct"), !anyNA(people$began),
  all(people$ended >= people$began)
)
"""


@pytest.fixture(scope="module")
def export(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return rehearsed_export(tmp_path_factory.mktemp("rehearsal"))


def test_r_and_pandas_say_the_same(export: Path) -> None:
    runpy.run_path(str(export / "analysis.py"), run_name="__main__")
    run_peer(["Rscript", "analysis.R"], cwd=export).check_returncode()
    for name in ("cells", "tests"):
        python, r = (pd.read_csv(export / "results" / f"{name}-{one}.csv") for one in ("python", "r"))
        pd.testing.assert_frame_equal(python, r, check_dtype=False, rtol=1e-4, atol=1e-9)
    assert {"F within", "paired t", "F between", "Welch t", "interaction t"} == set(python.test)
    assert (export / "results" / "workload-r.png").stat().st_size > 1000


def test_r_reads_columns_as_their_types(export: Path) -> None:
    done = run_peer(["Rscript", "-e", TYPES], cwd=export)
    assert done.returncode == 0, done.stderr
