"""The pages that people read: plain Markdown, shipped with the package."""

from pathlib import Path

GUIDE = Path(__file__).parent
"""Folder of the pages."""
TUTORIAL = GUIDE / "tutorial.md"
