"""A bad file is refused before compiled code is imported, which takes seconds."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from meso_robust.campaigns.kinds import KINDS
from meso_robust.tasks import PAPER
from tests.recordings.examples import SET, folder_of

PLAN = Path(__file__).parents[2] / "reports/paper_task/plan.json"
SIDES = "--length-um 1616 --width-um 837 --tip-radius-um 12.5 --pixel-um 5.26"
COMMANDS = f"""\
plan bad.toml
plan TASK --model broken.toml
certify bad.toml PLAN
certify TASK bad.json
certify TASK cut.json
check bad.json TASK
check CERTIFICATE bad.toml
simulate bad.toml PLAN
simulate TASK bad.json
simulate TASK PLAN --witness bad.json
simulate TASK PLAN --witness witness.json
drive bad.toml PLAN
drive TASK bad.json
drive TASK cut.json
drive TASK policy.json
identify set
identify table
identify --plan bad.toml
identify --plan set
diagnose set
diagnose table
recordings set
campaign bad.toml
campaign monte-carlo.toml
campaign falsify.toml
campaign property.toml
campaign mutation.toml
campaign blind.toml
campaign second_part.toml
track bad.avi {SIDES}
track nowhere.avi {SIDES}
track nowhere.avi --task bad.toml --tip-radius-um 12.5 --pixel-um 5.26
track nowhere.avi --set bad.toml --pixel-um 5.26
track nowhere.avi --length-um 1616 --tip-radius-um 12.5 --pixel-um 5.26
"""
SCRIPT = """
import sys
from typer.testing import CliRunner
from meso_robust.cli import app
for line in sys.stdin.read().splitlines():
    done = CliRunner().invoke(app, line.split())
    slow = {"numba", "casadi", "scipy", "sympy", "matplotlib"} & set(sys.modules)
    print(line, "|", done.exit_code, *sorted(slow))
"""


def test_no_compiled_code_is_imported_for_a_bad_file(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text("what = 1\n", encoding="utf-8")
    (tmp_path / "broken.toml").write_text("= 1\n", encoding="utf-8")
    (tmp_path / "bad.json").write_text('{"what": 1}', encoding="utf-8")
    (tmp_path / "cut.json").write_text(PLAN.read_text(encoding="utf-8")[:900], encoding="utf-8")
    witness = '{"schema": "meso-robust/witness/1", "factr": 1.0}'
    (tmp_path / "witness.json").write_text(witness, encoding="utf-8")
    policy = '{"schema": "meso-robust/policy/1", "taks": "paper"}'
    (tmp_path / "policy.json").write_text(policy, encoding="utf-8")
    for kind in KINDS:
        text = f'schema = "meso-robust/campaign/1"\nname = "x"\n[[part]]\nname = "p"\nkind = "{kind}"\n'
        (tmp_path / f"{kind}.toml").write_text(f"{text}what = 1\n", encoding="utf-8")
    parts = (
        '[[part]]\nname = "a"\nkind = "property"\nexamples = 1\n[[part]]\nname = "b"\nkind = "x"\n'
    )
    text = f'schema = "meso-robust/campaign/1"\nname = "x"\n{parts}'
    (tmp_path / "second_part.toml").write_text(text, encoding="utf-8")
    (tmp_path / "bad.avi").write_bytes(b"x")
    for name, text, table in (("set", "what = 1\n", "x"), ("table", SET, "time\n1\n")):
        (tmp_path / name).mkdir()
        folder_of(tmp_path / name, text, table)
    words = {"TASK": PAPER, "PLAN": PLAN, "CERTIFICATE": PLAN.with_name("certificate.json")}
    lines = COMMANDS
    for name, path in words.items():
        lines = lines.replace(name, str(path))

    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=lines,
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
    )

    assert done.stdout.splitlines() == [f"{line} | 2" for line in lines.splitlines()]
