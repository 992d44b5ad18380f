"""R reads exports and says of them what pandas does."""

import runpy
import shutil
from pathlib import Path

import pandas as pd
import pytest

from tests.support.programs.peer_programs import run_peer
from tests.support.studies.group_studies import PAIRS, rehearsed
from tests.support.studies.rehearsed_studies import rehearsed_export
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.rehearsal.people import SimulatedPeople

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


GROUPS = """\
lines <- readLines("analysis.R")
here <- "."
eval(parse(text = lines[grep("^outcomes_of", lines):(grep("^factors <-", lines) - 1)]))
groups <- read_table("groups")
seats <- read_table("seats")
trials <- read_table("trials")
# A person's trial counts even if the game does not, because another one of the group has left the study.
all_groups <- read.csv(list.files("data", "-groups_data.csv$", full.names = TRUE))
stopifnot(
  is.logical(groups$incomplete), is.numeric(seats$waited_s), nrow(seats) == 2 * nrow(groups),
  all(seats$group %in% groups$group), all(na.omit(trials$group) %in% all_groups$group),
  identical(sort(unique(seats$holder)), "person")
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


def test_r_reads_tables_of_groups(tmp_path: Path) -> None:
    folder = rehearsed(tmp_path, PAIRS, SimulatedPeople(plays=False, drop_out=0.05))
    export = tmp_path / "exports" / "one"
    export_experiment(folder, folder.read(), folder.entries(), export, {"thbridge": "1.0"}, None)
    done = run_peer(["Rscript", "-e", GROUPS], cwd=export)
    assert done.returncode == 0, done.stderr
