# SPDX-License-Identifier: MIT
"""What the functions of the module share about their arguments."""

from __future__ import annotations

import os
from typing import Any, Callable

from ._errors import Error


def paths_of(value: Any) -> list[str]:
    """One path or several."""
    values = [value] if isinstance(value, (str, os.PathLike)) else value
    if not isinstance(values, (list, tuple)) or not values:
        raise Error("path", f"found {type(value).__name__}", "must be a path or a list of them")
    for item in values:
        if not isinstance(item, (str, os.PathLike)):
            raise Error("path", f"found {type(item).__name__} in the list", "must be paths")
    return [os.fspath(item) for item in values]


def thread_count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 1024:
        raise Error("threads", f"found {value!r}", "must be a whole number from 0 to 1024")
    return value


def show_progress(value: Any, title: str) -> Callable[[float, str], Any] | None:
    """What is called with the share done: nothing, the caller's own, or a bar."""
    if value is None or value is False:
        return None
    if value is True:
        return _bar(title)
    if callable(value):
        return value
    raise Error("progress", f"found {type(value).__name__}", "must be True or a function of a share and a text")


def _bar(title: str) -> Callable[[float, str], Any]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return lambda share, text: print(f"{title} {100 * share:3.0f} %  {text}")
    bar = tqdm(total=100, desc=title, unit="%", bar_format="{desc} {percentage:3.0f} %|{bar}| {postfix}")

    def update(share: float, text: str) -> None:
        bar.update(100 * share - bar.n)
        bar.set_postfix_str(text, refresh=share >= 1.0)
        if share >= 1.0:
            bar.close()

    return update
