"""Run the derivations; write the generated code and the report that they give."""

from __future__ import annotations

import json
import multiprocessing
import signal
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import resource_tracker
from pathlib import Path

import sympy as sp
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.pycode import PythonCodePrinter

from derivations import _kept, _mathml, report
from derivations._derivation import Derivation, Function
from derivations._dimension import check, require_dyadic
from derivations._statement import DerivationError

ROOT = Path(__file__).resolve().parent.parent
GENERATED = ROOT / "meso_robust" / "_generated"
SOURCES = (
    "three_point_support",
    "time_stepping",
    "fit_objective",
    "invariances",
    "one_point_sticking",
    "sticking_motion",
    "two_point_sticking",
    "t2_motion",
    "two_sided_rotation",
    "rotation_existence",
    "round_tips",
    "opposite_edges",
    "unequal_friction",
    "jam",
    "contact_forces",
    "final_orientation",
    "sampling",
    "y_translation",
    "final_pose",
    "symmetries",
    "polygon_edge",
    "drag_tensor",
    "uneven_film",
    "slot_walls",
    "contact_response",
    "dry_sticking",
    "printed_numbers",
)
"""Derivation files, in the order in which a reader of the paper meets their claims."""

LONGEST = 12_000
"""Characters of MathML of a condition on a page; nobody reads a longer one, and no proof rests on it."""

HEADER = '''"""{summary}

Generated from derivations/{name}.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any
'''


SCRIPT_HEADER = """// Formulas of the pages that move, by derivation file.
// Generated from derivations/ by `meso-robust derive`; do not edit.
// Angles are in rad, all lengths in one unit; every function returns an array.
"""


class _Printer(PythonCodePrinter):
    """Prints functions as ``ops.name`` so that one source serves every arithmetic."""

    def _print_Function(self, expr: sp.Function) -> str:
        return f"ops.{expr.func.__name__}({', '.join(map(self._print, expr.args))})"

    _print_sin = _print_cos = _print_log = _print_Function

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        if expr.exp == sp.Rational(1, 2):
            return f"ops.sqrt({self._print(expr.base)})"
        if expr.exp == sp.Rational(-1, 2):
            return f"1/ops.sqrt({self._print(expr.base)})"
        return str(super()._print_Pow(expr, rational=rational))


def derive_one(name: str) -> Derivation:
    """Run one derivation and check the units and constants of what it would generate.

    Parameters
    ----------
    name
        One of `SOURCES`.

    Returns
    -------
    Derivation
        Its claims, each decided, and its functions.

    Raises
    ------
    DerivationError
        If a step does not hold.
    """
    derivation: Derivation = import_module(f"derivations.{name}").derive()
    for label, function in derivation.functions.items():
        check(function, f"{name}.{label}")
        for result in function.results:
            require_dyadic(result)
    return derivation


def derive_all() -> tuple[Derivation, ...]:
    """Every derivation: as it was kept where nothing has changed, the others run on all cores.

    Returns
    -------
    tuple[Derivation, ...]
        In the order of `SOURCES`.

    Raises
    ------
    DerivationError
        If a step does not hold, or two claims share a key.
    """
    kept = {name: _kept.load(name) for name in SOURCES}
    missing = [name for name, derivation in kept.items() if derivation is None]
    digests = [_kept.key(name) for name in missing]
    fresh = _on_all_cores(missing) if missing else ()
    for derivation, digest in zip(fresh, digests, strict=True):
        _kept.keep(derivation, digest)
    by_name = kept | dict(zip(missing, fresh, strict=True))
    derivations = tuple(item for item in by_name.values() if item is not None)
    keys = [claim.key for derivation in derivations for claim in derivation.claims]
    twice = sorted({key for key in keys if keys.count(key) > 1})
    if twice:
        raise DerivationError(f"claims share a key: {', '.join(twice)}")
    return derivations


def _on_all_cores(names: Sequence[str]) -> tuple[Derivation, ...]:
    """The derivations of that name; after Ctrl-C or a step that does not hold, no process is left at work."""
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(mp_context=context)
    resource_tracker.ensure_running()  # starting it later would lift the mask
    # Ctrl-C in a terminal goes to every process; only this one is to hear it
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        found = pool.map(derive_one, names)  # starts the processes, which inherit the mask
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        return tuple(found)
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.kill()
        raise
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        pool.shutdown(cancel_futures=True)


def code(derivations: tuple[Derivation, ...]) -> dict[Path, str]:
    """Contents of the generated files by path: a module a derivation, a script of them all, formulas.

    Parameters
    ----------
    derivations
        As :func:`derive_all` returns them.

    Returns
    -------
    dict[Path, str]
        The same bytes every time, so that a file that differs was edited or is out of date.
    """
    files = {GENERATED / f"{d.name}.py": _module(d) for d in derivations if d.functions}
    files[GENERATED / "conditions.json"] = _conditions(derivations, files)
    files[GENERATED / "__init__.py"] = (
        '"""Code generated from derivations/ by `meso-robust derive`; do not edit."""\n'
    )
    files[GENERATED / "formulas.js"] = _script(derivations)
    return files


def on_disk() -> set[Path]:
    """Every file that lies where :func:`code` and :func:`derivations.report.render` write.

    Returns
    -------
    set[Path]
        What is in it beyond what they write is left over from an earlier state.
    """
    found = {*GENERATED.glob("*.py"), *GENERATED.glob("*.js*"), *report.FOLDER.rglob("*")}
    return {path for path in found if path.is_file()}


def _module(derivation: Derivation) -> str:
    parts = [HEADER.format(summary=derivation.summary, name=derivation.name)]
    parts += [_function(name, function) for name, function in derivation.functions.items()]
    return "\n\n".join(parts)


def _function(name: str, function: Function) -> str:
    printer = _Printer({"fully_qualified_modules": False})
    shared, finals = sp.cse(function.results, order="canonical")
    lines = [f"    {symbol} = {printer.doprint(value)}" for symbol, value in shared]
    values = "".join(f"        {printer.doprint(value)},\n" for value in finals)
    inputs = ", ".join(f"{symbol}: Any" for symbol in function.arguments)
    body = "".join(line + "\n" for line in lines)
    return (
        f"def {name}(ops: Any, {inputs}) -> tuple[Any, ...]:\n"
        f'    """Return {function.meaning}."""\n{body}    return (\n{values}    )\n'
    )


def _conditions(derivations: tuple[Derivation, ...], modules: dict[Path, str]) -> str:
    """That their values are positive, as MathML by the name of the generated function."""
    found = {
        f"{d.name}.{name}": _mathml.positive(modules[GENERATED / f"{d.name}.py"], name)
        for d in derivations
        for name in d.functions
    }
    short = {name: shown for name, shown in sorted(found.items()) if sum(map(len, shown)) < LONGEST}
    return json.dumps(short, indent=1, ensure_ascii=False) + "\n"


def _script(derivations: tuple[Derivation, ...]) -> str:
    """The same functions in JavaScript, for pages that nothing else comes with."""
    groups = (
        f"  {d.name}: {{\n{''.join(map(_method, d.functions, d.functions.values()))}  }},\n"
        for d in derivations
        if d.functions
    )
    return f"{SCRIPT_HEADER}const formulas = {{\n{''.join(groups)}}};\n"


def _method(name: str, function: Function) -> str:
    printer = JavascriptCodePrinter()
    shared, finals = sp.cse(function.results, order="canonical")
    body = "".join(
        f"      const {symbol} = {printer.doprint(value)};\n" for symbol, value in shared
    )
    values = ", ".join(printer.doprint(value) for value in finals)
    inputs = ", ".join(str(symbol) for symbol in function.arguments)
    head = f"    // {function.meaning}\n    {name}({inputs}) {{\n"
    return f"{head}{body}      return [{values}];\n    }},\n"
