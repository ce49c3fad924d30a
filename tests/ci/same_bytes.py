"""Compares the files of OUT/old/SCENE and OUT/new/SCENE, for same-bytes.sh: same_bytes.py OUT SCENE..."""
import json
import re
import sys
from pathlib import Path

OF_THE_RUN = re.compile(r"^\.(version|stages|inputs|outputs|device|threads|isa)([.[]|$)|(_s|\.t|\.path)$")
KINDS = {"old": "keys of the old build only:", "new": "keys of the new build only:",
         "value": "numbers that differ, old / new:", "text": "texts that differ, old / new:"}


def leaves(value, path=""):
    """(path, value) of all values that do not depend on the run, the machine or the folder."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}")
    elif isinstance(value, list):
        for i, item in enumerate(value):
            is_named = isinstance(item, dict) and next(iter(item), "") == "name"
            yield from leaves(item, f"{path}[{item['name'] if is_named else i}]")
    elif not OF_THE_RUN.search(path):
        yield path, value


def compare_json(old, new, file, keys):
    """Adds keys and texts that differ to `keys`; returns whether all numbers are the same."""
    old, new = (dict(leaves(json.loads(path.read_text()))) for path in (old, new))
    same = True
    for path in {**old, **new}:
        kind = "old" if path not in new else "new" if path not in old else ""
        shown = repr(old.get(path, new.get(path)))
        if not kind and shown != repr(new[path]):
            kind = "text" if isinstance(old[path], str) and isinstance(new[path], str) else "value"
            same = same and kind == "text"
            shown += f" / {new[path]!r}"
        if kind:
            keys[kind].setdefault(re.sub(r"\[\d+\]", "[]", path), (shown[:160], file))
    return same


def compare_files(out, scene, keys):
    """(file, status) of each file of either build."""
    old, new = out / "old" / scene, out / "new" / scene
    files = {path.relative_to(side).as_posix() for side in (old, new) for path in side.rglob("*") if path.is_file()}
    for file in sorted(f for f in files if not f.endswith(".log")):
        a, b = old / file, new / file
        if not (a.exists() and b.exists()):
            yield file, "only old" if a.exists() else "only new"
            continue
        is_json = file.endswith(".json")
        same = compare_json(a, b, f"{scene}/{file}", keys) if is_json else a.read_bytes() == b.read_bytes()
        yield file, "same" if same else "different"
    for line in (old / "exit_codes").read_text().splitlines():
        if not line.endswith(" 0"):
            yield line.split()[0], "exit code " + line.split()[1]


def main(out, scenes):
    keys = {kind: {} for kind in KINDS}
    rows = {}  # (scene, run): the status of each file
    with open(out / "artifacts.tsv", "w") as artifacts:
        for scene in scenes:
            for file, status in compare_files(out, scene, keys):
                artifacts.write(f"{scene}\t{file}\t{status}\n")
                parts = file.removeprefix("reports/").split("/")
                rows.setdefault((scene, parts[0] if len(parts) > 1 else "chain"), {})[file] = status
    print(f"{'scene':14} {'run':12} {'files':>6} {'same':>6}")
    rows["all", ""] = {scene + file: status for (scene, _), files in rows.items() for file, status in files.items()}
    for (scene, run), files in rows.items():
        bad = [f"{file} ({status})" for file, status in files.items() if status != "same"]
        more = "  DIFFERENT: " + " ".join(bad[:4] + ["..."] * (len(bad) > 4)) if bad and run else ""
        print(f"{scene:14} {run:12} {len(files):6} {len(files) - len(bad):6}{more}")
    for kind, title in KINDS.items():
        if keys[kind]:
            print("\n" + title)
        for path, (shown, file) in list(keys[kind].items())[:40]:
            print(f"  {path:48} {shown}   ({file})")
        if len(keys[kind]) > 40:
            print(f"  ... and {len(keys[kind]) - 40} more")
    return not rows["all", ""] or any(status != "same" for status in rows["all", ""].values())


sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
