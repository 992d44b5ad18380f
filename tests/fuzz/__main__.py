"""Fuzzing of all parsers of files: `make fuzz ARGS="--count 10000 --seed 2 --target bag"`."""

import argparse
import sys
import warnings
from pathlib import Path
from tempfile import mkdtemp

from tests.fuzz.cases import fuzz
from tests.fuzz.targets import TARGETS


def main() -> None:
    """Fuzz, and tell what was found; files that parsers do not refuse well are kept."""
    told = argparse.ArgumentParser(description=__doc__)
    told.add_argument("--count", type=int, default=2000, help="files for each target")
    told.add_argument("--seed", type=int, default=2, help="of the mistakes; the default tests have 1")
    told.add_argument("--target", choices=TARGETS, action="append", help="one parser; by default all")
    args = told.parse_args()
    warnings.simplefilter("ignore")
    found = 0
    for name in args.target or TARGETS:
        print(f"{name}: {args.count} files", flush=True)
        for fault in fuzz(name, Path(mkdtemp(prefix=f"fuzz-{name}-")), args.seed, args.count):
            found += 1
            print(f"  {fault}", flush=True)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
