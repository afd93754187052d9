"""Real-time global illumination by virtual lights, in Python.

A renderer takes a scene and a pipeline, which is a frame graph in RON, and gives pictures and buffers as NumPy arrays:

>>> import lightloom
>>> renderer = lightloom.Renderer("cornell-box", "ism-invtm", (64, 64), lights=64)
>>> indirect = renderer.frame().output("indirect")
>>> indirect.shape, indirect.dtype
((64, 64, 3), dtype('float32'))

Pictures are linear light [W/(m² sr)], RGB of Rec. 709, row by row from the top left. Lengths are in metres and angles in radians.
"""

import os as _os

if "XDG_RUNTIME_DIR" not in _os.environ:
    # Mesa's layer that chooses a device prints an error where there is no desktop.
    _os.environ.setdefault("NODEVICE_SELECT", "1")

from ._errors import Error
from ._files import Pipeline, Plan, Shader, diff, pipelines, root, scenes, set_root, wgsl
from ._images import Image, flip, measure, read
from ._lightloom import __version__, adapters
from ._renderer import Camera, Light, Renderer, Settings
from ._studies import Blame, Results, Study, Tuned, blame, report, study, tune

__all__ = [
    "Blame",
    "Camera",
    "Error",
    "Image",
    "Light",
    "Pipeline",
    "Plan",
    "Renderer",
    "Results",
    "Settings",
    "Shader",
    "Study",
    "Tuned",
    "__version__",
    "adapters",
    "blame",
    "diff",
    "flip",
    "measure",
    "pipelines",
    "read",
    "report",
    "root",
    "scenes",
    "set_root",
    "study",
    "tune",
    "wgsl",
]
