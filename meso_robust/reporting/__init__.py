"""Reports for people; the only package that draws.

Import it where a report is written, not before: it brings in the plotting library.
"""

from meso_robust.reporting.page import report as report
