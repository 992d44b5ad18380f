"""`thbridge sweep` from the user's seat."""

import json
from pathlib import Path

import pytest
from pyarrow import csv, parquet

from tests.support.programs.commands import invoke, refusal
from tests.support.programs.inline_engine import InlineEngine
from tests.support.slow import slow
from thbridge.batch import tasks
from ui.commands.sweep import engines

DESIGN = """\
base: {game.energy: 20}
factors:
  noise.odometry.alpha1: [0, 0.1]
  robots: [1, 2]
replicates: 3
max_seconds: 2
verify: 2
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder with a design to work in."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.yaml").write_text(DESIGN)
    return tmp_path


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a sweep that was played."""
    place = tmp_path_factory.mktemp("played")
    (place / "design.yaml").write_text(DESIGN)
    done = invoke("sweep", place / "design.yaml", "--out", place / "sweep", "--processes", "1")
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("12 games played; ")
    return place / "sweep"


def test_check_tells_how_many_games_there_are_and_plays_none() -> None:
    told = json.loads(invoke("sweep", "--check", "design.yaml", "--json").stdout)
    assert (told["games"], told["seeds"], told["chunks"], len(told["conditions"])) == (12, 3, 4, 4)
    assert 0 < told["verified"] < 12
    shown = invoke("sweep", "run", "design.yaml", "--check").stdout
    assert "4 conditions, each with the same 3 seeds: 12 games" in shown
    assert [path.name for path in Path().iterdir()] == ["design.yaml"]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (
            ("--shard", "3/2"),
            "--shard: '3/2' is not of the form I/N. Write, for example, --shard 2/8 for part 2 of 8.",
        ),
        (("--scheduler", "tcp://a:1"), "--scheduler: only a Dask cluster has a scheduler. Add --engine dask, or omit"),
        (("--engine", "dask"), "--engine dask: the address of the cluster is missing. Add --scheduler, such as tcp://"),
        (("--slurm", "partition=short"), "--slurm: this option is only for Slurm jobs. Add --engine slurm, or omit"),
        (
            ("--engine", "slurm", "--slurm", "short"),
            "--slurm: 'short' is not KEY=VALUE. Write, for example, --slurm par",
        ),
    ],
)
def test_options_that_do_not_fit(options: tuple[str, ...], told: str) -> None:
    assert told in refusal("sweep", "design.yaml", *options)


def test_a_faulty_design_starts_nothing() -> None:
    Path("design.yaml").write_text("factors:\n  robots: [1, few]\n")
    told = refusal("sweep", "design.yaml")
    assert told == "design.yaml, line 2, robots: 'few' is not a number. Write a whole number, 1 to 250.\n"


def test_status_tells_what_is_done(played: Path) -> None:
    told = json.loads(invoke("sweep", "status", played, "--json").stdout)
    assert (told["games"], told["done"], told["missing"], told["differing"]) == (12, 12, 0, [])
    assert told["verified"] == told["drawn"] > 0
    assert len(told["versions"]) == 1
    assert "out of time" in invoke("sweep", "status", played).stdout


def test_a_folder_that_is_no_sweep() -> None:
    for name, more in (("status", ()), ("collect", ("--to", "a.csv")), ("plot", ("--to", "a.png"))):
        told = refusal("sweep", name, "nowhere", *more)
        assert told == "nowhere/sweep.json: there is no such file. Name the folder of a sweep, or restore this file.\n"


def test_collect_writes_the_same_table_in_both_formats(played: Path, folder: Path) -> None:
    for name in ("games.csv", "games.parquet"):
        assert invoke("sweep", "collect", played, "--to", name).exit_code == 0
    flat, full = csv.read_csv(folder / "games.csv"), parquet.read_table(folder / "games.parquet")
    assert flat.num_rows == full.num_rows == 12
    assert set(full.column_names) - set(flat.column_names) == {"each_robot"}
    for name in ("condition", "seed", "noise.odometry.alpha1", "robots", "score", "error_95"):
        assert flat[name].to_pylist() == full[name].to_pylist(), name
    assert invoke("sweep", "collect", played, "--to", "-").stdout == (folder / "games.csv").read_text()


@pytest.mark.parametrize("suffix", ["svg", *slow("png", "pdf")])
@pytest.mark.parametrize("band", ["t", "bootstrap"])
def test_the_same_games_give_the_same_figure(played: Path, folder: Path, suffix: str, band: str) -> None:
    plot = ("sweep", "plot", played, "--measure", "error_mean", "--lines", "robots", "--band", band, "--to")
    files = [folder / f"{number}.{suffix}" for number in (1, 2)]
    for file in files:
        assert invoke(*plot, file).exit_code == 0
    assert files[0].read_bytes() == files[1].read_bytes()
    assert len(files[0].read_bytes()) > 1000


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--to", "a.gif"), "--to: a.gif is not a figure. Write a file name that ends in .png, .svg or .pdf."),
        (("--to", "a.png", "--x", "team"), "--x: 'team' is not a factor of this sweep. Write one of noise.odometry."),
        (
            ("--to", "a.png", "--measure", "over"),
            "--measure: 'over' is not a numeric measure of these games. Write one of score, ",
        ),
    ],
)
def test_figures_that_cannot_be(played: Path, options: tuple[str, ...], told: str) -> None:
    assert told in refusal("sweep", "plot", played, *options)


@pytest.mark.slow
def test_games_that_are_not_the_same_again_end_with_1(monkeypatch: pytest.MonkeyPatch) -> None:
    number = iter(range(1000))
    monkeypatch.setattr(tasks.RecordedDigest, "hexdigest", lambda _self: str(next(number)))
    monkeypatch.setattr(engines, "ProcessEngine", lambda _processes, _warm: InlineEngine())
    done = invoke("sweep", "design.yaml", "--processes", "1")
    assert done.exit_code == 1
    assert "repeated games gave DIFFERENT results. Do not trust this sweep." in done.stderr
    assert "seed 1: the repetition gave another result (first played by " in done.stderr
