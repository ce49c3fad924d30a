"""Shared by the Python adapters of networks: requests of ngs-mask --segmenter (README.md) and their masks.

An adapter gives `serve` a function that loads its network and returns segment(picture, prompts): picture is [H, W, 3]
uint8, prompts are Prompts, the result is a mask [H, W], larger than 0 on the object.
"""
import argparse
import dataclasses
import importlib
import json
import sys

EXIT_ENVIRONMENT = 8


@dataclasses.dataclass
class Prompts:
    """Pixels of the picture; the centre of the first one is at (0.5, 0.5)."""

    points: list  # [[x, y], ...]
    labels: list  # 1: object, 0: background
    box: list  # [left, top, right, bottom], or None


def require(who, modules):
    """Exits with an install command if one of `modules` ({name: pip package}) is missing."""
    for module, package in modules.items():
        try:
            importlib.import_module(module)
        except ImportError as error:
            print(f"{who}: {module} cannot be imported ({error}); pip install {package}", file=sys.stderr)
            sys.exit(EXIT_ENVIRONMENT)


def read_prompts(path):
    """Drops the expected mask, since a network would reproduce its holes, and background points outside it, which may lie
    in holes. Without an expected mask the points are by hand and all are kept."""
    with open(path, encoding="utf-8") as file:
        prompts = json.load(file)
    points = [p for p in prompts.get("points", []) if p["object"] or "mask" not in prompts]
    boxes = [] if prompts.get("box_of_marks") else prompts.get("boxes", [])
    return Prompts([[p["x"], p["y"]] for p in points], [int(p["object"]) for p in points], boxes[0] if boxes else None)


def answer(segment, request):
    import numpy as np
    from PIL import Image

    with Image.open(request["image"]) as file:
        picture = np.array(file.convert("RGB"))
    mask = np.asarray(segment(picture, read_prompts(request["prompts"]))) > 0
    if mask.shape != picture.shape[:2]:
        raise ValueError(f"the network's mask is {mask.shape}, expected {picture.shape[:2]}")
    Image.fromarray(np.where(mask, 255, 0).astype(np.uint8)).save(request["out"], format="PNG")


def serve(description, default_model, modules, load):
    """Runs an adapter: once for three paths, otherwise for each request line on stdin until stdin closes."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--model", default=default_model, help="name or folder of the weights [%(default)s]")
    parser.add_argument("--device", help="cuda or cpu; default: cuda if available")
    parser.add_argument("paths", nargs="*", metavar="IMAGE PROMPTS OUT", help="segment once")
    options = parser.parse_args()
    if len(options.paths) not in (0, 3):
        parser.error("expected IMAGE PROMPTS OUT, or no arguments")
    require(parser.prog, modules)
    import torch

    device = options.device or ("cuda" if torch.cuda.is_available() else "cpu")
    segment = load(options.model, device)
    if options.paths:
        answer(segment, dict(zip(("image", "prompts", "out"), options.paths)))
        return
    for line in sys.stdin:
        try:
            answer(segment, json.loads(line))
            response = {"ok": True}
        except Exception as error:  # report any exception of a network to the caller
            response = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(response), flush=True)
