"""Pipelines and shaders that are texts of a notebook."""

from __future__ import annotations

import pathlib

import lightloom
import numpy as np
import pytest

HALVE = """// Halves what arrives.

var light: texture_2d<f32>;

@fragment
fn halve(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return FACTOR * textureLoad(light, vec2<u32>(at.xy), 0);
}
"""
PIPELINE = """Pipeline(
    extends: "ism-invtm.ron",
    patch: [
        Insert(
            name: "halve",
            pass: Pass(kind: "fullscreen", shader: "halve.wgsl", out: { "result": Out(interface: "Irradiance") }),
            between: ("filter", "image.indirect"),
        ),
        Set("lights", 16), Set("rsm.size", 64),
    ],
)"""


def test_without_a_device_a_pipeline_is_resolved_compared_and_drawn() -> None:
    few = lightloom.Pipeline('Pipeline(extends: "ism-invtm.ron", patch: [Set("lights", 64)])', name="few.ron")
    assert "lights" in few.resolve() and "1024 → 64" in str(lightloom.diff("ism-invtm", few))
    assert lightloom.diff(few, few) == [] and str(lightloom.diff(few, few)) == "no difference"
    plan = few.plan(size=(64, 48))
    assert plan.svg().startswith("<svg") and plan._repr_svg_() == plan.svg() and "digraph" in plan.dot()
    assert "gather" in str(plan) and plan.data["frame"] == [64, 48]


def test_without_a_device_patches_are_added(folder: pathlib.Path) -> None:
    few = lightloom.Pipeline('Pipeline(extends: "ism-invtm.ron")', name="base.ron")
    fewer = few.patch('Set("map", 32)', lights=8, **{"gather.clamp": 0.5})
    assert 'extends: "base.ron"' in fewer.text and 'Set("gather.clamp", 0.5)' in fewer.text
    fewer.check()
    fewer.save("fewer.ron")
    assert (folder / "fewer.ron").read_text() == fewer.text
    assert [path.name for path in folder.iterdir()] == ["fewer.ron"]


def test_without_a_device_errors_of_a_text_have_code_and_place() -> None:
    wrong = lightloom.Pipeline('Pipeline(\n    extends: "ism-invtm.ron",\n    patch: [Set("lihts", 1)],\n)', name="wrong.ron")
    with pytest.raises(lightloom.Error) as caught:
        wrong.check()
    error = caught.value
    assert (error.code, error.line, error.column) == ("E017", 3, 17)
    assert error.file is not None and error.file.endswith("wrong.ron")
    assert "did you mean `lights`?" in str(error) and "^^^" in str(error)
    assert error.errors[0]["labels"][0]["line"] == 3


def test_without_a_device_a_name_must_end_as_its_kind_does() -> None:
    with pytest.raises(lightloom.Error, match=r"must end in `\.wgsl`"):
        lightloom.wgsl("", name="halve.txt")


def test_a_shader_of_a_cell_is_a_pass() -> None:
    shader = lightloom.wgsl(HALVE.replace("FACTOR", "0.5"), name="halve.wgsl")
    assert str(shader) == "halve.wgsl"
    whole = lightloom.Renderer("cornell-box", "ism-invtm", (32, 24), lights=16, **{"rsm.size": 64})
    expected = whole.frame().output("indirect")
    renderer = lightloom.Renderer("cornell-box", lightloom.Pipeline(PIPELINE, name="halved.ron"), (32, 24))
    np.testing.assert_allclose(renderer.frame().output("indirect"), 0.5 * expected, rtol=1e-3)
    # Given again, it is loaded at the next frame, and by the renderers that have it alone.
    lightloom.wgsl(HALVE.replace("FACTOR", "0.25"), name="halve.wgsl")
    np.testing.assert_allclose(renderer.frame().output("indirect"), 0.25 * expected, rtol=1e-3)
    # One that does not compile raises once, and the last good one stays.
    lightloom.wgsl(HALVE.replace("FACTOR", "nothing"), name="halve.wgsl")
    with pytest.raises(lightloom.Error, match="nothing") as caught:
        renderer.frame()
    assert "halve.wgsl:7:12" in str(caught.value)
    whole.frame()
    np.testing.assert_allclose(renderer.frame().output("indirect"), 0.25 * expected, rtol=1e-3)
    lightloom.wgsl(HALVE.replace("FACTOR", "1.0"), name="halve.wgsl")
    np.testing.assert_allclose(renderer.frame().output("indirect"), expected, rtol=1e-3)


def test_files_are_read_again(folder: pathlib.Path) -> None:
    file = folder / "mine.ron"
    file.write_text('Pipeline(extends: "ism-invtm.ron", patch: [Set("lights", 16), Set("rsm.size", 64)])')
    renderer = lightloom.Renderer("cornell-box", "mine.ron", (32, 24))
    file.write_text('Pipeline(extends: "ism-invtm.ron", patch: [Set("lights", 32), Set("rsm.size", 64)])')
    assert renderer["lights"] == 16 and renderer.reload() and renderer["lights"] == 32
    file.write_text("Pipeline(")
    with pytest.raises(lightloom.Error):
        renderer.reload()
    assert renderer.frame()["lights"] == 32


def test_without_a_device_pipelines_and_scenes_are_listed() -> None:
    assert lightloom.pipelines()["reference"] is not None and "cornell-box" in lightloom.scenes()


def test_without_a_device_a_root_is_a_folder(folder: pathlib.Path) -> None:
    with pytest.raises(lightloom.Error, match="there is no folder"):
        lightloom.set_root("nowhere")
    assert lightloom.root() is None
