"""SAM 2 as a segmenter of ngs-mask --segmenter.

  pip install torch numpy pillow git+https://github.com/facebookresearch/sam2
  ngs-mask scene.json --prompts strokes.json -o masks --passes 1 --segmenter 'python3 sam2_segmenter.py'

Hugging Face's client downloads the weights once; --model selects others, such as facebook/sam2.1-hiera-tiny.
"""
from mask_requests import serve


def load(model, device):
    import numpy as np
    import torch
    from sam2.sam2_image_predictor import SAM2ImagePredictor

    predictor = SAM2ImagePredictor.from_pretrained(model, device=device)

    def segment(picture, prompts):
        with torch.inference_mode():
            predictor.set_image(picture)
            masks, _, _ = predictor.predict(
                point_coords=np.array(prompts.points, np.float32) if prompts.points else None,
                point_labels=np.array(prompts.labels, np.int32) if prompts.points else None,
                box=np.array(prompts.box, np.float32) if prompts.box else None,
                multimask_output=False,
            )
        return masks[0]

    return segment


MODULES = {
    "numpy": "numpy",
    "PIL": "pillow",
    "torch": "torch",
    "sam2.sam2_image_predictor": "git+https://github.com/facebookresearch/sam2",
}
if __name__ == "__main__":
    serve("SAM 2 for ngs-mask --segmenter", "facebook/sam2.1-hiera-large", MODULES, load)
