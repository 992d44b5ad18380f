"""Updates of a localization as rows.

A row has the pose, its covariance, the agreement of map and scan, True if the robot was lost, and the probability that
the pose is wrong.
"""

import csv
import json
from collections.abc import Iterable
from enum import StrEnum
from io import StringIO

import numpy as np

from thbridge.offline.localize import FilterUpdate

COLUMNS = (
    "stamp",
    "x",
    "y",
    "yaw",
    "cov_xx",
    "cov_xy",
    "cov_xa",
    "cov_yy",
    "cov_ya",
    "cov_aa",
    "agreement",
    "lost",
    "p_wrong",
)
"""Units of the columns: seconds; meters and radians in the map frame; m^2, m rad, rad^2; share 0 to 1; true or false;
probability 0 to 1, or empty if the filter does not compute it."""


class UpdatesFormat(StrEnum):
    """File format of updates, given by the suffix of a file."""

    CSV = "csv"
    JSON_LINES = "jsonl"


def updates_text(updates: Iterable[FilterUpdate], kind: UpdatesFormat) -> str:
    """Return all updates, one per line; CSV starts with a line of names."""
    rows = (_row(update) for update in updates)
    if kind is UpdatesFormat.JSON_LINES:
        return "".join(f"{json.dumps(row)}\n" for row in rows)
    text = StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: "" if value is None else str(value).lower() for name, value in row.items()} for row in rows)
    return text.getvalue()


def _row(update: FilterUpdate) -> dict[str, float | bool | None]:
    pose, covariance = update.base_in_map, update.covariance
    upper = (float(covariance[i, j]) for i, j in zip(*np.triu_indices(3), strict=True))
    verdict = (update.agreement, update.lost, update.p_wrong)
    values = (update.stamp_ns / 1e9, pose.x, pose.y, pose.theta, *upper, *verdict)
    return dict(zip(COLUMNS, values, strict=True))
