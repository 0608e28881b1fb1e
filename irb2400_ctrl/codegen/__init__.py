"""C99 from CasADi expressions: machine code for this computer, packages for embedded targets,
checks on an emulator."""

from irb2400_ctrl.codegen.block import Block, CompiledBlock, Field, compile_block
from irb2400_ctrl.codegen.build import CompiledFunction, FunctionBuffers, compile_function
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.verification import Verification, export_package

__all__ = [
    "Block",
    "CompiledBlock",
    "CompiledFunction",
    "Field",
    "FunctionBuffers",
    "HostController",
    "Package",
    "Verification",
    "compile_block",
    "compile_function",
    "export_package",
]
