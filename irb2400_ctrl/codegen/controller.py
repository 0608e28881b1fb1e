"""A generated package at work: the same calls whether it runs on this computer or on the emulated
target."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.codegen.machine_code.build_cache import load_shared
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.errors import InputError

Array = NDArray[Any]


class Controller(ABC):
    """Calls NAME_init and NAME_step of one package; flat vectors hold the fields of a struct one
    after the other."""

    def __init__(self, package: Package) -> None:
        self.package = package
        self.dtype = np.dtype(np.float32 if package.real == "float" else np.float64)
        block = package.block
        self.sizes = {
            "state": sum(f.size for f in package.state_fields),
            "input": sum(f.size for f in block.inputs),
            "output": sum(f.size for f in block.outputs),
            "parameters": sum(f.size for f in package.parameter_fields),
        }

    @abstractmethod
    def reset(self) -> None:
        """Run NAME_init."""

    @abstractmethod
    def step(self, inputs: ArrayLike) -> tuple[Array, int]:
        """Run NAME_step: (output, status)."""

    @property
    @abstractmethod
    def state(self) -> Array:
        """A copy of the state struct, held outputs at its end."""

    @state.setter
    @abstractmethod
    def state(self, values: ArrayLike) -> None: ...

    def flat(self, kind: str, values: ArrayLike) -> Array:
        """`values` in the package's precision, checked for size."""
        array = np.asarray(values, self.dtype).ravel()
        if array.size != self.sizes[kind]:
            raise InputError(
                f"{self.package.name}: found {array.size} values for the {kind}; expected "
                f"{self.sizes[kind]}"
            )
        return array


class HostController(Controller):
    """The package compiled for this computer, with the flags that make host and target agree bit
    for bit."""

    def __init__(self, package: Package) -> None:
        super().__init__(package)
        source = package.source().replace(f'#include "{package.name}.h"\n', package.header())
        library = load_shared(source)
        self._init = library[f"{package.name}_init"]
        self._step = library[f"{package.name}_step"]
        self._init.restype = ctypes.c_uint32
        self._step.restype = ctypes.c_uint32
        # an empty struct holds one unused real
        self._memory = {
            kind: np.zeros(max(size, 1), self.dtype) for kind, size in self.sizes.items()
        }
        values = np.concatenate([np.zeros(0), *(f.start for f in package.parameter_fields)])
        self._memory["parameters"][: values.size] = values
        self._pointers = {kind: ctypes.c_void_p(m.ctypes.data) for kind, m in self._memory.items()}
        self.reset()

    def reset(self) -> None:
        """Run NAME_init."""
        self.init_status = int(self._init(self._pointers["state"], self._pointers["parameters"]))

    def step(self, inputs: ArrayLike) -> tuple[Array, int]:
        """Run NAME_step: (output, status)."""
        given = self.flat("input", inputs)
        self._memory["input"][: given.size] = given
        at = self._pointers
        status = self._step(at["state"], at["input"], at["parameters"], at["output"])
        return self._memory["output"][: self.sizes["output"]].copy(), int(status)

    @property
    def state(self) -> Array:
        """A copy of the state struct, held outputs at its end."""
        return self._memory["state"][: self.sizes["state"]].copy()

    @state.setter
    def state(self, values: ArrayLike) -> None:
        given = self.flat("state", values)
        self._memory["state"][: given.size] = given

    @property
    def parameters(self) -> Array:
        """A copy of the parameter table."""
        return self._memory["parameters"][: self.sizes["parameters"]].copy()

    @parameters.setter
    def parameters(self, values: ArrayLike) -> None:
        given = self.flat("parameters", values)
        self._memory["parameters"][: given.size] = given
