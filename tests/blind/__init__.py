"""Tests of the blind benchmark (``reports/blind``)."""
