"""Poses of a part and of probe tips seen through a microscope."""
