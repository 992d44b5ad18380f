import pytest

from ui.windows.display import why_no_window


@pytest.fixture
def environment(monkeypatch):
    for key in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(key, raising=False)
    return monkeypatch


def test_without_a_display_there_is_no_window(environment):
    assert "DISPLAY" in (why_no_window() or "")


@pytest.mark.parametrize("key", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_with_a_display_there_is_one(environment, key):
    environment.setenv(key, ":0")
    assert why_no_window() is None


def test_a_platform_that_shows_nothing_is_no_display(environment):
    environment.setenv("DISPLAY", ":0")
    environment.setenv("QT_QPA_PLATFORM", "offscreen")
    assert "offscreen" in (why_no_window() or "")


def test_a_platform_without_x_is_a_display(environment):
    environment.setenv("QT_QPA_PLATFORM", "vnc:size=800x600")
    assert why_no_window() is None
