"""Replaces Hugging Face's transformers, with only the tracker that the adapter of SAM 3 uses."""
import types

import numpy as np
from expected_calls import check_marks, check_picture, orange


class Tensor(np.ndarray):
    def cpu(self):
        return self


class Inputs(dict):
    def to(self, device):
        assert device == "cpu"
        return self


class Sam3TrackerModel:
    @classmethod
    def from_pretrained(cls, model):
        assert model == "facebook/sam3"
        return cls()

    def to(self, device):
        assert device == "cpu"
        return self

    def __call__(self, pixel_values, original_sizes, multimask_output):
        assert multimask_output is False
        return types.SimpleNamespace(pred_masks=orange(pixel_values[0])[None, None, None].view(Tensor))


class Sam3TrackerProcessor:
    @classmethod
    def from_pretrained(cls, model):
        assert model == "facebook/sam3"
        return cls()

    def __call__(self, images, return_tensors, input_points=None, input_labels=None, input_boxes=None):
        assert return_tensors == "pt"
        check_picture(images)
        one = lambda marks: None if marks is None else marks[0][0]
        check_marks(images, one(input_points), one(input_labels), one(input_boxes))
        return Inputs(pixel_values=images[None], original_sizes=[images.shape[:2]])

    def post_process_masks(self, masks, original_sizes):
        assert isinstance(masks, Tensor) and masks.shape[-2:] == original_sizes[0]
        return [masks[0]]
