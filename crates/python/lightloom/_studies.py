"""Studies, shares of error and searches: the commands of the program, with tables in place of files."""

from __future__ import annotations

import csv
import html
import importlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _lightloom
from ._errors import Error
from ._files import Pipeline, ron
from ._types import Value
from ._renderer import table

Path = str | os.PathLike[str]


def command(*arguments: str) -> dict[str, Any]:
    """Runs a command of the program, and returns the JSON that it prints. What it says beside is printed as it comes.

    Ctrl-C ends the command as it does in a terminal: what a study has measured so far is kept.
    """
    root = _lightloom.root()
    words = [sys.executable, "-m", "lightloom", "--json", *(("--root", root) if root else ()), *arguments]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as said:
        child = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=said, encoding="utf-8", env=_environment()
        )
        try:
            output, _ = child.communicate()
        except KeyboardInterrupt:
            child.send_signal(signal.SIGINT)
            child.wait()
            raise
        said.seek(0)
        text = said.read()
    found = _objects(text)
    failed = next((part for part in found if part.get("errors")), None)
    if child.returncode != 0 and failed is not None:
        raise Error(failed["text"].removeprefix("error: "), json.dumps(failed["errors"]))
    # A study of which some cells failed has its results nevertheless.
    if not output.strip():
        raise Error(text.strip() or f"the command ended with {child.returncode}")
    result: dict[str, Any] = json.loads(output)
    return result


def _environment() -> dict[str, str]:
    """Lets a child find this package where it is."""
    folder = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    paths = [folder, *os.environ.get("PYTHONPATH", "").split(os.pathsep)]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)}


def _objects(text: str) -> list[dict[str, Any]]:
    """Returns the objects of JSON among lines of text."""
    found, at, decoder = [], 0, json.JSONDecoder()
    while (at := text.find("{", at)) >= 0:
        try:
            one, at = decoder.raw_decode(text, at)
        except ValueError:
            at += 1
        else:
            found.append(one)
    return found


def frame(path: Path) -> Any:
    """Returns a table of CSV: as a data frame of pandas where that is installed, else as a record array of NumPy."""
    try:
        return importlib.import_module("pandas").read_csv(path)
    except ImportError:
        pass
    with open(path, encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    columns = [_column([row[i] for row in rows]) for i in range(len(head))]
    table = np.empty(len(rows), [(name, column.dtype) for name, column in zip(head, columns)])
    for name, column in zip(head, columns):
        table[name] = column
    return table.view(np.recarray)


def _column(texts: list[str]) -> np.ndarray[Any, np.dtype[Any]]:
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts, dtype=str)


class _Done:
    """Something that a command has written into a folder."""

    folder: str
    """The folder."""
    data: dict[str, Any]
    """What the command prints as JSON."""

    def __init__(self, folder: Path, data: dict[str, Any]) -> None:
        self.folder, self.data = os.path.abspath(folder), data

    def __repr__(self) -> str:
        return f"<lightloom.{type(self).__name__} in {self.folder}>"


class _Reported(_Done):
    """Something with a page."""

    @property
    def page(self) -> str:
        """The path of the page `report.html`, which works without a server."""
        return os.path.join(self.folder, "report.html")

    def _link(self) -> str:
        return f'<p><a href="{html.escape(self.page)}">{html.escape(self.page)}</a></p>'


class Results(_Reported):
    """The results of a study."""

    @property
    def cells(self) -> Any:
        """A tidy table with a row for each cell, seed and measure: a data frame of pandas, or a record array without pandas."""
        return frame(os.path.join(self.folder, "cells.csv"))

    @property
    def summary(self) -> Any:
        """A row for each cell and measure: mean over seeds and half the width of its 95 % interval."""
        return frame(os.path.join(self.folder, "summary.csv"))

    @property
    def frames(self) -> Any:
        """A row for each frame, of scenes that move."""
        return frame(os.path.join(self.folder, "frames.csv"))

    def _repr_html_(self) -> str:
        with open(os.path.join(self.folder, "summary.csv"), encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file)
        return table(head, rows) + self._link()


class Study:
    """A study: pipelines, scenes, values and seeds against time and error."""

    def __init__(self, study: str | Path) -> None:
        self._study = os.fspath(study)

    def run(
        self,
        folder: Path,
        *,
        size: tuple[int, int] | None = None,
        scenes: Sequence[str] = (),
        seeds: int | None = None,
        frames: int | None = None,
        settings: dict[str, Value] | None = None,
        reference: dict[str, Value] | None = None,
        references: Path | None = None,
        options: Sequence[str] = (),
    ) -> Results:
        """Runs it into a folder, where a run that was interrupted goes on, and returns its results.

        Each argument replaces what the study says: size of frames in pixels, scenes, number of seeds, measured frames, values of all
        pipelines, values of the pipeline that renders references. `references` is a folder that studies share, and `options` are
        further words of `lightloom study`.
        """
        with tempfile.TemporaryDirectory() as scratch:
            study = self._study
            if "(" in study:
                study = os.path.join(scratch, "study.ron")
                with open(study, "w", encoding="utf-8") as file:
                    file.write(self._study)
            words = ["study", study, "-o", os.fspath(folder)]
            words += ["--size", f"{size[0]}x{size[1]}"] if size else []
            words += [word for scene in scenes for word in ("--scene", scene)]
            words += ["--seeds", str(seeds)] if seeds is not None else []
            words += ["--frames", str(frames)] if frames is not None else []
            words += _sets("--set", settings)
            words += _sets("--set-reference", reference)
            words += ["--references", os.fspath(references)] if references is not None else []
            return Results(folder, command(*words, *options))


def _sets(option: str, values: dict[str, Value] | None) -> list[str]:
    def text(value: Value) -> str:
        return value if isinstance(value, str) else ron(value)

    return [word for path, value in (values or {}).items() for word in (option, f"{path}={text(value)}")]


def study(study: str | Path) -> Study:
    """Returns a study, by its name, its file, or its text in RON."""
    return Study(study)


def report(folder: Path) -> Results:
    """Returns the results that a study has left in a folder, with tables and page written again."""
    return Results(folder, command("study", "report", os.fspath(folder)))


class _File:
    """A pipeline as a file, for another process: one that is only a text is written beside where it would be."""

    def __init__(self, pipeline: str | Pipeline) -> None:
        self._written: str | None = None
        self.name = pipeline if isinstance(pipeline, str) else pipeline.path
        if isinstance(pipeline, Pipeline) and not os.path.exists(pipeline.path):
            pipeline.save(pipeline.path)
            self._written = pipeline.path

    def __enter__(self) -> str:
        return self.name

    def __exit__(self, *_: object) -> None:
        if self._written is not None:
            os.remove(self._written)


class Blame(_Reported):
    """Which approximation owes how much of the error of a picture."""

    @property
    def shares(self) -> list[dict[str, Any]]:
        """What is approximated: its name, what is exact in its place, its passes, and its shares of error (relMSE), bias², variance and
        energy with the time that it saves [ms], each as a mean and half the width of its 95 % interval."""
        found: list[dict[str, Any]] = self.data["blame"]["shares"]["rows"]
        return found

    def _repr_html_(self) -> str:
        head = ("approximation", "passes", "relMSE", "bias²", "variance", "energy", "saves [ms]")
        keys = ("error", "bias_squared", "variance", "energy", "saves")
        rows = [(row["name"], ", ".join(row["passes"]), *(_interval(row[key]) for key in keys)) for row in self.shares]
        return table(head, rows) + self._link()


def _interval(of: dict[str, float | None] | None) -> str:
    """Returns a mean with half the width of its interval, as far as they are known."""
    if of is None:
        return ""
    return " ± ".join(f"{number:.3g}" for number in (of["mean"], of["half"]) if number is not None)


def blame(
    pipeline: str | Pipeline,
    scene: str,
    folder: Path = "out/blame",
    *,
    size: tuple[int, int] = (64, 48),
    seeds: int = 4,
    settings: dict[str, Value] | None = None,
    options: Sequence[str] = (),
) -> Blame:
    """Shares the error of a picture out between what its pipeline approximates: see `lightloom blame --help`."""
    with _File(pipeline) as name:
        words = ["blame", name, scene, "-o", os.fspath(folder), "--size", f"{size[0]}x{size[1]}"]
        return Blame(
            folder, command(*words, "--seeds", str(seeds), *_sets("--set", settings), *options)
        )


class Tuned(_Done):
    """The best settings that were found."""

    @property
    def winner(self) -> str:
        """The path of the variant, which is a pipeline like any other."""
        return os.path.join(self.folder, "winner.ron")

    @property
    def front(self) -> list[dict[str, Any]]:
        """The points that no other beats in both error and time."""
        found: list[dict[str, Any]] = self.data["tune"]["front"]
        return found

    def _repr_html_(self) -> str:
        names = list(self.front[0]["values"]) if self.front else []
        rows = [(*point["values"].values(), _interval({**point, "mean": point["error"]}), point["ms"]) for point in self.front]
        return table((*names, "error", "ms"), rows)


def tune(
    pipeline: str | Pipeline,
    scenes: str | Sequence[str],
    folder: Path = "out/tune",
    *,
    target_ms: float | None = None,
    target_error: float | None = None,
    options: Sequence[str] = (),
) -> Tuned:
    """Searches the settings of least error within a time of the device [ms], or of least time for an error (relMSE): see
    `lightloom tune --help`."""
    if (target_ms is None) == (target_error is None):
        raise Error("give one of target_ms and target_error")
    target = ["--target-ms", str(target_ms)] if target_ms is not None else ["--target-error", str(target_error)]
    scenes = [scenes] if isinstance(scenes, str) else list(scenes)
    with _File(pipeline) as name:
        return Tuned(folder, command("tune", name, *scenes, "-o", os.fspath(folder), *target, *options))
