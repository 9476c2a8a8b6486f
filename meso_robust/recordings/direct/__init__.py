"""Tests that need no simulation: what recordings say about themselves, in milliseconds.

Each is a pure function from recordings to a frozen value: the gap between tip and face while the part
moves, the part in the frame of a hand of two tips, the regularity of every clock, travel that should
be straight, the balance of moments that holds for every friction, and whether a part at rest sways. None asks for the geometry to
be right, so they judge sets whose mismatch is the geometry.
"""
