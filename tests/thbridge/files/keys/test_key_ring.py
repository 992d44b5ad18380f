import json
import stat
from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import ClientKey, read_key
from thbridge.files.keys.key_ring import RING, KeyEntry, KeyRing, Right

NOW = "2026-03-01T12:00:00Z"
LATER = "2026-03-03T12:00:00Z"


@pytest.fixture
def ring(tmp_path: Path) -> KeyRing:
    return KeyRing(tmp_path / "keys", lambda: NOW)


def test_whoever_has_a_key_is_known_by_it_and_nobody_else(ring: KeyRing) -> None:
    ring.add("maria", [Right.WATCH], "secret of maria", None)
    path = ring.add("jo", [Right.INTERVENE], "secret of jo", None)
    certificate = certificate_of(ring.folder, NOW)
    assert path.read_text() == f"secret of jo\nsha256:{certificate.fingerprint}\n"
    assert read_key(path) == ClientKey("secret of jo", certificate.fingerprint)
    found = ring.holder("secret of jo")
    assert isinstance(found, KeyEntry)
    assert (found.name, found.rights) == ("jo", (Right.INTERVENE,))
    assert ring.holder("secret") == "the key is wrong"
    assert ring.holder("\ud800") == "the key is wrong"


def test_secrets_are_not_in_the_ring_and_its_files_are_their_owners_alone(ring: KeyRing) -> None:
    path = ring.add("maria", [Right.WATCH], "secret of maria", None)
    assert "secret of maria" not in (ring.folder / RING).read_text()
    assert {stat.S_IMODE(each.stat().st_mode) for each in (path, ring.folder / RING)} == {0o600}
    assert stat.S_IMODE(ring.folder.stat().st_mode) == 0o700
    (ring.folder / RING).chmod(0o644)
    with pytest.raises(BadFile, match="chmod 600"):
        KeyRing(ring.folder, lambda: NOW)


def test_a_key_that_is_revoked_or_has_expired_is_good_for_nothing_at_once(ring: KeyRing) -> None:
    ring.add("maria", [Right.WATCH], "secret of maria", None)
    ring.add("jo", [Right.WATCH], "secret of jo", "2026-03-02T12:00:00Z")
    other = KeyRing(ring.folder, lambda: LATER)
    assert other.holder("secret of jo") == "the key jo has expired"
    other.revoke("maria")
    assert ring.holder("secret of maria") == "the key maria was revoked"
    assert ring.why_not("maria") == "the key maria was revoked"
    assert ring.why_not("jo") is None


def test_a_name_is_used_once(ring: KeyRing) -> None:
    ring.add("maria", [Right.WATCH], "one secret", None)
    ring.revoke("maria")
    with pytest.raises(BadFile, match="a key maria already exists"):
        ring.add("maria", [Right.WATCH], "another secret", None)
    with pytest.raises(BadFile, match="Name one of these: maria"):
        ring.revoke("jo")


@pytest.mark.parametrize("name", ["", "Maria", "../x", "a b", "a" * 33, "\u00e4"])
def test_a_name_that_is_none(ring: KeyRing, name: str) -> None:
    with pytest.raises(BadFile, match="is not a valid name of a key"):
        ring.add(name, [Right.WATCH], "one secret", None)
    assert not ring.folder.exists()


@pytest.mark.parametrize("damage", ["{", "[1]", "[" * 5000, '[{"name": "x"}]', '[{"name": "\udcff"}]', "\x00"])
def test_a_ring_that_is_damaged_is_told(ring: KeyRing, damage: str) -> None:
    ring.add("maria", [Right.WATCH], "one secret", None)
    (ring.folder / RING).write_text(damage, errors="surrogateescape")
    with pytest.raises(BadFile, match="not a ring of keys"):
        KeyRing(ring.folder, lambda: NOW)


def test_keys_of_a_ring_are_what_its_file_says(ring: KeyRing) -> None:
    ring.add("maria", [Right.WATCH, Right.INTERVENE], "one secret", LATER)
    (entry,) = json.loads((ring.folder / RING).read_text())
    assert (entry["name"], entry["rights"], entry["created"], entry["expires"]) == (
        "maria",
        ["watch", "intervene"],
        NOW,
        LATER,
    )
