"""The top of a page as a picture: ``python -m reports.paper_task.picture PAGE.html --out PICTURE.png``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tests.browser import browser, executable, tab


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--height", type=int, default=1500)
    asked = parser.parse_args()
    found = executable()
    if found is None:
        sys.exit("no Chromium on this machine; install one")
    with browser(found) as running, tab(running) as page:
        page.emulate(width=1280, height=asked.height)
        page.open(asked.page)
        page.screenshot(asked.out, whole=False)


if __name__ == "__main__":
    main()
