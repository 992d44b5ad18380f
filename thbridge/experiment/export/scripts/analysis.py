"""Compare the conditions of this export and draw them: `python analysis.py` (pandas, pyarrow, scipy, matplotlib).

Write results/cells.csv (mean of each condition with a 95 % interval), results/tests.csv and a figure of each outcome.
Within people: paired t tests on complete people, with d = mean difference / its standard deviation, and the F of
aov(value ~ factor + Error(participant / factor)) for more than two levels. Between people: Welch's t tests on people's
means, with d by the pooled standard deviation. Interactions: Welch's t tests on differences within people. p_holm is
adjusted for all pairs of levels of one factor. `analysis.R` does the same in R.
"""

from itertools import combinations, product
from pathlib import Path

try:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    import pandas as pd
    import pyarrow  # noqa: F401 - pandas reads the tables with it
    from scipy import stats
except ImportError as missing:
    raise SystemExit(f"{missing.name} is missing. Run: pip install pandas pyarrow scipy matplotlib") from None

HERE = Path(__file__).parent
OUTCOMES = {
    "trials": ["score", "rooms_visited"],
    "reliance": ["appropriate"],
    "fluency": ["human_idle", "concurrent_activity"],
}
"""Columns that the script compares in addition to all scores of forms. Add your own columns."""

dictionary = pd.read_csv(HERE / "dictionary.csv", keep_default_na=False)
# In CSV files of the export, texts that look like formulas of a spreadsheet begin with an apostrophe. Remove it.
dictionary = dictionary.replace(r"^'('*[=+\-@\t\r])", r"\1", regex=True)


def table(name: str) -> pd.DataFrame:
    """Return the valid rows of a table. Columns have their types: factors, numbers, booleans, times."""
    read = pd.read_parquet(HERE / "tables" / f"{name}.parquet")
    for column in dictionary[dictionary.table == name].itertuples():
        if column.factor:
            read[column.column] = pd.Categorical(read[column.column], column.levels.split("; "))
        elif column.type == "time":
            read[column.column] = pd.to_datetime(read[column.column], utc=True, format="ISO8601")
        elif column.type == "bool":
            read[column.column] = read[column.column].astype("boolean")
    return read[read.counts]


def factors(name: str, role: str) -> list[str]:
    """Return the factors of a table."""
    rows = dictionary[(dictionary.table == name) & (dictionary.factor == role)]
    return [factor for factor, levels in zip(rows.column, rows.levels, strict=True) if "; " in levels]


def outcomes() -> dict[str, pd.DataFrame]:
    """Return the values of each outcome: one row for each person and condition, with a column `value`."""
    found = {}
    if "scores" in set(dictionary.table):
        for subscale, rows in table("scores").groupby("subscale"):
            found[str(subscale)] = rows.rename(columns={"score": "value"})
    for name, columns in OUTCOMES.items():
        for column in columns if name in set(dictionary.table) else ():
            rows = table(name)
            found[f"{name}.{column}"] = rows.assign(value=rows[column].astype(float))
    return {name: rows.dropna(subset=["value"]) for name, rows in found.items()}


def complete(rows: pd.DataFrame, within: list[str]) -> pd.DataFrame:
    """Return the rows of people with a value in each condition, one row for each person and condition."""
    between_ = factors("scores" if "subscale" in rows else "trials", "between")
    rows = rows.groupby(["participant", *between_, *within], observed=True)["value"].mean().reset_index()
    wanted = np.prod([len(rows[factor].cat.categories) for factor in within], dtype=int)
    return rows[rows.groupby("participant")["value"].transform("size") == wanted]


def cells(name: str, rows: pd.DataFrame, within: list[str], between: list[str]) -> list[dict[str, object]]:
    """Return the mean and 95 % interval of each condition.

    Intervals within people exclude differences between people (Cousineau and Morey).
    """
    conditions = max(1, rows.groupby("participant").size().max())
    group = rows.groupby(between, observed=True)["value"] if between else rows.assign(all=0).groupby("all")["value"]
    person = rows.groupby("participant")["value"].transform("mean")
    spread = rows.value - person + group.transform("mean") if conditions > 1 else rows.value
    results = []
    for key, values in rows.groupby([*between, *within], observed=True) if between + within else [((), rows)]:
        n, mean = len(values), values.value.mean()
        deviation = spread[values.index].std() * np.sqrt(conditions / (conditions - 1) if conditions > 1 else 1.0)
        half = stats.t.ppf(0.975, n - 1) * deviation / np.sqrt(n) if n > 1 else np.nan
        results.append(
            {"outcome": name, "cell": "; ".join(key), "n": n, "mean": mean, "sd": values.value.std()}
            | {"low": mean - half, "high": mean + half}
        )
    return results


def row(name: str, test: str, comparison: str, n: int, **results: float) -> dict[str, object]:
    """Return one row of the table `tests`."""
    empty = dict.fromkeys(("estimate", "low", "high", "statistic", "df", "df2", "p", "effect_size"), np.nan)
    return {"outcome": name, "test": test, "comparison": comparison, "n": n, **empty, **results}


def paired(name: str, comparison: str, difference: pd.Series) -> dict[str, object]:
    """Return the paired t test of differences within people."""
    n, mean, deviation = len(difference), difference.mean(), difference.std()
    error = deviation / np.sqrt(n)
    half, t = stats.t.ppf(0.975, n - 1) * error, mean / error if error > 0 else np.nan
    p = 2 * stats.t.sf(abs(t), n - 1)
    effect = mean / deviation if deviation > 0 else np.nan
    results = {"estimate": mean, "low": mean - half, "high": mean + half, "statistic": t, "df": n - 1}
    return row(name, "paired t", comparison, n, **results, p=p, effect_size=effect)


def welch(name: str, test: str, comparison: str, one: pd.Series, other: pd.Series) -> dict[str, object]:
    """Return Welch's t test of two groups of people."""
    result = stats.ttest_ind(other, one, equal_var=False)
    interval, n = result.confidence_interval(0.95), len(one) + len(other)
    pooled = np.sqrt(((len(one) - 1) * one.var() + (len(other) - 1) * other.var()) / (n - 2))
    mean = other.mean() - one.mean()
    results = {"estimate": mean, "low": interval.low, "high": interval.high, "statistic": result.statistic}
    return row(name, test, comparison, n, **results, df=result.df, p=result.pvalue, effect_size=mean / pooled)


def holm(tests: list[dict[str, object]]) -> list[dict[str, object]]:
    """Adjust the p values of a family of tests (Holm 1979). Ignore tests without a p value."""
    order = sorted((test for test in tests if test["p"] == test["p"]), key=lambda test: test["p"])
    adjusted = np.maximum.accumulate([(len(order) - rank) * test["p"] for rank, test in enumerate(order)])
    for test in tests:
        test["p_holm"] = np.nan
    for test, p in zip(order, adjusted, strict=True):
        test["p_holm"] = min(1.0, p)
    return tests


def within_tests(name: str, rows: pd.DataFrame, factor: str) -> list[dict[str, object]]:
    """Return the tests of a factor within people."""
    wide = rows.pivot_table(index="participant", columns=factor, values="value", observed=True)
    n, k = wide.shape
    results = holm([paired(name, f"{factor}: {b} - {a}", wide[b] - wide[a]) for a, b in combinations(wide.columns, 2)])
    if k > 2:
        off = wide.sub(wide.mean(axis=1), axis=0).sub(wide.mean(axis=0) - wide.to_numpy().mean(), axis=1)
        between_levels = n * ((wide.mean(axis=0) - wide.to_numpy().mean()) ** 2).sum() / (k - 1)
        df2 = (n - 1) * (k - 1)
        f = between_levels / ((off.to_numpy() ** 2).sum() / df2)
        results.insert(0, row(name, "F within", factor, n, statistic=f, df=k - 1, df2=df2, p=stats.f.sf(f, k - 1, df2)))
    return results


def between_tests(name: str, rows: pd.DataFrame, factor: str) -> list[dict[str, object]]:
    """Return the tests of a factor between people."""
    people = rows.groupby(["participant", factor], observed=True)["value"].mean().reset_index()
    groups = {level: group["value"] for level, group in people.groupby(factor, observed=True) if len(group) > 1}
    pairs = combinations(groups, 2)
    results = holm([welch(name, "Welch t", f"{factor}: {b} - {a}", groups[a], groups[b]) for a, b in pairs])
    if len(groups) > 2:
        n, k = sum(map(len, groups.values())), len(groups)
        f, p = stats.f_oneway(*groups.values())
        results.insert(0, row(name, "F between", factor, n, statistic=f, df=k - 1, df2=n - k, p=p))
    return results


def interactions(name: str, rows: pd.DataFrame, inside: str, outside: str) -> list[dict[str, object]]:
    """Return tests of whether differences within people depend on the group."""
    wide = rows.pivot_table(index=["participant", outside], columns=inside, values="value", observed=True)
    results = []
    for a, b in combinations(wide.columns, 2):
        difference = (wide[b] - wide[a]).groupby(outside, observed=True)
        groups = {level: group for level, group in difference if len(group) > 1}
        for one, other in combinations(groups, 2):
            what = f"({inside}: {b} - {a}) x ({outside}: {other} - {one})"
            results.append(welch(name, "interaction t", what, groups[one], groups[other]))
    return holm(results)


def draw(name: str, rows: pd.DataFrame, within: list[str], results: list[dict[str, object]]) -> None:
    """Draw an outcome: the values of each person, and means with 95 % intervals."""
    figure, axes = plt.subplots(figsize=(1.8 + 1.2 * len(results), 3.4), layout="constrained")
    levels = [factor for factor in rows.columns if factor not in {"participant", "value"}]
    place = {cell["cell"]: index for index, cell in enumerate(results)}
    at = rows[levels].astype(str).agg("; ".join, axis=1).map(place) if levels else pd.Series(0, rows.index)
    for _, own in rows.assign(at=at).groupby("participant"):
        axes.plot(own.sort_values("at")["at"], own.sort_values("at").value, color="0.8", lw=0.7, marker=".", ms=3)
    means = [cell["mean"] for cell in results]
    errors = np.nan_to_num([cell["high"] - cell["mean"] for cell in results])
    axes.errorbar(range(len(results)), means, yerr=errors, fmt="o", color="black", capsize=4, zorder=3)
    axes.set_xticks(range(len(results)), [cell["cell"] or "all" for cell in results], rotation=20, ha="right")
    axes.set_xlim(-0.5, len(results) - 0.5)
    axes.set_ylabel(f"{name} (mean, 95 %)")
    figure.savefig(HERE / "results" / f"{name}-python.png", dpi=150)
    plt.close(figure)


def main() -> None:
    """Compare and draw all outcomes."""
    (HERE / "results").mkdir(exist_ok=True)
    means, tests = [], []
    for name, values in outcomes().items():
        source = "scores" if "subscale" in values else name.partition(".")[0]
        within = [factor for factor in factors(source, "within") if values[factor].notna().all()]
        between = factors(source, "between")
        rows = complete(values, within)
        if rows.empty:
            continue
        results = cells(name, rows, within, between)
        draw(name, rows, within, results)
        means += results
        if rows.value.nunique() < 2:
            continue  # All values are equal, so a comparison is not possible.
        for factor in within:
            tests += within_tests(name, rows, factor)
        for factor in between:
            tests += between_tests(name, rows, factor)
        for inside, outside in product(within, between):
            tests += interactions(name, rows, inside, outside)
    for file, lines in (("cells", means), ("tests", tests)):
        path = HERE / "results" / f"{file}-python.csv"
        if not lines:
            path.unlink(missing_ok=True)
            print(f"\n{file}: none, because no participant has data in all conditions, or all values are equal.")
            continue
        frame = pd.DataFrame(lines)
        frame.to_csv(path, index=False, float_format="%.6g")
        print(f"\n{file}\n{frame.round(4).to_string(index=False)}")


if __name__ == "__main__":
    main()
