"""Fuzzing of all parsers of what comes from outside.

    make fuzz ARGS="--count 10000 --seed 2 --target bag"
    make fuzz ARGS="--total 10000000 --folder /var/tmp/fuzz"     # goes on where it was ended, with the same folder

The first number of cases is for each target; the second is shared out to all of them, most to those with quick
parsers: ten million take some hours of one core.
"""

import argparse
import json
import logging
import shutil
import sys
import time
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp

from tests.fuzz.cases import ALL, fuzz

BATCH = 2000
"""Cases between two looks at the clock."""
PERIOD = 30.0
"""Seconds between two lines that tell how far it has come."""


def shares(total: int, names: Sequence[str]) -> dict[str, int]:
    """Share cases out to targets, by the squares of their numbers in the default tests: quick ones have most."""
    whole = sum(ALL[name].quick ** 2 for name in names)
    return {name: -(-total * ALL[name].quick ** 2 // whole) for name in names}


def done_before(folder: Path, seed: int) -> dict[str, int]:
    """Numbers of cases that were read with this seed before; none where the folder is new."""
    with suppress(FileNotFoundError):
        read = json.loads((folder / f"done-{seed}.json").read_text())
        return {str(name): int(number) for name, number in read.items()}
    return {}


def run(counts: dict[str, int], seed: int, folder: Path) -> int:
    """Read what is left of these cases; return the number of faults."""
    done = done_before(folder, seed)
    found = 0
    for name, count in counts.items():
        first = done.get(name, 0)
        print(f"{name}: {count} cases" + (f", of which {first} are done" if first else ""), flush=True)
        begun, told = time.monotonic(), time.monotonic()
        for number in range(first, count, BATCH):
            work = Path(mkdtemp(prefix=f"{name}-", dir=folder))
            for fault in fuzz(name, work, seed, min(BATCH, count - number), number):
                found += 1
                print(f"  {fault}", flush=True)
            done[name] = min(number + BATCH, count)
            _keep(done, folder / f"done-{seed}.json")
            _clean(work)
            if time.monotonic() - told > PERIOD:
                told = time.monotonic()
                print(f"  {done[name]} of {count}, {(done[name] - first) / (told - begun):.0f} a second", flush=True)
    return found


def _keep(done: dict[str, int], file: Path) -> None:
    part = file.with_suffix(".part")
    part.write_text(json.dumps(done))
    part.replace(file)


def _clean(work: Path) -> None:
    """Remove what cases were made of; files that parsers did not refuse well stay."""
    for part in (work / "whole", work / "case"):
        shutil.rmtree(part, ignore_errors=True)
    with suppress(OSError):
        work.rmdir()


def main() -> None:
    """Fuzz, and tell what was found; files that parsers do not refuse well are kept."""
    told = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    told.add_argument("--count", type=int, default=2000, help="cases for each target")
    told.add_argument("--total", type=int, help="cases for all targets together")
    told.add_argument("--seed", type=int, default=2, help="of the mistakes; the default tests have 1")
    told.add_argument("--target", choices=ALL, action="append", help="one parser; by default all")
    told.add_argument("--folder", type=Path, help="of faults, and of how far it has come; by default a new one")
    args = told.parse_args()
    warnings.simplefilter("ignore")
    logging.disable()
    folder = args.folder or Path(mkdtemp(prefix="fuzz-"))
    folder.mkdir(parents=True, exist_ok=True)
    names = args.target or list(ALL)
    counts = dict.fromkeys(names, args.count) if args.total is None else shares(args.total, names)
    found = run(counts, args.seed, folder)
    print(f"{found} faults, kept in {folder}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
