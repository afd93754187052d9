"""What tests share."""

from __future__ import annotations

import pathlib

import lightloom
import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skips what needs a device where there is none."""
    if not lightloom.adapters():
        for item in items:
            if "without_a_device" not in item.name:
                item.add_marker(pytest.mark.skip(reason="there is no adapter"))


@pytest.fixture(autouse=True)
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A working folder that is outside of any tree."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
