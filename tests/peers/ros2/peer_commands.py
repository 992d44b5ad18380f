"""Commands and events of a peer, as lines of JSON."""

import json
import os
import sys
from collections.abc import Callable


def tell(event: str, **fields: object) -> None:
    print(json.dumps({"event": event, **fields}), flush=True)


def obey(do: Callable[[dict], object]) -> None:
    """Obey commands until there are no more. Then end at once, because libraries wait for threads that do not end."""
    tell("ready")
    for line in sys.stdin:
        do(json.loads(line))
    os._exit(0)
