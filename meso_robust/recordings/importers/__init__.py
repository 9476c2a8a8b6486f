"""Readers of recordings that others made: one file a format.

A reader never repairs. It brings units, frames and clocks to those of a recording set by a rule that
its note states, and lists whatever the files hold that the set does not.
"""

from collections.abc import Mapping
from types import MappingProxyType

from meso_robust.recordings.importers.imported import (
    Imported as Imported,
    Importer as Importer,
    Left as Left,
)
from meso_robust.recordings.importers.mcube_json import IMPORTER as _MCUBE_JSON
from meso_robust.recordings.importers.support_point_log import IMPORTER as _SUPPORT_POINT_LOG
from meso_robust.recordings.importers.two_finger_log import IMPORTER as _TWO_FINGER_LOG

FORMATS: Mapping[str, Importer] = MappingProxyType(
    {
        "mcube_json": _MCUBE_JSON,
        "two_finger_log": _TWO_FINGER_LOG,
        "support_point_log": _SUPPORT_POINT_LOG,
    }
)
"""Importers by the name of their format."""
