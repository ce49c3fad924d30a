"""SAM 3 as a segmenter of ngs-mask --segmenter, with points and boxes for the tracker in Hugging Face's transformers.

  pip install torch numpy pillow 'transformers>=5'
  ngs-mask scene.json --prompts strokes.json -o masks --passes 1 --segmenter 'python3 sam3_segmenter.py'

Hugging Face's client downloads the weights once, after their licence was accepted there; --model may be a folder.
"""
from mask_requests import serve


def load(model, device):
    import torch
    from transformers import Sam3TrackerModel, Sam3TrackerProcessor

    network = Sam3TrackerModel.from_pretrained(model).to(device)
    processor = Sam3TrackerProcessor.from_pretrained(model)

    def segment(picture, prompts):
        marks = {}  # for one picture and one object
        if prompts.points:
            marks.update(input_points=[[prompts.points]], input_labels=[[prompts.labels]])
        if prompts.box:
            marks.update(input_boxes=[[prompts.box]])
        with torch.inference_mode():
            inputs = processor(images=picture, return_tensors="pt", **marks).to(device)
            found = network(**inputs, multimask_output=False)
        return processor.post_process_masks(found.pred_masks.cpu(), inputs["original_sizes"])[0][0, 0]

    return segment


MODULES = {"numpy": "numpy", "PIL": "pillow", "torch": "torch", "transformers": "'transformers>=5'"}
if __name__ == "__main__":
    serve("SAM 3 for ngs-mask --segmenter", "facebook/sam3", MODULES, load)
