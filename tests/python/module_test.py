"""Tests of the module pipelines/python/ngs with the built tools: module_test.py SITE (the folder that contains ngs/)."""

import array
import os
import struct
import sys
import tempfile
import unittest

sys.path.insert(0, sys.argv.pop(1))
import ngs  # noqa: E402
from ngs import _ply, _run  # noqa: E402

HEADER = "ply\nformat {order} 1.0\nelement vertex {rows}\nproperty float x\nproperty uchar red\nproperty double w\nend_header\n"


class Flags(unittest.TestCase):
    def test_keywords_become_options(self):
        options = {"strokes": ["a", "b"], "fit_steps": 100, "keep": True, "force": False, "gt": None, "o": "out"}
        self.assertEqual(_run._flags(options), ["--strokes", "a", "--strokes", "b", "--fit-steps", "100", "--keep",
                                                "--no-force", "-o", "out"])


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, data, name="a.ply"):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)


class Run(InFolder):
    def test_a_command_returns_its_report_and_its_splat_is_read(self):
        report = ngs.run("synth", "two-spheres", output=self.path("scene"), view_count=2, width_px=48, height_px=36, fit_steps=2)
        self.assertEqual(report["tool"], "ngs-synth")
        columns = ngs.read_ply(self.path("scene/point_cloud.ply"))
        self.assertIn("opacity", columns)
        self.assertEqual({len(column) for column in columns.values()}, {len(columns["x"])})
        self.assertGreater(len(columns["x"]), 0)

    def test_a_failure_has_the_exit_code_the_message_and_the_hint_of_the_tool(self):
        with self.assertRaises(ngs.Error) as raised:
            ngs.run("joint", "a.json", "b.ply", output=self.path("c.ply"))
        self.assertEqual(raised.exception.code, 3)
        self.assertTrue(raised.exception.message.startswith("a.json: no such file"))
        with self.assertRaises(ngs.Error) as raised:
            ngs.run("mask", bogus=True)
        self.assertEqual((raised.exception.code, raised.exception.message, raised.exception.remedy),
                         (2, "unknown flag '--bogus'", "see --help"))

    def test_an_empty_report_is_none(self):
        self.assertIsNone(ngs.run("cut", "--help"))


class ReadPly(InFolder):
    ROWS = [(0.5, 7, 1e300), (-2.0, 255, -1.0)]

    def read_both(self, path):
        """The columns with numpy, if it is installed, and without, as lists."""
        results = []
        for module in {id(_ply.numpy): _ply.numpy, id(None): None}.values():
            _ply.numpy, before = module, _ply.numpy
            try:
                results.append({name: list(column) for name, column in ngs.read_ply(path).items()})
            finally:
                _ply.numpy = before
        return results

    def test_columns_of_both_byte_orders_have_the_written_values(self):
        for order, code in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
            rows = b"".join(struct.pack(code + "fBd", *row) for row in self.ROWS)
            for columns in self.read_both(self.write(HEADER.format(order=order, rows=2).encode() + rows + b"more")):
                self.assertEqual(columns, {"x": [0.5, -2.0], "red": [7, 255], "w": [1e300, -1.0]})

    def test_without_numpy_a_column_is_an_array(self):
        _ply.numpy, before = None, _ply.numpy
        self.addCleanup(setattr, _ply, "numpy", before)
        column = ngs.read_ply(self.write(HEADER.format(order="binary_little_endian", rows=0).encode()))["red"]
        self.assertEqual((type(column), column.typecode, len(column)), (array.array, "B", 0))

    def test_hostile_files_are_errors_with_code_3(self):
        whole = HEADER.format(order="binary_little_endian", rows=2)
        for data in (b"", b"png", whole[:-12].encode(), whole.encode() + b"\0" * 25, whole.replace("2\n", f"{10**15}\n").encode(),
                     whole.replace("binary_little_endian", "ascii").encode(), whole.replace("red", "x").encode(),
                     whole.replace("uchar", "list uchar int").encode(), whole.replace("vertex", "face").encode()):
            with self.subTest(data=data), self.assertRaises(ngs.Error) as raised:
                ngs.read_ply(self.write(data))
            self.assertEqual(raised.exception.code, 3)


if __name__ == "__main__":
    unittest.main()
