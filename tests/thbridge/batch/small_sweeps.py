"""Small sweeps, and a task that holds its worker."""

import ctypes
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from thbridge.batch.chunks import Shard
from thbridge.batch.design import read_design
from thbridge.batch.engines.batch_task import TaskOutcome
from thbridge.batch.engines.engine import Engine
from thbridge.batch.folder import open_folder
from thbridge.batch.sweep import EVERYTHING, SweepProgress, run_sweep
from thbridge.batch.tables import VARYING, collect
from thbridge.batch.tasks import SweepTask

DESIGN = """\
base: {game.energy: 20}
factors:
  noise.preset: [none, bad wheels]
  robots: [1, 2]
seeds: [3, 5, 8]
chunk: 2
verify: 1
max_seconds: 4
"""
"""Twelve games of four simulated seconds, each played twice."""


@dataclass(frozen=True)
class HoldingTask:
    """A task that holds its worker's interpreter, as a long compiled call does, the first time it is carried out."""

    folder: Path
    seconds: int
    urgent: bool = False

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        try:
            (self.folder / "held").touch(exist_ok=False)
        except FileExistsError:
            return TaskOutcome(1, 0, (), 0.0)
        ctypes.PyDLL(None).sleep(self.seconds)
        return TaskOutcome(1, 0, (), 0.0)


def run(
    root: Path, engine: Engine[SweepTask], text: str = DESIGN, shard: Shard = EVERYTHING, *, retry: bool = False
) -> SweepProgress:
    """Run a sweep in a folder, or go on with it."""
    file = root.with_suffix(".yaml")
    file.write_text(text)
    design = read_design(file)
    with engine:
        return run_sweep(design, open_folder(design, root), engine, shard, retry=retry)


def games(root: Path) -> pa.Table:
    """Return all that does not differ from run to run."""
    return collect(root).drop_columns(list(VARYING))
