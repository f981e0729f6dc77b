# SPDX-License-Identifier: MIT
"""The two ways in which a call can fail."""


class Error(ValueError):
    """Wrong input, file or setting: the caller can mend it.

    where    the argument, setting or file
    found    what it was
    allowed  what it may be
    """

    def __init__(self, where: str, found: str, allowed: str) -> None:
        super().__init__(where, found, allowed)
        self.where = where
        self.found = found
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.where}: {self.found}; {self.allowed}"


class Failure(RuntimeError):
    """The input is fine and the work still cannot be done, for lack of memory or space."""
