"""Plans carried out in the simulator: draws of the uncertainties, runs, adversary, cross-check."""
