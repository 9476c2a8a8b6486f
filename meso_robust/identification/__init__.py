"""System identification: models fitted to recordings of pushes.

A model (`models`) says which physics a vector of parameters stands for; `forward` predicts what the
camera would have seen of every recorded push, for many vectors at once; the rest searches for the
vectors that explain a recording set, says how well each parameter is known, and which are not.
"""
