"""The renderer."""

from __future__ import annotations

import dataclasses
import html
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _files, _lightloom
from ._errors import Error
from ._files import Pipeline, Plan
from ._images import Image
from ._types import Value

Vector = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    `dataclasses.replace(renderer.camera, position=(0, 1, 3))` is another one that differs in its place.
    """

    position: Vector
    """Where the pinhole is [m]."""
    target: Vector
    """A point that it looks at [m]."""
    up: Vector = (0.0, 1.0, 0.0)
    """What is up in the picture; neither zero nor along the axis."""
    vertical_fov: float = math.radians(40)
    """What it sees from top to bottom [rad], between 0 and π."""
    near: float = 0.01
    """Where it begins to see [m], above 0."""


@dataclasses.dataclass(frozen=True)
class Light:
    """A light without extent: a spot light where it has a cone, a directional light, or a point light."""

    position: Vector
    """Where it is [m]; without meaning for a directional light."""
    intensity: Vector
    """RGB: radiant intensity [W/sr]; of a directional light, irradiance of a surface that faces it [W/m²]."""
    direction: Vector = (0.0, -1.0, 0.0)
    """The direction in which the light travels: the axis of a spot light; without meaning for a point light."""
    cone: tuple[float, float] | None = None
    """Half the angles [rad] of the cone of full intensity, and of the whole cone, for a spot light."""
    directional: bool = False
    """Whether it is a directional light."""
    name: str = "light"
    """Its name."""


for _class in (Camera, Light):
    _class.__module__ = "lightloom"


def _plain(value: Any) -> Any:
    """Returns numbers and arrays of NumPy as what JSON knows; one that is no number is refused by name."""
    if isinstance(value, Mapping):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, str):
        return [_plain(part) for part in value]
    if hasattr(value, "item"):
        return value.item()
    return value


def _as_json(value: Any, what: str) -> str:
    try:
        return json.dumps(_plain(value), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise Error(f"{what} has a value that is no finite number: {value}") from error


def _fields(of: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of a camera or a light, with vectors as tuples."""
    return {key: tuple(value) if isinstance(value, list) else value for key, value in of.items()}


class Settings(Mapping[str, Value]):
    """The parameters of a pipeline and the settings of its passes, by path."""

    def __init__(self, rows: list[tuple[str, Value, str, str]]) -> None:
        self._rows = {path: (value, unit, about) for path, value, unit, about in rows}

    def __getitem__(self, path: str) -> Value:
        return self._rows[path][0]

    def __iter__(self) -> Iterator[str]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def about(self, path: str) -> str:
        """Returns what a value does."""
        return self._rows[path][2]

    def __repr__(self) -> str:
        return "\n".join(f"{path} = {value!r} {unit}".rstrip() for path, (value, unit, _) in self._rows.items())

    def _repr_html_(self) -> str:
        cells = [
            (path, f"{value} {unit}".rstrip(), about) for path, (value, unit, about) in self._rows.items()
        ]
        return table(("name", "value", "what it does"), cells)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Returns a table in HTML."""

    def line(tag: str, cells: Sequence[object]) -> str:
        inner = "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells)
        return f"<tr>{inner}</tr>"

    return f"<table>{line('th', head)}{''.join(line('td', row) for row in rows)}</table>"


class Renderer:
    """Renders a scene by a pipeline, frame by frame.

    `scene` is the name of a scene or a file, `pipeline` the name of a pipeline, a file or a `Pipeline`, `size` that of frames in
    pixels, and `settings` are values of parameters and of settings of passes. `adapter` is a number or a part of a name in
    `lightloom.adapters()`; renderers of one adapter share its device. `seed` is that of all random numbers; 0 gives plain sequences.

    >>> import lightloom
    >>> renderer = lightloom.Renderer("cornell-box", "ism-invtm", (32, 24), lights=16)
    >>> renderer["gather.clamp"] = 0.05
    >>> renderer.frame()["gather.clamp"]
    0.05

    At the end of a cell of a notebook, a renderer is its picture.
    """

    def __init__(
        self,
        scene: str | os.PathLike[str] = "cornell-box",
        pipeline: str | Pipeline = "ism-invtm",
        size: tuple[int, int] = (512, 512),
        *,
        adapter: str | int | None = None,
        seed: int = 0,
        **settings: Value,
    ) -> None:
        wanted = None if adapter is None else str(adapter)
        self._pipeline = pipeline
        self._laid = len(_files.laid)
        self._core = _lightloom.Renderer(
            os.fspath(scene), _files.name_of(pipeline), _files.checked(size), list(settings.items()), wanted, seed
        )

    def frame(self, count: int = 1) -> Renderer:
        """Runs frames, and returns the renderer. Ctrl-C ends it between two frames."""
        self._load_new_texts()
        self._core.frames(count, False)
        return self

    def converge(self) -> Renderer:
        """Runs one frame again and again until the pipeline's output `progress` says that it is done; one frame where there is no such
        output. Ctrl-C ends it between two frames."""
        self._load_new_texts()
        self._core.frames(1, True)
        return self

    def _load_new_texts(self) -> None:
        new = _files.laid[self._laid :]
        if new:
            self._laid += len(new)
            self._core.reload(new)

    def output(self, name: str = "image", layer: int = 0) -> Image:
        """Returns an output of the pipeline, or any texture as `pass.port`, as a picture of the last frame, `[height, width, 3]`.

        A texture that is no output may have given its memory to another; `keep` prevents that.
        """
        return Image(self._core.picture(name, layer)[..., :3], self._core.shown(name))

    def resource(self, name: str) -> npt.NDArray[Any]:
        """Returns what an output or any resource, as `pass.port`, holds: a texture as `[height, width, channels]` or
        `[layer, height, width, channels]` of its own type, a buffer as a structured array of what the shader declares.

        >>> import lightloom
        >>> renderer = lightloom.Renderer("cornell-box", "ism-invtm", (32, 24), lights=16)
        >>> renderer.keep("lights")
        >>> lights = renderer.frame().resource("lights")
        >>> lights["position"].shape
        (16, 3)
        """
        return self._decoded(name)[0]

    def header(self, name: str) -> npt.NDArray[Any]:
        """Returns what a buffer has before its rows, as a structured array of one element."""
        return self._decoded(name)[1]

    def _decoded(self, name: str) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        raw, text = self._core.resource(name)
        what = json.loads(text)
        none = np.zeros(1, dtype=np.dtype([]))
        if "shape" in what:
            layers, *inner = what["shape"]
            texels = raw.view(what["dtype"]).reshape(what["shape"])
            return (texels if layers > 1 else texels.reshape(inner)), none
        if "dtype" not in what:
            return raw, none
        begin, end = what["window"] or (0, raw.size)
        raw = raw[begin:end]
        header = raw[: what["start"]].view(_dtype(what["header"])) if what["start"] else none
        if not what["dtype"]["itemsize"]:
            return header, header
        rows = raw[what["start"] :]
        whole = rows.size // what["dtype"]["itemsize"] * what["dtype"]["itemsize"]
        return rows[:whole].view(_dtype(what["dtype"])), header

    def keep(self, name: str) -> None:
        """Keeps a resource for reading after each frame, also that of a pass that no picture needs."""
        self._core.keep(name)

    def save(self, path: str | os.PathLike[str], output: str = "image") -> None:
        """Writes an output into an .exr, .png or .pfm file, with the record by which `lightloom rerun` renders it again."""
        self._core.save(os.fspath(path), output)

    def __getitem__(self, path: str) -> Value:
        """Returns the value of a parameter, such as `lights`, or of a setting of a pass, such as `gather.clamp`."""
        return self._core.value(path)

    def __setitem__(self, path: str, value: Value) -> None:
        """Sets it, for the next frame; where it is wrong, the value before stays."""
        self._core.set_value(path, value)

    @property
    def settings(self) -> Settings:
        """All parameters and settings."""
        return Settings(self._core.values())

    @property
    def scene(self) -> str:
        """The scene, as it was named; setting it loads another."""
        return self._core.names()[0]

    @scene.setter
    def scene(self, scene: str | os.PathLike[str]) -> None:
        self._core.set_scene(os.fspath(scene))

    @property
    def pipeline(self) -> str | Pipeline:
        """The pipeline; setting it loads another, with its own values."""
        return self._pipeline

    @pipeline.setter
    def pipeline(self, pipeline: str | Pipeline) -> None:
        self._core.set_pipeline(_files.name_of(pipeline), [])
        self._pipeline = pipeline

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of frames in pixels."""
        return self._core.size()

    @size.setter
    def size(self, size: tuple[int, int]) -> None:
        self._core.set_size(_files.checked(size))

    @property
    def adapter(self) -> str:
        """Name and driver of the adapter."""
        return self._core.names()[2]

    @property
    def camera(self) -> Camera:
        """The camera of the last frame, before the first that of 0 s. `None` restores the scene's own."""
        return Camera(**_fields(json.loads(self._core.camera())))

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._set_camera(camera, False)

    def cut_to(self, camera: Camera | None) -> None:
        """Sets the camera as one that jumps, so that pipelines do not take light from the picture before."""
        self._set_camera(camera, True)

    def _set_camera(self, camera: Camera | None, cut: bool) -> None:
        as_json = None if camera is None else _as_json(dataclasses.asdict(camera), "the camera")
        self._core.set_camera(as_json, cut)

    @property
    def lights(self) -> list[Light]:
        """The lights of the last frame, before the first those of 0 s. `None` restores the scene's own."""
        return [Light(**_fields(light)) for light in json.loads(self._core.lights())]

    @lights.setter
    def lights(self, lights: Sequence[Light] | None) -> None:
        as_dicts = None if lights is None else [dataclasses.asdict(light) for light in lights]
        self._core.set_lights(None if as_dicts is None else _as_json(as_dicts, "a light"))

    @property
    def time(self) -> float:
        """The time of the last frame [s]. A value that is set holds for all frames after; `None` lets it follow their numbers again."""
        return self._core.time()

    @time.setter
    def time(self, time: float | None) -> None:
        if time is not None and not math.isfinite(time):
            raise Error(f"the time is {time}; it must be a finite number of seconds")
        self._core.set_time(time)

    def seek(self, frame: int) -> None:
        """Sets the number of the next frame, and so the time of animations."""
        self._core.set_frame_index(frame)

    def seed(self, seed: int) -> None:
        """Sets the seed of all random numbers; 0 gives plain sequences, as the papers use them."""
        self._core.set_seed(seed)

    def timings(self) -> npt.NDArray[Any]:
        """Returns the time of each pass on the device, `pass` and `ms`, in the last frame; 0 for one that did not run, since nothing that
        it reads had changed. Empty where the adapter has no timestamps."""
        rows = self._core.timings() or []
        width = max((len(name) for name, _ in rows), default=1)
        return np.array(rows, dtype=[("pass", f"U{width}"), ("ms", np.float64)])

    @property
    def progress(self) -> tuple[int, int, bool] | None:
        """Of a result that takes several frames, the steps so far, the most that there will be, and whether it has converged."""
        return self._core.progress()

    def reload(self) -> bool:
        """Reads the files of the pipeline, its shaders and the scene again, and returns whether that changed anything. Where one is wrong,
        it raises an `Error`, and the last good ones stay."""
        return self._core.reload(None)

    @property
    def plan(self) -> Plan:
        """The plan that runs: what a notebook draws."""
        return Plan(self._core.plan())

    def __repr__(self) -> str:
        scene, pipeline, adapter = self._core.names()
        width, height = self.size
        return f"<lightloom.Renderer of {scene} by {os.path.basename(pipeline)}, {width}x{height}, on {adapter}>"

    def _repr_png_(self) -> bytes | None:
        return self.output()._repr_png_()


def _dtype(of: dict[str, Any]) -> np.dtype[Any]:
    """Returns a structured type; each format is a scalar and what each dimension repeats."""
    formats = [(scalar, tuple(shape)) for scalar, shape in of["formats"]]
    described: Any = {**of, "formats": formats}
    dtype: np.dtype[Any] = np.dtype(described)
    return dtype
