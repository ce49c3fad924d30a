"""Packs a folder of bundle.sh as a Python wheel, with the standard library only: wheel.py BUNDLE MODULE VERSION PLATFORM OUT

MODULE is the folder of the Python module. Prints the wheel's path. The same inputs give the same bytes.
"""

import base64
import hashlib
import os
import sys
import time
import zipfile
from typing import Dict, List, Tuple

# A wheel has no links: the other names of the program become scripts that pass their name on.
_LINK = '#!/bin/sh\nexec "${0%/*}/ngs" "${0##*/}" "$@"\n'
_METADATA = """Metadata-Version: 2.1
Name: ngs-tools
Version: {version}
Summary: Cuts objects out of 3D Gaussian splatting scenes
License: Apache-2.0
Requires-Python: >=3.9
Description-Content-Type: text/plain

The ngs tools as programs in PATH, and as the module ngs:

    import ngs
    ngs.run("cut", "statue.ply", strokes=["strokes.json"], output="statue")
    columns = ngs.read_ply("statue/object.ply")

For Linux on x86-64 with AVX2 and FMA. Needs no other package; read_ply returns numpy arrays if numpy is installed.
"""
_WHEEL = "Wheel-Version: 1.0\nGenerator: ngs\nRoot-Is-Purelib: false\nTag: {tag}\n"

Entry = Tuple[bytes, bool]  # contents, and whether it is a program


def files_of(folder: str, to: str) -> Dict[str, Entry]:
    found: Dict[str, Entry] = {}
    for path, _, names in os.walk(folder):
        for name in names:
            if name.endswith(".pyc"):
                continue
            source = os.path.join(path, name)
            target = os.path.normpath(os.path.join(to, os.path.relpath(source, folder)))
            if os.path.islink(source):
                found[target] = (_LINK.encode(), True)
            else:
                with open(source, "rb") as file:
                    found[target] = (file.read(), os.access(source, os.X_OK))
    return found


def entry_points(programs: List[str]) -> bytes:
    return ("[console_scripts]\n" + "".join(f"{name} = ngs._run:main\n" for name in sorted(programs))).encode()


def record(entries: Dict[str, Entry], own: str) -> bytes:
    rows = []
    for name in sorted(entries):
        data = entries[name][0]
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        rows.append(f"{name},sha256={digest},{len(data)}\n")
    return ("".join(rows) + own + ",,\n").encode()


def main() -> None:
    bundle, module, version, platform, out = sys.argv[1:]
    tag = "py3-none-" + platform
    info = f"ngs_tools-{version}.dist-info"
    entries = files_of(module, ".")
    entries.update(files_of(os.path.join(bundle, "bin"), "ngs/bin"))
    entries.update(files_of(os.path.join(bundle, "share", "ngs"), "ngs/share/ngs"))
    entries.update(files_of(os.path.join(bundle, "licences"), info + "/licenses"))
    entries[info + "/METADATA"] = (_METADATA.format(version=version).encode(), False)
    entries[info + "/WHEEL"] = (_WHEEL.format(tag=tag).encode(), False)
    entries[info + "/entry_points.txt"] = (entry_points(os.listdir(os.path.join(bundle, "bin"))), False)
    entries[info + "/RECORD"] = (record(entries, info + "/RECORD"), False)
    date = time.gmtime(int(os.environ["SOURCE_DATE_EPOCH"]))[:6]
    path = os.path.join(out, f"ngs_tools-{version}-{tag}.whl")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(entries, key=lambda name: (name.startswith(info), name)):  # as in PEP 427: dist-info last
            data, program = entries[name]
            row = zipfile.ZipInfo(name, date)
            row.compress_type = zipfile.ZIP_DEFLATED
            row.external_attr = (0o100755 if program else 0o100644) << 16
            archive.writestr(row, data)
    print(path)


if __name__ == "__main__":
    main()
