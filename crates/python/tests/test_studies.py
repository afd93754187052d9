"""Studies, blame and tune."""

from __future__ import annotations

import pathlib

import lightloom
import numpy as np
import pytest

STUDY = """Study(
    about: "Few lights and more",
    scenes: ["cornell-box"], size: (16, 12), budget: Frames(1), seeds: 2,
    pipelines: [
        Variant(name: "few", pipeline: "ism", set: { "lights": 4 }),
        Variant(name: "more", pipeline: "ism", set: { "lights": 64 }),
    ],
    output: "indirect", set: { "rsm.size": 64, "map": 16 }, measures: ["rel-mse", "gpu-ms"],
    reference: Pipeline(pipeline: "reference", set: { "samples": 32 }),
)"""


def test_a_study_is_a_table(folder: pathlib.Path) -> None:
    results = lightloom.study(STUDY).run("out")
    cells = results.cells
    names = set(cells.dtype.names) if isinstance(cells, np.ndarray) else set(cells.columns)
    assert {"scene", "pipeline", "seed", "measure", "value"} <= names
    error = [row for row in zip(cells["pipeline"], cells["measure"], cells["value"]) if row[1] == "rel-mse"]
    assert len(error) == 4 and all(value > 0 for *_, value in error)
    assert (folder / "out/report.html").is_file() and results.page == str(folder / "out/report.html")
    assert "<table>" in results._repr_html_() and "few" in results._repr_html_()
    again = lightloom.report("out")
    assert len(again.cells) == len(cells)
    smaller = lightloom.study(STUDY).run("smaller", seeds=1, size=(8, 8), reference={"samples": 16})
    assert len(smaller.cells) < len(cells)


def test_a_wrong_study_has_places() -> None:
    with pytest.raises(lightloom.Error) as caught:
        lightloom.study('Study(\n    scenes: ["cornell-box"], size: 3)').run("out")
    assert {error["line"] for error in caught.value.errors} == {1, 2} and "^" in str(caught.value)
    with pytest.raises(lightloom.Error, match="there is no study"):
        lightloom.study("no-such-study").run("out")


def test_error_is_shared_out(folder: pathlib.Path) -> None:
    few = lightloom.Pipeline('Pipeline(extends: "ism-invtm.ron", patch: [Set("lights", 8), Set("map", 16), Set("rsm.size", 64)])')
    blamed = lightloom.blame(few, "cornell-box", "out", size=(16, 12), seeds=3, options=["--samples", "16"])
    assert {row["name"] for row in blamed.shares} >= {"one frame", "interleaving"}
    assert "interleaving" in blamed._repr_html_() and (folder / "out/report.html").is_file()
    # The text was a file only while the command ran.
    assert [path.name for path in folder.iterdir()] == ["out"]


def test_settings_are_searched() -> None:
    tuned = lightloom.tune(
        "ism-invtm", "cornell-box", "out", target_error=0.9, options=["--points", "2", "--vary", "lights=8,16", "--size", "16x12"]
    )
    assert pathlib.Path(tuned.winner).is_file() and tuned.front and "lights" in tuned._repr_html_()
    lightloom.Renderer("cornell-box", tuned.winner, (16, 12)).frame()
    with pytest.raises(lightloom.Error, match="one of target_ms and target_error"):
        lightloom.tune("ism-invtm", "cornell-box")
