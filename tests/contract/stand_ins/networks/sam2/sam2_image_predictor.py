import numpy as np
from expected_calls import check_marks, check_picture, orange


class SAM2ImagePredictor:
    @classmethod
    def from_pretrained(cls, model, device):
        assert (model, device) == ("facebook/sam2.1-hiera-large", "cpu")
        return cls()

    def set_image(self, picture):
        check_picture(picture)
        self.picture = picture

    def predict(self, point_coords, point_labels, box, multimask_output):
        assert multimask_output is False
        check_marks(self.picture, point_coords, point_labels, box)
        mask = orange(self.picture)
        return mask[None].astype(np.float32), np.ones(1, np.float32), np.zeros((1, 256, 256), np.float32)
