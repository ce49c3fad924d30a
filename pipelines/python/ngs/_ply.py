"""Reads the columns of a splat."""

import array
import os
import struct
from typing import Any, BinaryIO, Dict, List, Tuple, Union

from ._error import Error

try:
    import numpy
except ImportError:  # columns are then array.array
    numpy = None

_BAD_INPUT = 3
# PLY's names of types and those of struct, array and numpy.
_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
          "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply(path: Union[str, "os.PathLike[str]"]) -> Dict[str, Any]:
    """Columns of the vertices of a binary PLY, by name: numpy arrays if numpy is installed, else array.array."""
    with open(path, "rb") as file:
        order, rows, columns = _header(file, os.fspath(path))
        record = struct.Struct(order + "".join(code for _, code in columns))
        data = file.read(record.size * rows) if rows * record.size <= os.fstat(file.fileno()).st_size else b""
    if len(data) != record.size * rows:
        raise Error(_BAD_INPUT, f"{path}: ends before its {rows} vertices do, expected a complete PLY", "copy it again")
    if numpy is not None:
        table = numpy.frombuffer(data, dtype=[(name, order + code) for name, code in columns])
        return {name: numpy.ascontiguousarray(table[name], dtype=table[name].dtype.newbyteorder("="))
                for name, _ in columns}
    values = list(zip(*record.iter_unpack(data))) or [()] * len(columns)
    return {name: array.array(code, values[i]) for i, (name, code) in enumerate(columns)}


def _header(file: BinaryIO, path: str) -> Tuple[str, int, List[Tuple[str, str]]]:
    order, rows, columns, element = "", -1, [], ""
    if file.readline().strip() != b"ply":
        raise Error(_BAD_INPUT, f"{path}: not a PLY file", "expected a splat in PLY; ngs-extract converts other formats")
    while True:
        line = file.readline(4096)
        words = line.decode("utf-8", "replace").split()
        if not line:
            raise Error(_BAD_INPUT, f"{path}: the header does not end, expected end_header", "copy it again")
        if words[:1] == ["end_header"]:
            break
        if words[:1] == ["format"]:
            order = _ORDERS.get(words[1] if len(words) > 1 else "", "")
        elif words[:1] == ["element"] and len(words) == 3:
            if not element and words[1] == "vertex" and words[2].isdecimal():
                rows = int(words[2])
            element = words[1]
        elif words[:1] == ["property"] and element == "vertex":
            if len(words) != 3 or words[1] not in _TYPES or words[2] in [name for name, _ in columns]:
                raise Error(_BAD_INPUT, f"{path}: '{' '.join(words)}', expected scalar properties with distinct names")
            columns.append((words[2], _TYPES[words[1]]))
    if not order or rows < 0 or not columns:
        raise Error(_BAD_INPUT, f"{path}: expected a binary PLY whose first element is vertex",
                    "ngs-extract FILE --object-ply OUT.ply writes one")
    return order, rows, columns
