"""Symbolic-analytic verification of pushing plans for mesoscale assembly.

What the verbs of the command line do, in calls that return plain values:

>>> import meso_robust as mr
>>> task = mr.Task.paper()
>>> planned = mr.plan(task, samples=20)
>>> planned.verdict
'PROVED'
>>> mr.check(planned, task).verdict
'VERIFIED'

``Task.load``, ``plan``, ``certify``, ``check``, ``simulate``, ``drive`` make and keep the promise;
``standard_tests``, ``track``, ``read_recordings``, ``identify`` and ``diagnose`` go from the
laboratory back to the task; ``campaign`` and ``reproduce`` do much at once. A call is silent unless it
is given ``progress=Reporter()``, and writes nothing: a result is written by its ``save``. Three verbs
have no call: ``derive`` works on a checkout, ``schema`` prints and ``example`` copies files.
"""

from __future__ import annotations

TYPE_CHECKING = False  # as in `typing`, which takes longer to import than the rest of this file

if TYPE_CHECKING:
    from meso_robust.api.campaign import Campaigned as Campaigned, campaign as campaign
    from meso_robust.api.check import check as check
    from meso_robust.api.checked import Checked as Checked
    from meso_robust.api.diagnose import Diagnosed as Diagnosed, diagnose as diagnose
    from meso_robust.api.drive import Driver as Driver, drive as drive
    from meso_robust.api.identify import (
        Identified as Identified,
        StandardTests as StandardTests,
        identify as identify,
        standard_tests as standard_tests,
    )
    from meso_robust.api.plan import Planned as Planned, certify as certify, plan as plan
    from meso_robust.api.progress import Progress as Progress
    from meso_robust.api.recordings import (
        Recordings as Recordings,
        read_recordings as read_recordings,
    )
    from meso_robust.api.reproduce import Reproduced as Reproduced, reproduce as reproduce
    from meso_robust.api.result import Result as Result
    from meso_robust.api.simulate import (
        Simulated as Simulated,
        camera_of as camera_of,
        simulate as simulate,
    )
    from meso_robust.api.task import Task as Task
    from meso_robust.api.track import Tracked as Tracked, track as track
    from meso_robust.cli.console import Reporter as Reporter
    from meso_robust.errors import (
        InputError as InputError,
        NotApplicableError as NotApplicableError,
    )

__version__ = "0.1.0"

_MODULES = {
    "api.campaign": ("Campaigned", "campaign"),
    "api.check": ("check",),
    "api.checked": ("Checked",),
    "api.diagnose": ("Diagnosed", "diagnose"),
    "api.drive": ("Driver", "drive"),
    "api.identify": ("Identified", "StandardTests", "identify", "standard_tests"),
    "api.plan": ("Planned", "certify", "plan"),
    "api.progress": ("Progress",),
    "api.recordings": ("Recordings", "read_recordings"),
    "api.reproduce": ("Reproduced", "reproduce"),
    "api.result": ("Result",),
    "api.simulate": ("Simulated", "camera_of", "simulate"),
    "api.task": ("Task",),
    "api.track": ("Tracked", "track"),
    "cli.console": ("Reporter",),
    "errors": ("InputError", "NotApplicableError"),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}
"""Module of every public name: it is loaded when the name is first used, which takes seconds."""
__all__ = ["__version__", *sorted(_WHERE)]  # all are texts

if not TYPE_CHECKING:  # a type checker knows the names from the imports above, and no others

    def __getattr__(name: str) -> object:
        """Load a public name."""
        if name not in _WHERE:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        found = getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        """List all public names, loaded or not."""
        return sorted({*globals(), *__all__})
