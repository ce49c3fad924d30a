"""Writes the results of tests/bench/device.sh as one JSON (data-schema/device.schema.json): device_report.py WORK OUT.json

WORK has smi, steps (name, exit code, seconds), logs/STEP, scenes/SCENE/DEVICE/TOOL.json, and ptxas after a
compilation. Any of them may be missing or truncated. Exit code 1 if a step failed, or none was started.
"""
import json
import math
import pathlib
import sys

work, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def text(path):
    return path.read_text(errors="replace") if path.exists() else ""


def parsed(report):
    try:
        return json.loads(report)
    except ValueError:
        return None


def steps():
    rows = [line.split("\t") for line in text(work / "steps").splitlines()]
    return [{"name": name, "exit": int(code), "seconds": int(seconds)} for name, code, seconds in rows]


def worst_ratios():
    worst = {}
    for line in text(work / "logs" / "parity").splitlines():
        fields = line.split("\t")
        if len(fields) != 5 or fields[0] != "parity":
            continue
        op, ratio = fields[2], float(fields[3])
        ratio = ratio if math.isfinite(ratio) else math.inf
        if op not in worst or ratio > worst[op][0]:
            worst[op] = (ratio, float(fields[4]))
    return [{"op": op, "ratio": ratio if math.isfinite(ratio) else None, "bound": bound}
            for op, (ratio, bound) in worst.items()]


def tools():
    rows = []
    for path in sorted(work.glob("scenes/*/c*/*.json")):
        report = parsed(text(path))
        if not isinstance(report, dict) or "stages" not in report:
            continue
        stages = report["stages"]
        rows.append({"scene": path.parts[-3], "device": report["device"]["kind"], "run": path.stem,
                     "wall_s": stages["wall_s"], "max_rss_mib": stages["max_rss_mib"],
                     "stages": [{"name": stage["name"], "wall_s": stage["wall_s"]} for stage in stages["children"]]})
    return rows


bench = text(work / "logs" / "bench").partition("{")
done = steps()
failed = [step["name"] for step in done if step["exit"] != 0]
result = {"device": text(work / "smi").strip(), "passed": bool(done) and not failed, "failed": failed, "steps": done,
          "parity": worst_ratios(), "benchmark": parsed(bench[1] + bench[2]), "tools": tools(),
          "ptxas": text(work / "ptxas").splitlines()}
out.parent.mkdir(parents=True, exist_ok=True)
unfinished = out.with_name(out.name + ".part")
unfinished.write_text(json.dumps(result, indent=2, allow_nan=False) + "\n")
unfinished.replace(out)
sys.exit(0 if result["passed"] else 1)
