"""Reads this export with pandas and draws the scores of each condition: `python analysis.py`."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import pandas as pd

HERE = Path(__file__).parent


def table(name: str) -> pd.DataFrame:
    """The table of this name; runs that do not count are left out."""
    read = pd.read_parquet(HERE / "tables" / f"{name}.parquet")
    return read[read.run_counts] if "run_counts" in read else read


scores = table("scores")
factors = list(scores.columns[2 : list(scores.columns).index("step")])
for subscale, rows in scores.groupby("subscale"):
    by = [factor for factor in factors if rows[factor].notna().all()]
    groups = rows.groupby(by)["score"] if by else rows.groupby("subscale")["score"]
    told = groups.agg(["count", "mean", "std", "sem"])
    print(f"\n{subscale}\n{told.round(2)}")
    figure, axes = plt.subplots(figsize=(1.5 + 1.2 * len(told), 3), layout="constrained")
    axes.errorbar(range(len(told)), told["mean"], yerr=1.96 * told["sem"], fmt="o", capsize=4)
    labels = [" ".join(map(str, key if isinstance(key, tuple) else (key,))) for key in told.index]
    axes.set_xticks(range(len(told)), labels, rotation=20, ha="right")
    axes.set_ylabel(f"{subscale} (mean, 95 %)")
    figure.savefig(HERE / f"{subscale}.png", dpi=150)
