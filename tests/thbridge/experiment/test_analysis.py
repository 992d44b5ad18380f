"""Scripts that come with exports: they find the effect that a rehearsal put in, and none where none was.

18 people find a difference of 0.8 of its standard deviation with probability 0.89 (noncentral t). The one here is 2.3
times its standard deviation (median), and was found in each of 24 rehearsals with other seeds.
"""

import datetime
import runpy
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from tests.support.studies.rehearsed_studies import MIXED_DESIGN, rehearse, rehearsed_export
from thbridge.experiment.export import folder
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import read_log


@pytest.fixture(scope="module")
def export(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return rehearsed_export(tmp_path_factory.mktemp("rehearsal"))


def test_an_effect_that_was_put_in_is_found_and_none_where_none_was(
    export: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runpy.run_path(str(export / "analysis.py"), run_name="__main__")
    assert "collaborator - supervisor" in capsys.readouterr().out
    tests = pd.read_csv(export / "results" / "tests-python.csv")
    within = tests[(tests.outcome == "workload") & (tests.test == "paired t")].set_index("comparison")
    found = within.loc["dialogue.condition: collaborator - supervisor"]
    assert found.low < 20.0 < found.high
    assert found.p_holm < 0.001
    assert found.effect_size > 2.0
    assert within.loc["dialogue.condition: adviser - supervisor"].p > 0.05
    assert (tests[tests.test == "F within"].set_index("outcome").p < 0.001).to_dict() == {
        "trust": False,
        "workload": True,
    }
    nothing = tests[(tests.outcome == "trust") | tests.test.isin(["F between", "interaction t"])]
    # Of so many tests without an effect one is below 0.05 by chance more often than not.
    assert (nothing.p > 0.05 / len(nothing)).all()
    assert (export / "results" / "workload-python.png").stat().st_size > 1000


def test_before_anybody_met_all_conditions_it_says_that_there_is_nothing_to_compare(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = rehearse(tmp_path, SimulatedPeople(plays=False), 3, MIXED_DESIGN)
    begun = [entry for entry in read_log(folder.log) if entry.sequence <= 12]
    export = tmp_path / "exports" / "first"
    export_experiment(folder, folder.read(), begun, export, {"thbridge": "1.0"}, None)
    runpy.run_path(str(export / "analysis.py"), run_name="__main__")
    assert "cells: none, because no participant has data in all conditions" in capsys.readouterr().out


def test_columns_have_their_types(export: Path) -> None:
    read = runpy.run_path(str(export / "analysis.py"))["table"]
    answers, people, steps = read("answers"), read("participants"), read("steps")
    assert answers["dialogue.condition"].cat.categories.tolist() == ["supervisor", "collaborator", "adviser"]
    assert answers.counts.all()
    assert answers.right.dtype == "boolean"
    assert steps.duration_s.dtype == "float64"
    assert steps.step.dtype == "int64"
    assert people.began.iloc[0].tzinfo is datetime.UTC
    assert (people.ended >= people.began).all()
    assert set(steps.kind) == {"trial", "form"}


def test_without_pandas_it_says_what_to_install() -> None:
    text = (Path(folder.__file__).with_name("scripts") / "analysis.py").read_text()
    command = [sys.executable, "-c", f"import sys; sys.modules['pandas'] = None; exec({text!r})"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "pandas is missing. Run: pip install pandas pyarrow scipy matplotlib\n"
