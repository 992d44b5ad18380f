"""Updates of a localization as rows of text files.

A row has the pose, the pose's covariance, the agreement of map and scan, true if the robot was lost, and the
probability of a wrong pose.
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
    """File format of updates. The suffix of a file determines the format."""

    CSV = "csv"
    JSON_LINES = "jsonl"


def updates_text(updates: Iterable[FilterUpdate], kind: UpdatesFormat) -> str:
    """Return all updates, one per line. The first line of CSV has the names of the columns."""
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
