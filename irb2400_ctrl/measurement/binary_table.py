"""Columns of MAT, HDF5, NumPy and Parquet files."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError, ToolMissingError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.measurement.table import Table, numbered, one_length

MOST_JOINTS = 16
"""a matrix with so few rows and more columns than that holds a sample per column"""
LONG = 20
"""and so does any with so many times more columns than rows"""
MOST_BYTES = 4_000_000_000
"""of unpacked arrays"""

Chosen = Callable[[Collection[str]], Collection[str]]
"""those of a file's columns that count; others may have another length"""


def read_parquet_table(path: Path, chosen: Chosen | None = None) -> Table:
    """Columns of numbers of a Parquet file; instants count in seconds from the first, and the only
    one is `time_s` where no column is called so.

    A list of numbers in every row is a matrix, and its columns have names as those of a MAT file.

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
    columns: dict[str, Array] = {}
    for field in table.schema:
        columns |= _arrow_columns(pa, field.name, table[field.name])
    instants = [field.name for field in table.schema if pa.types.is_timestamp(field.type)]
    if len(instants) == 1 and not any(name.startswith("time_") for name in columns):
        columns = {"time_s": columns[instants[0]], **columns}
    return one_length(path, columns if chosen is None else _only(columns, chosen))


def read_mat_table(path: Path, chosen: Chosen | None = None) -> Table:
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
    return _columns(path, found, chosen)


def _columns(path: Path, found: Mapping[str, Any], chosen: Chosen | None) -> Table:
    """The columns of variables by name."""
    columns: dict[str, Array] = {}
    for name, value in found.items():
        if not name.startswith("__"):
            columns.update(_flat(name, value))
    if columns:
        # single numbers (a sampling rate, a load) are no columns
        columns = {name: values for name, values in columns.items() if len(values) > 1}
    return one_length(path, columns if chosen is None else _only(columns, chosen))


def read_hdf5_table(path: Path, chosen: Chosen | None = None) -> Table:
    """Columns of the arrays in an HDF5 file, groups with dots: `data.demo_0.q[1]`; named as those
    of a MAT file.

    Raises:
        InputError: not an HDF5 file, or columns of different lengths.
        ToolMissingError: no h5py.
    """
    needed("h5py", "mat73", "an HDF5 file")
    try:
        return _columns(path, _hdf5(path), chosen)
    except OSError as error:
        raise InputError(f"{path} is not a readable HDF5 file: {error}") from error


def read_npz_table(path: Path, chosen: Chosen | None = None) -> Table:
    """Columns of the arrays in a NumPy archive; named as those of a MAT file.

    Raises:
        InputError: not an archive of arrays of numbers, or columns of different lengths.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            size = sum(member.file_size for member in packed.infolist())
        if size > MOST_BYTES:
            raise InputError(f"{path}: {size:,} bytes when unpacked, expected a log")
        with np.load(path, allow_pickle=False) as arrays:
            return _columns(path, dict(arrays), chosen)
    except (OSError, ValueError, EOFError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            f"{path} is not a readable NumPy archive of numbers: {error}; expected arrays such as "
            "time_s, q_rad, tau_Nm (np.savez)"
        ) from error


def _only(columns: dict[str, Array], chosen: Chosen) -> dict[str, Array]:
    names = chosen(columns)
    return {name: values for name, values in columns.items() if name in names} or columns


def _arrow_columns(pa: Any, name: str, values: Any) -> dict[str, Array]:
    """Numbers as they are, instants in seconds since the first, lists as `name[1]`, `name[2]`…"""
    kind = values.type
    if pa.types.is_floating(kind) or pa.types.is_integer(kind):
        return {name: np.asarray(values.to_numpy(), dtype=float)}
    if pa.types.is_timestamp(kind):
        stamps = np.asarray(values.to_numpy()).astype("datetime64[ns]")
        # an instant that is missing (NaT) is NaN
        return {name: (stamps - stamps[:1]) / np.timedelta64(1, "s")}
    if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        rows = values.to_pylist()
        width = {-1 if row is None else len(row) for row in rows}
        if len(width) == 1 and min(width) > 0 and not isinstance(rows[0][0], str | list | dict):
            matrix = np.array(rows, dtype=float)
            return {numbered(name, j): matrix[:, j] for j in range(matrix.shape[1])}
    return {}


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
    elif array.ndim > 2 and array.size:
        # joints, one, samples
        inside = array.squeeze()
        if inside.ndim < 3:
            yield from _flat(name, inside)
    elif array.ndim == 1 and np.issubdtype(array.dtype, np.number):
        yield name, array.astype(float)
    elif array.ndim == 2 and np.issubdtype(array.dtype, np.number):
        numbers = array.astype(float)
        m, n = numbers.shape
        if 1 < m <= MOST_JOINTS < n or n > LONG * m > LONG:
            numbers = numbers.T  # a sample per column
        if 1 in numbers.shape:
            yield name, numbers.ravel()
        else:
            for j in range(numbers.shape[1]):
                yield numbered(name, j), np.ascontiguousarray(numbers[:, j])
