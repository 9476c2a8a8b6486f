"""Reports for people; the only package that draws.

Import :mod:`meso_robust.reporting.page` where a report is written, not before: it brings in the
plotting library.
"""
