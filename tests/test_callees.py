"""What only kernels call has no machine code and no entry of its own."""

from __future__ import annotations

from typing import Any

import pytest
from numba import njit

from meso_robust.kernels import inlined, sealed
from tests.entry import entry


@sealed
def twice(x: float) -> float:
    """Twice a number."""
    return 2.0 * x


@inlined
def more(x: float) -> float:
    """One more."""
    return 1.0 + x


@njit
def kernel(x: float) -> float:
    """Calls both."""
    return more(twice(x))


def test_a_kernel_holds_what_it_calls() -> None:
    assert kernel(3.0) == 7.0
    engine = _overload(kernel).library._codegen._engine
    assert engine.is_symbol_defined(_overload(kernel).fndesc.llvm_func_name)
    for one in (twice, more):
        assert not engine.is_symbol_defined(_overload(one).fndesc.llvm_func_name)


def test_a_call_from_python_is_an_error_and_not_the_end_of_the_process() -> None:
    kernel(3.0)
    with pytest.raises(TypeError, match="bad argument"):
        twice(3.0)


def test_a_test_can_have_an_entry_of_its_own() -> None:
    assert entry(twice)(3.0) == 6.0


def _overload(of: Any) -> Any:
    (only,) = of.overloads.values()
    return only
