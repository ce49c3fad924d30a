#!/usr/bin/env python3
"""Results of tests/bench/results.sh and their tables; writes to stdout.

  results_table.py collect                        lines of a question on stdin -> JSON (data-schema/result.schema.json)
  results_table.py table FILE DEFAULTS            markdown; DEFAULTS: hash of the tools' current default options
  results_table.py page PAGE RESULTS_DIR DEFAULTS the page with all its blocks <!-- result: QUESTION --> filled
  results_table.py help FILE                      the C++ header with the table of --quality
  results_table.py value FILE KEY SHOW [KEY=VALUE...]   one number; SHOW: mean, median, least or most
  results_table.py score METRICS KEY              one number of a metrics.json of ngs-eval
  results_table.py about FILE                     wall seconds, a tab, the title
  results_table.py check DIR PAGE... -- QUESTION... [-- SEPARATE...]   the files in DIR and the blocks of all PAGEs are
                                                  those of the questions, and all results but those of the separate
                                                  questions are of one commit and machine

Fields of a line are separated by tabs; a row is a single run:
  meta   KEY VALUE                    question, title, commit, machine, command, defaults, seconds
  column NAME UNIT KEY SHOW [DIGITS] [KEY=VALUE]   DIGITS as 4, or 2g for significant ones; a label has none. change and
                                      ratio refer to the first line with the same labels but the last
  row    KEY=VALUE...                 VALUE is a number if a non-label column shows KEY; rounded to 7 digits
         scores=FILE, halves=FILE     adds the scores of a metrics.json of ngs-eval, with --halves
         instances=FOLDER             adds the scores and counts of scores.json of ngs-eval --instances, and the mean
                                      confidence of groups/objects.json of matched predictions and of the others
         times=FILE                   adds wall_s, cpu_s and peak_mib of a tool's report
  rows   benchmark|stability FILE     a row per kernel of google-benchmark's medians or of stability.json
"""
import json
import math
import os
import re
import statistics
import sys

SHOWS = "label mean median least most each change ratio".split()
HEAD = "question title commit machine command defaults seconds".split()
BEGIN, END = re.compile(r"<!-- result: (\S*) -->$"), "<!-- /result -->"


def refuse(found, expected):
    raise ValueError(f"'{found}', expected {expected}")


def rounded(value):
    return float(f"{float(value):.7g}")


def finite(text):
    if not re.fullmatch(r"[+-]?[0-9.]+(e[+-]?[0-9]+)?", text):
        refuse(text, "a finite number")
    return float(text)


def pair(word):
    key, equals, value = word.partition("=")
    if not key or not equals:
        refuse(word, "KEY=VALUE")
    return key, value


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read_result(path):
    result = load(path)
    for key in HEAD + ["columns", "rows"]:
        if key not in result:
            refuse(f"{path}: no {key}", "data-schema/result.schema.json")
    return result


# ---- collect


def scores_of(path):
    mean = load(path)["mean"]
    return {key: rounded(mean[key]) for key in ("iou", "biou", "biou_005")}


def times_of(path):
    stages = load(path)["stages"]
    names = {"wall_s": "wall_s", "cpu_s": "cpu_s", "peak_mib": "max_rss_mib"}
    return {key: rounded(stages[name]) for key, name in names.items()}


def halves_of(path):
    file = load(path)
    background = file["background"]
    groups = {"seen_": file["object"]["seen"], "unseen_": file["object"]["unseen"], "photos_": background["photos"],
              "new_": background["new"], "": background, "outside_": background["outside_change"]}
    return {prefix + key: rounded(value) for prefix, values in groups.items() for key, value in values.items()
            if isinstance(value, (int, float)) and not isinstance(value, bool)}


def instances_of(folder):
    scores = load(os.path.join(folder, "scores.json"))
    confidence = {entry["id"]: entry["confidence"] for entry in load(os.path.join(folder, "groups/objects.json"))["objects"]}
    matched = {entry["predicted_id"] for entry in scores["objects"] if entry["matched"]}
    row = {key: rounded(value) for key, value in (scores["mean"] | scores["counts"]).items()}
    for name, is_matched in ("matched", True), ("others", False):
        values = [confidence[entry["id"]] for entry in scores["predictions"] if (entry["id"] in matched) == is_matched]
        if values:
            row["confidence_" + name] = rounded(statistics.fmean(values))
    return row


def benchmark_rows(path):
    rows = []
    for entry in load(path)["benchmarks"]:
        if entry.get("aggregate_name") != "median":
            continue
        kernel, _, isa = entry["run_name"].partition("/")
        row = {"kernel": kernel.replace("_", " "), "isa": isa or "-", "cpu_ms": rounded(entry["cpu_time"])}
        if "pairs/s" in entry:
            row["mega_pairs_s"] = rounded(1e-6 * entry["pairs/s"])
        rows.append(row)
    return sorted(rows, key=lambda row: row["kernel"])  # the file has completion order


GROUPS = {"losses": "align,continuity,mask loss,photometric,smoothness", "end to end": "invariance,joint,masks",
          "solvers": "adam,anderson,label solve,pose step"}  # small suites share a row


def worst_of(case, key):
    values = [at[key] for at in case["sweep"] if at[key] is not None]
    return max([0.0] + [float(v) if isinstance(v, (int, float)) else math.inf for v in values])  # text: a wrong result


def stability_rows(path):
    rows = {}
    for case in load(path)["cases"]:
        kernel = next((group for group, names in GROUPS.items() if case["kernel"] in names.split(",")), case["kernel"])
        row = rows.setdefault(kernel, {"kernel": kernel, "cases": 0, "exact": 0, "failed": 0, "textbook": 0,
                                       "textbook_wrong": 0})
        row["cases"] += 1
        row["failed"] += not case["passed"]
        if case["budget"] > 0:
            row["worst_ratio"] = max(row.get("worst_ratio", 0.0), rounded(worst_of(case, "ratio")))
        else:
            row["exact"] += 1
        if case["textbook"].startswith("not applicable"):
            continue
        row["textbook"] += 1
        textbook = worst_of(case, "textbook_ratio")
        if math.isfinite(textbook):
            row["textbook_ratio"] = max(row.get("textbook_ratio", 0.0), rounded(textbook))
        else:
            row["textbook_wrong"] += 1
    return list(rows.values())


def column_of(words):
    if len(words) < 5 or words[4] not in SHOWS:
        refuse(words, f"column NAME UNIT KEY SHOW [DIGITS] [WHERE], SHOW one of {SHOWS}")
    column = {"name": words[1], "unit": words[2], "key": words[3], "show": words[4]}
    if not column["unit"]:
        del column["unit"]
    if words[4] == "label":
        return column
    if len(words) < 6:
        refuse(words[1], "the DIGITS of this column")
    column["digits"] = int(words[5].removesuffix("g"))
    if words[5].endswith("g"):
        column["scientific"] = True
    if len(words) > 6:
        column["where"] = dict([pair(words[6])])
    return column


def row_of(words, columns):
    readers = {"scores": scores_of, "halves": halves_of, "instances": instances_of, "times": times_of}
    numeric = {column["key"] for column in columns if column["show"] != "label"}
    row = {}
    for key, value in map(pair, words):
        if key in readers:
            row.update(readers[key](value))
        else:
            row[key] = rounded(finite(value)) if key in numeric else value
    return row


def collect(lines):
    result = dict.fromkeys(HEAD, "") | {"seconds": 0, "columns": [], "rows": []}
    for line in lines:
        words = line.rstrip("\n").split("\t")
        if words[0] == "meta" and len(words) > 1 and words[1] in HEAD:
            value = words[2] if len(words) > 2 else ""
            result[words[1]] = round(finite(value)) if words[1] == "seconds" else value
        elif words[0] == "column":
            result["columns"].append(column_of(words))
        elif words[0] == "row" and len(words) > 1:
            result["rows"].append(row_of(words[1:], result["columns"]))
        elif words[0] == "rows" and words[1] in ("benchmark", "stability"):
            result["rows"] += (benchmark_rows if words[1] == "benchmark" else stability_rows)(words[2])
        elif words != [""]:
            refuse(line, "meta, column, row or rows with their fields")
    names = [str({key: value for key, value in row.items() if isinstance(value, str)}) for row in result["rows"]]
    if len(set(names)) < len(names):
        refuse("two rows with the same labels", "unique rows; give each a run=NAME")
    return result


def json_text(result):
    def dumped(value):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))

    def listed(items):
        return "[" + "".join(("\n    " if i == 0 else ",\n    ") + dumped(item) for i, item in enumerate(items)) + "\n  ]"

    head = "".join(f'  "{key}": {dumped(result[key])},\n' for key in HEAD)
    return "{\n" + head + f'  "columns": {listed(result["columns"])},\n  "rows": {listed(result["rows"])}\n}}\n'


# ---- tables


def lines_of(result):
    """{labels: rows} in the order of their first rows."""
    keys = [column["key"] for column in result["columns"] if column["show"] == "label"]
    lines = {}
    for row in result["rows"]:
        labels = tuple(row.get(key, "") if isinstance(row.get(key), str) else "" for key in keys)
        lines.setdefault(labels, []).append(row)
    return lines


def numbers_of(rows, key, where):
    return [row[key] for row in rows if isinstance(row.get(key), (int, float)) and
            all(row.get(name) == value for name, value in where.items())]


def number_text(value, column, sign=""):
    text = f"{value:{sign}.{column['digits']}{'g' if column.get('scientific') else 'f'}}"
    text = re.sub(r"e\+0*", "e", text)
    return text if re.search("[1-9]", text) else text.lstrip("+-")


def aggregate(numbers, show):
    if show in ("least", "most"):
        return min(numbers) if show == "least" else max(numbers)
    return statistics.median(numbers) if show in ("median", "ratio") else sum(numbers) / len(numbers)


def cell_of(lines, labels, column):
    show, where = column["show"], column.get("where", {})
    numbers = numbers_of(lines[labels], column["key"], where)
    if not numbers:
        return ""
    if show == "each":
        return ", ".join(number_text(number, column) for number in numbers)
    value = aggregate(numbers, show)
    if show not in ("change", "ratio"):
        return number_text(value, column)
    reference = next(other for other in lines if other[:-1] == labels[:-1])
    before = numbers_of(lines[reference], column["key"], where)
    if reference == labels or not before:
        return ""
    by = aggregate(before, show)
    return number_text(value - by, column, "+") if show == "change" else number_text(value / by, column) + "x"


def cells_of(result):
    columns, lines = result["columns"], lines_of(result)
    table = [[" ".join(filter(None, (column["name"], column.get("unit")))) for column in columns]]
    for labels in lines:
        own = iter(labels)
        table.append([next(own) if column["show"] == "label" else cell_of(lines, labels, column) for column in columns])
    return table


def markdown_of(result, defaults):
    def line(cells):
        return "|" + "".join((f" {cell} " if cell else " ") + "|" for cell in cells) + "\n"

    head, *body = [[cell.replace("|", "\\|") for cell in cells] for cells in cells_of(result)]
    rule = "|" + "".join("---|" if column["show"] == "label" else "---:|" for column in result["columns"]) + "\n"
    seconds = result["seconds"]
    time = f", {seconds:.0f} s" if seconds < 90 else f", {math.floor(seconds / 60 + 0.5)} min"
    changed = " Tools' default options have changed since." if result["defaults"] not in ("", defaults) else ""
    title = result["title"] + "."
    source = (f"Commit `{result['commit']}`, {result['machine']}{time if seconds else ''}: "
              f"`{result['command']}`.{changed}")
    between = " " if len((title + source).encode()) < 140 else "\n"  # the width of a page
    return line(head) + rule + "".join(map(line, body)) + "\n" + title + between + source + "\n"


def help_header_of(result):
    table, columns = cells_of(result), result["columns"]
    widths = [max(map(len, cells)) for cells in zip(*table)]
    rows = ["  " + "  ".join(cell.ljust(width) if column["show"] == "label" else cell.rjust(width)
                             for cell, width, column in zip(cells, widths, columns)) for cells in table]
    return (f"#pragma once\n// Written by tests/bench/results.sh from tests/bench/results/{result['question']}.json; "
            "do not edit.\n\nnamespace ngs::joint {\n\ninline constexpr const char* kQualityTable =\n"
            f'    "quality, as measured: {result["title"]}\\n"\n' +
            "\n".join(f'    "{row}\\n"' for row in rows) + ";\n\n}  // namespace ngs::joint\n")


def value_of(result, key, show, where):
    if show not in ("mean", "median", "least", "most"):
        refuse(show, "mean, median, least or most")
    numbers = numbers_of(result["rows"], key, dict(map(pair, where)))
    if not numbers:
        refuse(key, f"a number of {result['question']} under these conditions")
    return aggregate(numbers, show)


# ---- pages


def with_blocks(page, text_of):
    """The page with every block's text replaced by text_of(QUESTION)."""
    filled, question = "", None
    for line in page.splitlines():
        begin = BEGIN.match(line)
        if (begin and question) or (line == END and not question):
            refuse(line, "blocks that are closed before the next")
        if not question or line == END:
            filled += line + "\n"
            question = None
        if begin:
            question = begin[1]
            filled += text_of(question)
    if question:
        refuse(question, "a closed block")
    return filled


def filled_page(page, folder, defaults):
    def text_of(question):
        path = os.path.join(folder, question + ".json")
        if not os.path.exists(path):
            return f"Not measured yet: `tests/bench/results.sh {question}`.\n"
        return markdown_of(read_result(path), defaults)

    with open(page, encoding="utf-8") as file:
        return with_blocks(file.read(), text_of)


def check(words):
    folder, questions = words[0], words[words.index("--") + 1:]
    separate = questions[questions.index("--") + 1:] if "--" in questions else []
    results = {name.removesuffix(".json"): read_result(os.path.join(folder, name))
               for name in os.listdir(folder) if name.endswith(".json")}
    shown = []
    for page in words[1:words.index("--")]:
        with open(page, encoding="utf-8") as file:
            rest = with_blocks(file.read(), lambda question: shown.append(question) or "")
        for row in rest.splitlines():  # a number with two decimals or a unit, outside of the blocks
            if re.match(r"\|.*(?:[ |(~][+-]?\d*\.\d\d+(?:[ |,;)x]|$)|\d (?:CPU )?(?:s|ms|min|MiB|GiB|dB)\b)", row):
                refuse(f"{page}: {row}", "measurements in blocks of results only")
    for found, name in ((shown, "blocks"), (results, "results"), ((r["question"] for r in results.values()), "names")):
        if set(found) != set(questions) - {"--"}:
            refuse(f"{name} {sorted(found)}", f"those of the questions: {sorted(questions)}")
    for key in ("commit", "machine"):
        if len({result[key] for name, result in results.items() if name not in separate}) != 1:
            refuse(f"results of several {key}s", "one")


def main(command, *words):
    if command == "collect":
        print(json_text(collect(sys.stdin)), end="")
    elif command == "table":
        print(markdown_of(read_result(words[0]), words[1]), end="")
    elif command == "page":
        print(filled_page(*words), end="")
    elif command == "help":
        print(help_header_of(read_result(words[0])), end="")
    elif command == "value":
        print(f"{value_of(read_result(words[0]), words[1], words[2], words[3:]):.10g}")
    elif command == "score":
        print(f"{scores_of(words[0])[words[1]]:.10g}")
    elif command == "about":
        result = read_result(words[0])
        print(f"{result['seconds']}\t{result['title']}")
    elif command == "check":
        check(list(words))
    else:
        refuse(command, "a command; see the head of this file")


if __name__ == "__main__":
    try:
        main(*(sys.argv[1:] or [""]))
    except (ValueError, KeyError, IndexError, TypeError, OSError) as error:
        sys.exit(f"error: {error!r}")
