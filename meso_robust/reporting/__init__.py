"""Reports for people; the only package that draws.

Import its modules where a report is written, not before: they bring in the plotting library.
"""
