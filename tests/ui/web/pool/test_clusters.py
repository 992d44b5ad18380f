"""Clusters that cannot play games, and what the researcher reads about them."""

import asyncio
from pathlib import Path

import pytest

from thbridge.app.compose.machine import versions
from ui.web.pool.remote import unfit

pytest.importorskip("distributed")

from ui.web.pool import cluster
from ui.web.pool.cluster import ClusterUnfit, check_cluster


@pytest.mark.parametrize(
    ("scheduler", "reason"),
    [
        ("foo://127.0.0.1:9", "the address must begin with tcp:// or tls://"),
        ("tls://127.0.0.1:9", "this computer has no certificate of the cluster"),
        ("tcp://127.0.0.1:9", "No Dask scheduler answers at tcp://127.0.0.1:9 .* use a certificate of the same author"),
    ],
)
def test_a_cluster_that_cannot_be_used(
    scheduler: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 0.5)
    with pytest.raises(ClusterUnfit, match=reason):
        asyncio.run(check_cluster(scheduler, tmp_path))


def test_a_machine_with_other_versions_or_another_folder(tmp_path: Path) -> None:
    here = versions()
    probe = tmp_path / "probe"
    probe.touch()
    assert unfit(here, probe) == ""
    reason = unfit({**here, "numpy": "1.0"}, probe)
    assert reason.startswith(f"numpy is {here['numpy']} there, and 1.0 here")
    assert unfit({**here, "pyzero": "1"}, probe).startswith("pyzero is not installed there, and 1 here")
    assert "Share the folder under the same path" in unfit(here, tmp_path / "other")
