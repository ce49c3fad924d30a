"""Cuts objects out of 3D Gaussian splatting scenes: runs the ngs tools, and reads the splats that they write.

    report = ngs.run("cut", "statue.ply", strokes=["a.json", "b.json"], output="statue")
    columns = ngs.read_ply("statue/object.ply")
"""

from ._error import Error
from ._ply import read_ply
from ._run import run

__all__ = ["Error", "read_ply", "run"]
