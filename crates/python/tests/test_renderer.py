"""A renderer, its pictures, its buffers and its values."""

from __future__ import annotations

import dataclasses
import math
import pathlib
import subprocess
import sys

import lightloom
import numpy as np
import pytest

SMALL = (32, 24)


def small(scene: str = "cornell-box", pipeline: str | lightloom.Pipeline = "ism-invtm", **settings: object) -> lightloom.Renderer:
    return lightloom.Renderer(scene, pipeline, SMALL, **{"lights": 16, "rsm.size": 64, **settings})


def test_a_picture_is_what_the_program_renders(folder: pathlib.Path) -> None:
    ours = small(**{"gather.clamp": 0.05}).frame().output("indirect")
    words = ["render", "ism-invtm", "cornell-box", "--size", "32x24", "--output", "indirect", "-o", "theirs.exr"]
    sets = ["--set", "lights=16", "--set", "rsm.size=64", "--set", "gather.clamp=0.05"]
    subprocess.run([sys.executable, "-m", "lightloom", *words, *sets], check=True)
    theirs = lightloom.read("theirs.exr")
    assert ours.shape == (24, 32, 3) and ours.dtype == np.float32 and ours.mean() > 0.001
    np.testing.assert_array_equal(ours, theirs)


def test_pictures_share_the_memory_that_was_read_back() -> None:
    image = small().frame().output()
    owner = image
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    # Height, width, and four channels, of which three are shown: the rest was not copied.
    assert owner.size == 24 * 32 * 4 and np.shares_memory(owner, image)


def test_a_picture_shows_itself() -> None:
    image = small().frame().output()
    assert image._repr_png_()[1:4] == b"PNG"
    brighter = (2 * image).png()
    assert brighter != image.png() and brighter != (2 * image).png(exposure=3.0)
    assert isinstance(image.mean(), np.float32) and (image[..., 0] > 0)._repr_png_() is None
    display = small().frame().output("display")
    assert display.shown == ("none", 1.0, 0.0)


def test_files_keep_pictures(folder: pathlib.Path) -> None:
    renderer = small().frame()
    image = renderer.output("indirect")
    image.save("a.exr")
    np.testing.assert_array_equal(lightloom.read("a.exr"), image)
    image.save("a.png")
    assert np.abs(lightloom.read("a.png") - lightloom.read("a.png")).max() == 0
    with pytest.raises(lightloom.Error, match=r"ends in \.exr, \.png or \.pfm"):
        image.save("a.bmp")
    assert sorted(path.name for path in folder.iterdir()) == ["a.exr", "a.png"]


def test_a_saved_picture_is_rendered_again() -> None:
    renderer = small()
    renderer["lights"] = 24
    renderer.camera = dataclasses.replace(renderer.camera, position=(0.2, 0.3, -0.7))
    renderer.frame(3).save("a.exr", "indirect")
    done = subprocess.run(
        [sys.executable, "-m", "lightloom", "--json", "rerun", "a.exr", "-o", "b.exr"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(lightloom.read("a.exr"), lightloom.read("b.exr"))


def test_values_are_set_and_read() -> None:
    renderer = small()
    renderer["near"] = 0.0
    before = renderer.frame().output("indirect").mean()
    renderer["gather.area_bound"] = np.float32(8.5)
    assert renderer["gather.area_bound"] == 8.5 and renderer["lights"] == 16
    assert renderer.frame().output("indirect").mean() < before
    assert renderer.settings["gather.area_bound"] == 8.5 and "area_bound" in renderer.settings._repr_html_()
    renderer["settle"] = False
    assert renderer["settle"] is False


@pytest.mark.parametrize(
    ("path", "value", "error", "says"),
    [
        ("gather.clamp", math.nan, lightloom.Error, "NaN is not"),
        ("gather.clamp", -1.0, lightloom.Error, "gather.clamp"),
        ("gather.clam", 1.0, lightloom.Error, "clamp"),
        ("lights", 1.5, lightloom.Error, "u32"),
        ("lights", 2**40, OverflowError, "32 bits"),
        ("lights", None, TypeError, "expected a bool"),
        ("lights", [1.0] * 7, TypeError, "of 7 numbers"),
    ],
)
def test_a_wrong_value_is_refused_and_the_last_stays(path: str, value: object, error: type, says: str) -> None:
    renderer = small(**{"gather.clamp": 0.25})
    with pytest.raises(error, match=says):
        renderer[path] = value
    assert renderer["gather.clamp"] == 0.25 and renderer["lights"] == 16
    renderer.frame()


def test_lights_are_a_structured_array() -> None:
    renderer = small()
    renderer.keep("lights")
    lights = renderer.frame().resource("lights")
    assert lights.shape == (16,) and lights.dtype["position"].shape == (3,)
    assert lights.dtype.names is not None and {"position", "normal", "flux", "area"} <= set(lights.dtype.names)
    np.testing.assert_allclose(np.linalg.norm(lights["normal"], axis=1), 1.0, atol=1e-5)
    # They lie in the box, which is 0.55 m wide.
    assert (lights["position"] > -0.01).all() and (lights["position"] < 0.57).all()
    assert lights["flux"].sum() > 0


def test_textures_have_their_own_type() -> None:
    renderer = small()
    renderer.keep("view")
    depth = renderer.frame().resource("view.view.depth")
    assert depth.shape == (48, 64, 1) and depth.dtype == np.float32 and depth.max() > 0.5
    assert renderer.resource("view.view.normal").dtype == np.float16


def test_timings_are_a_structured_array() -> None:
    renderer = small()
    timings = renderer.frame().timings()
    assert timings.dtype.names == ("pass", "ms") and "gather" in timings["pass"]
    assert (timings["ms"] >= 0).all() and timings["ms"].sum() > 0


def test_the_camera_moves() -> None:
    renderer = small()
    own = renderer.camera
    before = renderer.frame().output()
    renderer.camera = dataclasses.replace(own, position=np.float32([0.1, 0.3, -0.6]))
    assert not np.array_equal(renderer.frame().output(), before)
    assert renderer.camera.position == pytest.approx((0.1, 0.3, -0.6))
    renderer.camera = None
    np.testing.assert_array_equal(renderer.frame().output(), before)
    for wrong, says in [
        ({"target": own.position}, "must not be its position"),
        ({"position": (math.nan, 0, 0)}, "no finite number"),
        ({"position": (0, 0)}, "sequence of 3"),
        ({"vertical_fov": 4}, "below π"),
        ({"near": 0}, "above 0"),
    ]:
        with pytest.raises(lightloom.Error, match=says):
            renderer.camera = dataclasses.replace(own, **wrong)


def test_lights_shine_in_their_colour() -> None:
    renderer = small()
    (spot,) = renderer.lights
    renderer.lights = [dataclasses.replace(spot, intensity=(1, 0, 0))]
    red, green, blue = renderer.frame().output().mean(axis=(0, 1))
    assert red > 0.01 and green == blue == 0
    renderer.lights = [spot, dataclasses.replace(spot, cone=None, intensity=(0, 0.1, 0))]
    assert len(renderer.lights) in (1, 2) and renderer.frame().output()[..., 1].mean() > 0
    for wrong, says in [
        ({"intensity": (-1, 0, 0)}, "from 0 to"),
        ({"cone": (2, 1)}, "cone"),
        ({"direction": (0, 0, 0)}, "must not be zero"),
    ]:
        with pytest.raises(lightloom.Error, match=says):
            renderer.lights = [dataclasses.replace(spot, **wrong)]
    renderer.lights = None
    assert renderer.frame() and renderer.lights == [spot]


def test_time_runs_and_stands() -> None:
    renderer = small("cornell-box-moving")
    renderer.frame(2)
    assert renderer.time > 0
    renderer.time = 0.5
    assert renderer.frame().time == 0.5
    with pytest.raises(lightloom.Error, match="finite number of seconds"):
        renderer.time = math.inf
    renderer.time = None
    renderer.seek(0)
    assert renderer.frame().time == 0


def test_a_reference_converges() -> None:
    renderer = lightloom.Renderer("cornell-box", "reference", (16, 12), samples=8)
    renderer.converge()
    done, most, is_done = renderer.progress
    assert done == most == 8 and is_done and small().frame().progress is None


def test_scene_size_and_pipeline_are_replaced() -> None:
    renderer = small()
    renderer.size = (20, 10)
    assert renderer.frame().output().shape == (10, 20, 3) and renderer.size == (20, 10)
    renderer.scene = "plane"
    renderer.pipeline = "ism"
    assert (renderer.scene, renderer.pipeline) == ("plane", "ism")
    assert "plane by ism, 20x10" in repr(renderer.frame())
    with pytest.raises(lightloom.Error, match="there is no scene"):
        renderer.scene = "plain"
    with pytest.raises(lightloom.Error, match="did you mean `ism-invtm`"):
        renderer.pipeline = "ism-invtmm"
    assert renderer.scene == "plane" and renderer.pipeline == "ism"


@pytest.mark.parametrize("size", [(0, 5), (-1, 5), (5,), "64x64", (100_000, 8), (1.5, 2), None])
def test_a_wrong_size_is_refused(size: object) -> None:
    with pytest.raises(lightloom.Error, match="width, height"):
        lightloom.Renderer(size=size)


def test_a_scene_that_was_deleted_is_an_error(folder: pathlib.Path) -> None:
    (folder / "mine.ron").write_text("""Scene(
    geometry: BuiltIn("cornell-box"),
    camera: Camera(position: (0.278, 0.273, -0.8), target: (0.278, 0.273, 0.0), vertical_fov_deg: 39.3),
    lights: [Point(name: "point", position: (0.1, 0.4, 0.1), intensity: (1, 1, 1))],
)""")
    renderer = small("mine.ron").frame()
    (folder / "mine.ron").unlink()
    with pytest.raises(lightloom.Error, match=r"mine\.ron"):
        renderer.scene = "mine.ron"
    with pytest.raises(lightloom.Error, match=r"mine\.ron"):
        renderer.reload()
    assert renderer.frame().output().mean() > 0


def test_an_adapter_that_is_missing_is_named() -> None:
    with pytest.raises(lightloom.Error, match="there is no adapter `no such`; there are: 0: "):
        lightloom.Renderer(adapter="no such")
    assert lightloom.Renderer(size=SMALL, adapter=0).frame()


def test_an_output_that_is_missing_is_named() -> None:
    renderer = small().frame()
    with pytest.raises(lightloom.Error, match="did you mean `indirect`"):
        renderer.output("indirct")
    with pytest.raises(lightloom.Error, match="a buffer"):
        renderer.output("lights.lights")
