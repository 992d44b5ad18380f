"""The design that most tests of studies with people are about."""

import pytest

from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.design.experiment_file import ExperimentDesign, read_experiment


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> ExperimentDesign:
    return read_experiment(write_experiment(tmp_path_factory.mktemp("design")))
