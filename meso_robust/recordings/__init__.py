"""Recording sets: the folder format that measured and simulated motion comes in.

A set is a file ``set.toml``, which describes the part, the probe and the sensor, and one CSV file a
recording. Files are in um, deg, s and uN; everything here is in SI.
"""

from meso_robust.recordings.document import SetDocument as SetDocument
from meso_robust.recordings.outline import Polygon as Polygon, Rectangle as Rectangle
from meso_robust.recordings.reading import read_set as read_set
from meso_robust.recordings.simulated import from_simulation as from_simulation
from meso_robust.recordings.values import (
    PositionSource as PositionSource,
    Recording as Recording,
    RecordingSet as RecordingSet,
    SensorInfo as SensorInfo,
    unwrapped as unwrapped,
)
from meso_robust.recordings.writing import write_set as write_set
