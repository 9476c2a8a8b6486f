"""Wrongs concealed in real recordings, on top of what is wrong with them already."""
