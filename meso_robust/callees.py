"""A compiler of functions that only kernels call: it makes no machine code of them.

Numba makes machine code of every function that it compiles, though what goes into a kernel is LLVM's code.
Leaving it out takes an eighth off the time of compiling. See "Customizing the compiler" in Numba's manual.
"""

from __future__ import annotations

from typing import Any

from llvmlite.binding import address_of_symbol
from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import NativeLowering

NO_ENTRY = "PyErr_BadArgument"
"""What Python calls instead: it raises a TypeError."""


class _Library(JITCodeLibrary):
    """LLVM's code of a function, for libraries that link it in."""

    def _finalize_final_module(self) -> None:
        """As Numba's, but it is not handed to the engine, which would make machine code of it."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    """As Numba's, into such a library."""

    _name = "lowering_of_callees"

    def run_pass(self, state: Any) -> bool:
        """Lower a function and make it known to its callers."""
        library = _Library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library, state.flags.no_compile = library, True
        super().run_pass(state)
        found = state["cr"]
        name = found.fndesc.qualname.split(".")[-1]
        nowhere = address_of_symbol(NO_ENTRY)
        entry = _dynfunc.make_function(
            found.fndesc.lookup_module(), name, "", nowhere, found.env, (library,)
        )
        state.targetctx.insert_user_function(entry, found.fndesc, [library])
        state.reload_init.extend(library._reload_init)
        state["cr"] = found._replace(cfunc=entry)
        return True


class Callees(CompilerBase):
    """Numba's compiler with that lowering; for ``pipeline_class`` of its decorators."""

    def define_pipelines(self) -> list[PassManager]:
        """One pipeline, as Numba's, with its last but one pass replaced."""
        usual = DefaultPassBuilder.define_nopython_pipeline(self.state)
        own = PassManager("callees")
        for made, why in usual.passes:
            own.add_pass(_Lowering if made is NativeLowering else made, why)
        own.finalize()
        return [own]
