"""The script installs by name all that tests against others' programs need."""

from pathlib import Path

import pytest

from tests.support.ros.type_lists import STANDARD_TYPES

SCRIPT = (Path(__file__).parents[2] / "scripts/install_peers.sh").read_text()


@pytest.mark.parametrize("package", sorted({msgtype.partition("/")[0] for msgtype in STANDARD_TYPES}))
def test_messages_of_our_bags_are_installed(package: str) -> None:
    assert package.replace("_", "-") in SCRIPT.split("for messages in ")[1].split("; do")[0].split()
