"""SymPy derivations of the contact conditions, from the quasi-static balance up.

One file a claim; each has a function ``derive() -> Derivation``. ``generate.py`` writes what they
return to ``meso_robust/_generated/`` and ``reports/derivations/``.
"""
