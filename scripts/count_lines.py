"""Count the product's lines for each feature; `make size`."""

from collections import Counter
from pathlib import Path

PACKAGES = ("sim", "thbridge", "ui")
ROOT = Path(__file__).parents[1]


def feature_of(file: Path) -> str:
    """Return the feature of a module: the folder or module directly below its package."""
    package, *below = file.with_suffix("").parts
    return package if below == ["__init__"] else f"{package}/{below[0]}"


def lines_by_feature(root: Path) -> dict[str, tuple[int, int]]:
    """Return the numbers of modules and of non-blank lines by feature; each package's largest feature is first."""
    modules: Counter[str] = Counter()
    lines: Counter[str] = Counter()
    for package in PACKAGES:
        for file in (root / package).rglob("*.py"):
            feature = feature_of(file.relative_to(root))
            modules[feature] += 1
            lines[feature] += sum(not line.isspace() for line in file.read_text(encoding="utf-8").splitlines(True))
    features = sorted(modules, key=lambda feature: (feature.split("/")[0], -lines[feature], feature))
    return {feature: (modules[feature], lines[feature]) for feature in features}


def main() -> None:
    """Print the table."""
    sizes = lines_by_feature(ROOT)
    for feature, (modules, lines) in sizes.items():
        print(f"{feature:28}{modules:6}{lines:8}")
    print(f"{'all':28}{sum(modules for modules, _ in sizes.values()):6}{sum(lines for _, lines in sizes.values()):8}")


if __name__ == "__main__":
    main()
