"""Work shared with copies of a process: in a process of its own, as nobody else may run threads there."""

from __future__ import annotations

import subprocess
import sys

import pytest

from meso_robust.copies import shared

BEGIN = """
import os, signal, time
from meso_robust import kernels
from meso_robust.copies import allow, shared
allow()
kernels.threads = lambda: 3
from meso_robust import copies
copies.threads = kernels.threads
here = os.getpid()
"""


def said(script: str) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", BEGIN + script]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


def test_without_leave_this_process_does_all() -> None:
    import os

    assert set(shared(lambda _: os.getpid(), range(5))) == {os.getpid()}


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="processes are not copied there")
class TestCopies:
    def test_each_item_is_worked_out_once_and_in_order(self) -> None:
        ended = said(
            "found = shared(lambda k: (time.sleep(0.02), (k, os.getpid()))[1], range(30))\n"
            "print([k for k, _ in found] == list(range(30)), len({pid for _, pid in found}))\n"
            "print(kernels._threads)"
        )
        assert ended.stdout.split("\n")[:2] == ["True 3", "[]"], ended.stderr

    def test_what_is_shared_within_shared_work_is_not_shared_again(self) -> None:
        """Each process has a core; what it works at takes no thread of another's."""
        ended = said(
            "def work(_):\n    time.sleep(0.02)\n    return tuple(kernels._threads)\n"
            "print(set(shared(work, range(9))))"
        )
        assert ended.stdout.strip() == "{(1,)}", ended.stderr

    def test_an_error_is_told_where_it_was_asked_for(self) -> None:
        ended = said(
            "def fails(k):\n    time.sleep(0.02)\n    return 1 // (k - 7)\nshared(fails, range(9))"
        )
        assert ended.returncode == 1
        assert "ZeroDivisionError" in ended.stderr.splitlines()[-1]

    def test_what_an_ended_copy_had_is_worked_out_here(self) -> None:
        ended = said(
            "def work(k):\n"
            "    time.sleep(0.02)\n"
            "    if os.getpid() != here:\n"
            "        os.kill(os.getpid(), signal.SIGKILL)\n"
            "    return k\n"
            "print(shared(work, range(9)))"
        )
        assert ended.stdout.strip() == str(list(range(9))), ended.stderr

    def test_what_a_copy_never_comes_back_from_is_worked_out_here(self) -> None:
        ended = said(
            "copies.PATIENCE = 0.1\n"
            "def work(k):\n"
            "    time.sleep(0.02)\n"
            "    while os.getpid() != here:\n"
            "        time.sleep(1)\n"
            "    return k\n"
            "print(shared(work, range(9)))"
        )
        assert ended.stdout.strip() == str(list(range(9))), ended.stderr

    def test_ctrl_c_ends_the_copies(self) -> None:
        ended = said(
            "from multiprocessing import active_children\n"
            "def work(k):\n"
            "    if os.getpid() == here:\n"
            "        time.sleep(0.3)\n"
            "        os.killpg(0, signal.SIGINT)\n"
            "    time.sleep(30)\n"
            "os.setpgid(0, 0)\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # ignored by what shells run aside
            "try:\n"
            "    shared(work, range(3))\n"
            "except KeyboardInterrupt:\n"
            "    print(active_children())\n"
        )
        assert ended.stdout.strip() == "[]", ended.stderr
