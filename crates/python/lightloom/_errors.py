"""The errors of files, of the device and of wrong use."""

import json
from typing import Any


class Error(Exception):
    """Something that cannot be done, and why: its text says what was expected, and where, with carets.

    >>> import lightloom
    >>> lightloom.Pipeline('Pipeline(extends: "ism-invtn.ron")', name="mine.ron").resolve()
    Traceback (most recent call last):
      ...
    lightloom.Error: error[E010]: there is no pipeline file `ism-invtn.ron`
    ...
      = did you mean `ism-invtm.ron`?
    ...
    """

    code: str | None
    """The code of the first error of a file, such as `E012`; `None` where the error is not about the text of a file."""
    file: str | None
    """The file of the first error, where it is about one."""
    line: int | None
    """The line of the first error, from 1."""
    column: int | None
    """The column of the first error in characters, from 1."""
    errors: list[dict[str, Any]]
    """All errors: `code`, `severity`, `message`, `file`, `line`, `column`, `labels` (all places) and `help`."""

    def __init__(self, text: str, errors: str = "[]") -> None:
        super().__init__(text)
        self.errors = json.loads(errors)
        first = self.errors[0] if self.errors else {}
        self.code = first.get("code")
        self.file = first.get("file")
        self.line = first.get("line")
        self.column = first.get("column")


Error.__module__ = "lightloom"
