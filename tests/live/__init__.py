"""Tests of the loop on devices."""
