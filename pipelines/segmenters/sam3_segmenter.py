"""SAM 3 as the program of ngs-mask --segmenter, by the tracker in Hugging Face's transformers: it takes points and boxes.

  pip install torch numpy pillow 'transformers>=5'
  ngs-mask scene.json --prompts strokes.json -o masks --passes 1 --segmenter 'python3 sam3_segmenter.py'

The weights are fetched once by Hugging Face's client, where their licence has to be accepted; --model names a folder.
"""
from mask_requests import serve


def load(model, device):
    import torch
    from transformers import Sam3TrackerModel, Sam3TrackerProcessor

    network = Sam3TrackerModel.from_pretrained(model).to(device)
    processor = Sam3TrackerProcessor.from_pretrained(model)

    def segment(picture, prompts):
        marks = {}  # of one picture, of one object in it
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
