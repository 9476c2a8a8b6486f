"""Motion in each contact mode: closed forms and rigorous enclosures."""
