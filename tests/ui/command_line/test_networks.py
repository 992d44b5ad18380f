"""Nothing that other machines reach is opened without a word."""

from pathlib import Path

import pytest

from tests.support.programs.commands import invoke
from tests.support.programs.ports import free_port
from thbridge.files.keys.certificate import certificate_of
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.messages import types, unpack
from thbridge.study.study_file import read_study_text

KEY = "a key that nobody can guess"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    key = Path("key.txt")
    key.write_text(KEY)
    key.chmod(0o600)


def refusal(*arguments: str) -> str:
    done = invoke(*arguments)
    assert done.exit_code == 2, (done.output, done.exception)
    assert not [*Path().rglob("*.bag"), *Path().rglob("*.jsonl")]
    return done.stderr


@pytest.mark.parametrize(
    ("arguments", "door"),
    [
        (("server", "--host", "0.0.0.0"), "the text server"),
        (("play", "--headless", "--ros", "--ros-host", "10.0.0.1"), "ROS"),
        (("play", "--headless", "--mavlink", "--tcp", "0.0.0.0:5760"), "MAVLink by TCP"),
        (("play", "--headless", "--mavlink", "--udp-listen", "0.0.0.0:5760"), "MAVLink by UDP"),
        (("serve", "--host", "0.0.0.0"), "browsers"),
    ],
)
def test_a_door_to_other_machines_wants_their_networks_named(arguments: tuple[str, ...], door: str) -> None:
    told = refusal(*arguments)
    assert told.startswith(f"{door}: other machines could reach")
    assert "Add --open-to NETWORK" in told


@pytest.mark.parametrize("program", [("play", "--headless"), ("simr",)])
@pytest.mark.parametrize("key", [(), ("--watch-key", "key.txt")])
def test_researchers_windows_of_other_machines_want_keys_and_encryption(
    program: tuple[str, ...], key: tuple[str, ...]
) -> None:
    told = refusal(*program, "--watch", "0.0.0.0:0", "--open-to", "10.0.0.0/24", *key)
    assert told.startswith("researchers' windows: any client at 0.0.0.0 could see all data and command robots")
    assert "keys new NAME" in told


def test_a_folder_of_keys_that_is_none_or_empty_is_told() -> None:
    assert refusal("server", "--host", "0.0.0.0", "--keys", "keys").startswith("keys: there is no folder keys.")
    Path("keys").mkdir()
    Path("study.yaml").write_text("server: {host: 0.0.0.0}\nkeys: keys\n")
    assert refusal("play", "study.yaml", "--headless").startswith("keys: there are no keys in keys. Create a key: ")


def test_a_door_with_keys_is_encrypted_and_needs_no_network() -> None:
    invoke("keys", "new", "maria")
    Path("study.yaml").write_text("server: {host: 0.0.0.0}\nkeys: keys\n")
    arguments = ("--headless", "--rate", "0", "--max-seconds", "1", "--no-report", "--port", str(free_port()))
    done = invoke("play", "study.yaml", *arguments, "--watch", "0.0.0.0:0", "--bag", "a.bag")
    told = "These servers accept remote clients that present a key (TLS): the text server, researchers' windows."
    assert told in done.stderr
    assert "without" not in done.stderr


def test_networks_that_are_none_are_told() -> None:
    assert "--open-to: 'lab' is not a network" in refusal("server", "--open-to", "lab")
    assert "--open-to: 'lab' is not a network" in refusal("serve", "--open-to", "lab")
    assert "--proxy: 'lab' is not a network" in refusal("serve", "--proxy", "lab")
    Path("study.yaml").write_text("open_to: [10.0.0.0/24, 10.0.0.0/64]\n")
    assert "study.yaml, line 1, open_to[1]: '10.0.0.0/64' is not a network" in refusal("server", "study.yaml")


def test_certificates_for_browsers_that_do_not_fit_are_told() -> None:
    one, other = (certificate_of(Path(name), "2026-03-01T12:00:00+00:00").path for name in ("one", "other"))
    tls = ("serve", "--host", "0.0.0.0", "--open-to", "10.0.0.0/24", "--tls-cert", str(one))
    assert "--tls-cert and --tls-key belong together" in refusal(*tls)
    assert "this is not the private key of one/certificate.pem" in refusal(*tls, "--tls-key", str(other))
    assert "missing.pem: it cannot be read" in refusal(*tls, "--tls-key", "missing.pem")
    assert "are not usable" in refusal(*tls, "--tls-key", "key.txt")
    one.chmod(0o644)
    assert "run: chmod 600" in refusal(*tls, "--tls-key", str(one)).replace("Run", "run")


def test_who_is_let_in_is_told_and_recorded() -> None:
    arguments = ("--headless", "--rate", "0", "--max-seconds", "1", "--no-report", "--port", str(free_port()))
    Path("study.yaml").write_text("server: {host: 0.0.0.0}\n")
    done = invoke("play", "study.yaml", *arguments, "--open-to", "10.0.0.0/24", "--bag", "a.bag")
    told = "These servers accept clients from 10.0.0.0/24 without a key and without encryption: the text server."
    assert told in done.stderr
    (session,) = (data for publisher, _, data in recorded(Path("a.bag")) if publisher.msgtype == types.SESSION)
    assert read_study_text(Path("a.bag"), unpack.session(session).study).open_to == ("10.0.0.0/24",)
