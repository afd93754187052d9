"""Measures against their definitions."""

from __future__ import annotations

import lightloom
import numpy as np
import pytest


def test_without_a_device_measures_are_those_of_their_definitions() -> None:
    random = np.random.default_rng(1)
    reference = random.uniform(0.1, 2.0, (8, 9, 3)).astype(np.float32)
    picture = reference * random.uniform(0.8, 1.2, reference.shape).astype(np.float32)
    found = lightloom.measure(picture, reference)
    error = picture.astype(np.float64) - reference
    assert found["rmse"] == pytest.approx(np.sqrt((error**2).mean()), rel=1e-5)
    assert found["energy_ratio"] == pytest.approx(picture.mean() / reference.mean(), rel=1e-5)
    assert lightloom.measure(reference, reference)["rel_mse"] == 0
    assert lightloom.measure(picture[..., 0], reference[..., 0])["rmse"] == pytest.approx(np.sqrt((error[..., 0] ** 2).mean()), rel=1e-5)


def test_without_a_device_flip_is_a_map() -> None:
    black, white = np.zeros((8, 8, 3)), np.ones((8, 8, 3))
    assert lightloom.flip(black, black).max() == 0 and lightloom.flip(black, white).shape == (8, 8)
    assert lightloom.flip(black, white, display=True).mean() == pytest.approx(lightloom.measure(black, white, display=True)["flip"]["mean"])


@pytest.mark.parametrize(
    ("picture", "says"),
    [
        (np.ones((3, 3, 5)), "found \\[3, 3, 5\\]"),
        (np.ones((0, 3, 3)), "found \\[0, 3, 3\\]"),
        (np.ones(4), "found \\[4\\]"),
        (np.array([["a"]]), "array of numbers"),
        (np.ones((2, 2), complex), "array of numbers"),
        (None, "array of numbers"),
        (np.ones((4, 3, 3)), "sizes differ"),
        (np.full((3, 3, 3), np.nan), "NaN or infinite"),
    ],
)
def test_without_a_device_what_is_no_picture_is_refused(picture: object, says: str) -> None:
    with pytest.raises(lightloom.Error, match=says):
        lightloom.measure(picture, np.ones((3, 3, 3)))
