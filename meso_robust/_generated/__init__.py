"""Code generated from derivations/ by `meso-robust derive`; do not edit."""
