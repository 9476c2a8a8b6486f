"""The loop on hardware: see, decide, move, see again; devices, calibration, journal, live page."""
