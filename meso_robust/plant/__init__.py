"""A plant of its own: a part with mass on a film, pushed by compliant round tips.

It shares no formula with the simulator, which has rigid contacts, no mass and a complementarity problem,
and imports nothing of the package: what is proved can fail here. Units are um, s and rad; forces are over
the film's translational drag and hence speeds.
"""
