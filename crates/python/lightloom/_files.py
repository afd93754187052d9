"""Pipelines, shaders and scenes, and what a cell of a notebook says in place of a file."""

from __future__ import annotations

import itertools
import json
import operator
import os
from typing import Any

from . import _lightloom
from ._errors import Error
from ._types import Drawn, Value

_numbers = itertools.count(1)

MOST = 16384
"""The most pixels of a side of a frame."""

laid: list[str] = []
"""The paths that texts were laid over, in order: renderers load those again that are theirs and new."""


def _lay_over(name: str | os.PathLike[str] | None, stem: str, ending: str, text: str) -> str:
    """Lays a text over a file of the working folder, and returns its path."""
    name = os.fspath(name) if name is not None else f"{stem}-{next(_numbers)}{ending}"
    if not name.endswith(ending):
        raise Error(f"the name `{name}` must end in `{ending}`")
    path = os.path.abspath(name)
    _lightloom.lay_over(path, text)
    laid.append(path)
    return path


class Shader:
    """A WGSL text that passes use as if it were a file; in a format string it is the name of that file."""

    path: str
    """The path of the file that it stands for; nothing is written there."""

    def __init__(self, text: str, name: str | os.PathLike[str] | None = None) -> None:
        self.text = text
        self.path = _lay_over(name, "shader", ".wgsl", text)

    def __str__(self) -> str:
        return os.path.basename(self.path)

    def __repr__(self) -> str:
        return f"<lightloom.Shader {self}>"


def wgsl(text: str, name: str | os.PathLike[str] | None = None) -> Shader:
    """Takes a WGSL text as a file beside the pipelines of the same folder.

    Where it is given again under the same name, renderers load it again at their next frame; if it does not compile, that frame
    raises an `Error`, and the last good shader stays.

    >>> import lightloom
    >>> halve = lightloom.wgsl('''
    ... @group(0) @binding(0) var input: texture_2d<f32>;
    ... @fragment fn main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    ...     return 0.5 * textureLoad(input, vec2<u32>(at.xy), 0);
    ... }
    ... ''', name="halve.wgsl")
    >>> f"{halve}"
    'halve.wgsl'
    """
    return Shader(text, name)


class Plan:
    """A compiled pipeline: the order of its passes, sizes, memory, and the reason for each pass. A notebook draws it."""

    def __init__(self, drawn: Drawn) -> None:
        self._text, self._json, self._svg, self._dot, self._warnings = drawn

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What is no error and perhaps not meant."""
        found: list[dict[str, Any]] = json.loads(self._warnings)
        return found

    @property
    def data(self) -> dict[str, Any]:
        """The plan as `lightloom graph --json` prints it."""
        found: dict[str, Any] = json.loads(self._json)
        return found

    def svg(self) -> str:
        """Returns a drawing."""
        return self._svg

    def dot(self) -> str:
        """Returns the graph for Graphviz."""
        return self._dot

    def __str__(self) -> str:
        return self._text

    def _repr_svg_(self) -> str:
        return self._svg


class Pipeline:
    """A pipeline: the text of a RON file, or the name of one.

    >>> import lightloom
    >>> few = lightloom.Pipeline('Pipeline(extends: "ism-invtm.ron", patch: [Set("lights", 64)])', name="few.ron")
    >>> print(lightloom.diff("ism-invtm", few))
    ~ parameter lights: 1024 → 64
    ~ setting lights.count: 1024 → 64
    """

    path: str
    """The path of the file that it stands for, or the name of a pipeline; nothing is written there."""

    def __init__(self, text: str, name: str | os.PathLike[str] | None = None) -> None:
        self.text = text
        self.path = _lay_over(name, "pipeline", ".ron", text)

    def patch(
        self, *patches: str, name: str | os.PathLike[str] | None = None, **settings: Value
    ) -> Pipeline:
        """Returns a pipeline that extends this one by patches in RON, such as `Remove("filter")`, and by values.

        >>> import lightloom
        >>> ism = lightloom.Pipeline('Pipeline(extends: "ism.ron")')
        >>> ism.patch(lights=64, **{"gather.clamp": 0.05}).check()
        """
        return _patched(os.path.basename(self.path), patches, settings, name)

    def resolve(self, **settings: Value) -> str:
        """Returns it as one file without inheritance, in RON."""
        return _lightloom.resolve(self.path, list(settings.items()), False)

    def plan(
        self, scene: str = "cornell-box", size: tuple[int, int] = (512, 512), **settings: Value
    ) -> Plan:
        """Compiles it for a scene and a size in pixels; no device is opened."""
        return Plan(_lightloom.plan(self.path, scene, checked(size), list(settings.items())))

    def check(self, scene: str = "cornell-box") -> None:
        """Raises an `Error` where it or one of its shaders is wrong; no device is opened."""
        self.plan(scene)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes its text into a file."""
        folder, name = os.path.split(os.path.abspath(path))
        part = os.path.join(folder, f".{name}.part")
        with open(part, "w", encoding="utf-8") as file:
            file.write(self.text)
        os.replace(part, path)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<lightloom.Pipeline {os.path.basename(self.path)}>"


def _patched(
    base: str,
    patches: tuple[str, ...],
    settings: dict[str, Value],
    name: str | os.PathLike[str] | None,
) -> Pipeline:
    sets = [f"Set({json.dumps(path)}, {ron(value)})" for path, value in settings.items()]
    lines = "".join(f"    {patch},\n" for patch in [*patches, *sets])
    return Pipeline(f"Pipeline(extends: {json.dumps(base)}, patch: [\n{lines}])\n", name)


def ron(value: Value) -> str:
    """Returns a value as RON writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (int, float)) or hasattr(value, "item"):
        return repr(value.item() if hasattr(value, "item") else value)
    return f"({', '.join(ron(float(part)) for part in value)})"


def checked(size: tuple[int, int]) -> tuple[int, int]:
    """Returns the size of a frame; raises an `Error` where it is none."""
    try:
        width, height = (operator.index(side) for side in size)
    except (TypeError, ValueError):
        width = height = 0
    if not (1 <= width <= MOST and 1 <= height <= MOST):
        raise Error(f"a size is (width, height) in pixels, of 1 to {MOST} each, such as (640, 480); found {size!r}")
    return width, height


class Differences(list[dict[str, Any]]):
    """The differences between two pipelines: each as `lightloom diff --json` prints it, and all as text."""

    def __init__(self, found: tuple[str, str]) -> None:
        self._text, as_json = found
        super().__init__(json.loads(as_json))

    def __str__(self) -> str:
        return self._text.rstrip("\n") or "no difference"


def name_of(pipeline: str | Pipeline) -> str:
    """Returns the name by which a pipeline is found."""
    return pipeline.path if isinstance(pipeline, Pipeline) else pipeline


def diff(a: str | Pipeline, b: str | Pipeline) -> Differences:
    """Returns the differences between two pipelines, given by name or as text."""
    return Differences(_lightloom.diff(name_of(a), name_of(b)))


def pipelines() -> dict[str, str | None]:
    """Returns the pipelines by name, with what each renders."""
    return dict(_lightloom.pipelines())


def scenes() -> dict[str, str | None]:
    """Returns the scenes by name, with what each shows."""
    return dict(_lightloom.scenes())


def root() -> str | None:
    """Returns the folder whose pipelines, shaders and scenes come before those that are built in: the tree of Lightloom around the
    working folder, where there is one."""
    return _lightloom.root()


def set_root(folder: str | os.PathLike[str] | None) -> None:
    """Takes pipelines, shaders and scenes from a folder first, and then those that are built in. Texts of `Pipeline` and `wgsl` that
    were given before are gone."""
    if folder is not None and not os.path.isdir(folder):
        raise Error(f"there is no folder `{os.fspath(folder)}`")
    _lightloom.set_root(folder)
