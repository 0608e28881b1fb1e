"""Columns of MAT and Parquet files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError, ToolMissingError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.measurement.table import Table, one_length

_MATRIX = re.compile(r"(qd|q|tau)(_ref)?_(\w+)")


def read_parquet_table(path: Path) -> Table:
    """Columns of numbers of a Parquet file.

    Raises:
        InputError: not a Parquet file, or none of its columns holds numbers.
        ToolMissingError: no pyarrow.
    """
    pa = needed("pyarrow", "parquet", "a Parquet file")
    parquet = needed("pyarrow.parquet", "parquet", "a Parquet file")
    try:
        table = parquet.read_table(path)
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path} is not a readable Parquet file: {error}") from error
    numeric = [f.name for f in table.schema if pa.types.is_floating(f.type) or _whole(pa, f.type)]
    columns = {
        name: np.asarray(table[name].to_numpy(), dtype=float) for name in dict.fromkeys(numeric)
    }
    return one_length(path, columns)


def read_mat_table(path: Path) -> Table:
    """Columns of a MAT file: vectors by name, matrices column by column.

    A matrix named like one column (`q_deg`, `tau_Nm`) is one column per joint (`q1_deg`…); any
    other is `name[1]`, `name[2]`… Fields of structures have names with dots (`out.time`).

    Raises:
        InputError: not a MAT file, or columns of different lengths.
        ToolMissingError: a MAT file of version 7.3 and no h5py.
    """
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        found: Any = loadmat(path, squeeze_me=False, struct_as_record=False)
    except NotImplementedError:
        found = _hdf5(path)
    except (OSError, ValueError, TypeError, MatReadError) as error:
        raise InputError(f"{path} is not a readable MAT file: {error}") from error
    columns: dict[str, Array] = {}
    for name, value in found.items():
        if not name.startswith("__"):
            columns.update(_flat(name, value))
    if columns:
        # single numbers (a sampling rate, a load) are no columns
        columns = {name: values for name, values in columns.items() if len(values) > 1}
    return one_length(path, columns)


def _whole(pa: Any, kind: Any) -> bool:
    return bool(pa.types.is_integer(kind))


def _hdf5(path: Path) -> dict[str, Any]:
    """Arrays of a version 7.3 file (HDF5, turned as MATLAB stores them)."""
    try:
        import h5py
    except ImportError as error:
        raise ToolMissingError(
            f"{path} is a MAT file of version 7.3 and h5py is not installed: "
            "pip install 'irb2400_ctrl[mat73]', or save it with -v7"
        ) from error
    found: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and np.issubdtype(item.dtype, np.number):
            found[name.replace("/", ".")] = np.asarray(item).T

    with h5py.File(path) as file:
        file.visititems(visit)
    return {name: value for name, value in found.items() if not name.startswith("#")}


def _flat(name: str, value: Any) -> Iterator[tuple[str, Array]]:
    """Columns of a variable, fields of structures with dots."""
    array = np.asarray(value)
    if array.dtype == object:
        for item in array.ravel():
            for field in getattr(item, "_fieldnames", ()):
                yield from _flat(f"{name}.{field}", getattr(item, field))
    elif array.ndim == 2 and np.issubdtype(array.dtype, np.number):
        numbers = array.astype(float)
        if 1 in numbers.shape:
            yield name, numbers.ravel()
        else:
            for j in range(numbers.shape[1]):
                yield _column(name, j), np.ascontiguousarray(numbers[:, j])


def _column(name: str, j: int) -> str:
    match = _MATRIX.fullmatch(name)
    if match is None:
        return f"{name}[{j + 1}]"
    return f"{match[1]}{j + 1}{match[2] or ''}_{match[3]}"
