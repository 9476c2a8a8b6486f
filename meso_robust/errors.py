"""Errors that a user can cause and fix."""

from __future__ import annotations


class InputError(ValueError):
    """What the user gave cannot be used; the message names file, key, value and rule."""


class NotApplicableError(ValueError):
    """No primitive can handle the pose; the message says which and why."""


class ArgumentError(InputError):
    """The same of a call, in the names of its arguments; the cause has those of the command line."""
