"""The live loop in the virtual laboratory, run after run."""
