"""Types that cross the border to Rust."""

from collections.abc import Sequence

Value = bool | int | float | str | Sequence[float]
"""A value of a parameter or a setting."""
Settings = Sequence[tuple[str, Value]]
"""Values by their paths."""
Shown = tuple[str, float, float]
"""How linear light is shown: the name of a tone-mapping curve, its white point, and the exposure [EV]."""
Drawn = tuple[str, str, str, str, str]
"""A plan as text, JSON, SVG and DOT, and its warnings as JSON."""
