"""The foreign plant."""
