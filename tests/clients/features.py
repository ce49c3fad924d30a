"""Counts features of a COLMAP database on white and on black mask pixels: features.py DATABASE MASKS (NAME.pgm)."""
import array
import sqlite3
import sys


def read_pgm(path):
    data = open(path, "rb").read()
    magic, width, height, _ = data.split(None, 4)[:4]
    assert magic == b"P5"
    return int(width), data[-int(width) * int(height):]


database, masks = sys.argv[1:]
counts = [0, 0]
images = sqlite3.connect(database).execute(
    "select name, rows, cols, data from images join keypoints using (image_id) where rows > 0")
for name, rows, cols, data in images:
    width, mask = read_pgm(f"{masks}/{name}.pgm")
    values = array.array("f", data)
    for i in range(rows):
        x, y = values[i * cols:i * cols + 2]  # the centre of the first pixel is at 0.5
        counts[mask[int(y) * width + int(x)] == 0] += 1
print(*counts)
