"""The pages that people read: plain Markdown, shipped with the package."""

from pathlib import Path

GUIDE = Path(__file__).parent
"""Folder of the pages."""
TUTORIAL = GUIDE / "tutorial.md"
FOR_USERS = ("tutorial.md", "your_task.md", "certificate.md", "formats.md", "glossary.md")
"""Pages that need nothing of the package's sources beside them."""
