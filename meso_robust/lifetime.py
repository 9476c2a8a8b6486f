"""The life of a process that does one thing and ends."""

import atexit
import gc


def short() -> None:
    """Hardly look for objects that can be freed, and not at the end: what such a process makes it needs.

    Looking took a tenth of the time of a plan, and a twentieth of compiling.
    """
    gc.set_threshold(200_000, 30, 30)
    atexit.register(gc.freeze)
