"""Checks of the calls to the replaced networks, and the mask that they return."""
import numpy as np


def check_picture(picture):
    assert picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3, "expected [H, W, 3] uint8"


def check_marks(picture, points, labels, box):
    """points [N, 2], labels [N], box [4], or None, all within the picture."""
    assert points is not None or box is not None, "neither points nor a box"
    if points is not None:
        points, labels = np.asarray(points), np.asarray(labels)
        assert points.ndim == 2 and points.shape[1] == 2 and labels.shape == points.shape[:1]
        assert set(labels.tolist()) <= {0, 1} and 1 in labels
        assert (points >= 0).all() and (points < picture.shape[1::-1]).all()
    if box is not None:
        left, top, right, bottom = np.asarray(box)
        assert 0 <= left < right <= picture.shape[1] and 0 <= top < bottom <= picture.shape[0]


def orange(picture):
    """The orange pixels of an image: the object of the recipe two-spheres."""
    red, blue = picture[:, :, 0].astype(int), picture[:, :, 2].astype(int)
    return red > 1.5 * blue + 20
