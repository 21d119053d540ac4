#!/usr/bin/env python3
"""Time of a night against scans, cores and hosts: fitted to what stores' units took, then carried to 100,000 scans.

    python3 bench/scaling/model.py STORE... [--out DIR]

STORE: stores of `hybrid batch run`, of scenes as different in size as there are; made on an idle machine with one thread
per unit. Writes model.md and model.svg. The limits that no store can tell (below) are of common machines.
"""
import argparse
import json
import pathlib

# Per scene of an archive, measured with 1,000 scenes of three scans on one core: see README.md.
PLAN_S, PLAN_AGAIN_S = 0.0092, 0.0052  # hybrid batch plan, first and following nights
READ_MANIFEST_S, READ_MANIFEST_BYTES = 3e-7, 600  # what each process of a run starts with: manifest.py
PROCESSES = 2  # of a task that read it: the engine and a worker
# Operations on files of a scene with its share of plan and report, and of each of its scans, counted by tests/archive/power.
OPERATIONS_SCENE, OPERATIONS_SCAN = 160, 260
# A shared file system: operations and bytes per second of all hosts together.
FILE_OPERATIONS, FILE_BYTES = 5_000, 1e9
# Slurm: tasks that a controller starts per second, and what a task costs by being one.
TASKS_PER_S, TASK_S, BUNDLE_S = 30, 0.2, 30


def view_pixels(summary):
    return sum(view["size"][0] * view["size"][1] for view in summary["views"])


def rows_of(store):
    """Per unit of a store: kind, samples, pixels of views, photographs' bytes, CPU seconds, peak bytes, bytes written."""
    for record_file in sorted(pathlib.Path(store).glob("objects/*/*/record.json")):
        folder = record_file.parent
        record = json.loads(record_file.read_text())
        kind = record["unit"].split()[0]
        if kind == "report":
            continue
        summary = json.loads((folder / "summary.json").read_text())
        scans = summary["scans"] if kind == "scene" else summary.get("scans", [summary])
        sealed = json.loads((folder / "object.json").read_text())
        written = sum(file["bytes"] for file in sealed["files"] + record["files"])
        photographs = 0
        if kind == "scene":
            photographs = sum(i["bytes"] for i in summary["inputs"]
                              if i["file"].lower().endswith((".jpg", ".jpeg", ".png")))
        yield {"kind": kind, "unit": record["unit"], "samples": sum(s.get("input_samples", 0) for s in scans),
               "pixels": view_pixels(summary) if kind == "scene" else 0, "photographs": photographs,
               "cpu_s": record["cpu_s"], "memory": record["memory_bytes"], "bytes": written, "scans": len(scans)}


def solve(matrix, right):
    """Gauss with pivoting; a row that is nothing gives 0."""
    size = len(right)
    rows = [matrix[i][:] + [right[i]] for i in range(size)]
    for i in range(size):
        pivot = max(range(i, size), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        if abs(rows[i][i]) < 1e-30:
            continue
        for r in range(size):
            if r != i:
                factor = rows[r][i] / rows[i][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    return [rows[i][size] / rows[i][i] if abs(rows[i][i]) >= 1e-30 else 0 for i in range(size)]


def fit(rows, what, terms):
    """Least squares of relative errors, no negative coefficients: {term: coefficient}."""
    left = ["one"] + terms
    while True:
        data = [([1 if t == "one" else r[t] for t in left], r[what]) for r in rows]
        matrix = [[sum(x[i] * x[j] / y ** 2 for x, y in data) for j in range(len(left))] for i in range(len(left))]
        right = [sum(x[i] / y for x, y in data) for i in range(len(left))]
        found = dict(zip(left, solve(matrix, right)))
        negative = [t for t in left if found[t] < 0]
        if not negative:
            return found
        left.remove(min(negative, key=lambda t: found[t]))


def value(model, row):
    return sum(c * (1 if t == "one" else row[t]) for t, c in model.items())


def night(scenes, scans_per_scene, scene_s, scene_bytes, longest_s, cores, hosts, slurm):
    """Seconds by what limits them: {name: seconds}, of a first night."""
    work = scenes * scene_s
    tasks = max(1, work / BUNDLE_S) if slurm else 0
    start = PROCESSES * READ_MANIFEST_S * scenes + TASK_S if slurm else READ_MANIFEST_S * scenes
    operations = scenes * (OPERATIONS_SCENE + scans_per_scene * OPERATIONS_SCAN)
    return {"plan": PLAN_S * scenes,
            "computing": (work + tasks * start) / (cores * hosts) + longest_s,
            "files": operations / FILE_OPERATIONS, "bytes": scenes * scene_bytes / FILE_BYTES,
            "scheduler": tasks / TASKS_PER_S}


def total(parts):
    """Computing, files and scheduler overlap; planning comes before."""
    return parts["plan"] + max(parts["computing"], parts["files"], parts["bytes"], parts["scheduler"])


def clock(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def plot(curves):
    """Seconds against scans, both logarithmic, a line per machine."""
    import math
    x = lambda n: 70 + 120 * (math.log10(n) - 1)
    y = lambda s: 330 - 50 * math.log10(max(s, 1))
    colours = ["#1b6ca8", "#b5442e", "#3f7d3a", "#7a4fa3"]
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="760" height="380" font-family="sans-serif" font-size="13">',
             '<rect width="760" height="380" fill="white"/>']
    for k in range(1, 6):
        parts.append(f'<line x1="{x(10**k)}" y1="30" x2="{x(10**k)}" y2="330" stroke="#ddd"/>'
                     f'<text x="{x(10**k)}" y="348" text-anchor="middle">{10**k:,}</text>')
    for seconds, name in [(1, "1 s"), (10, "10 s"), (60, "1 min"), (600, "10 min"), (3600, "1 h"), (36000, "10 h"),
                          (864000, "10 d")]:
        parts.append(f'<line x1="70" y1="{y(seconds):.1f}" x2="550" y2="{y(seconds):.1f}" stroke="#ddd"/>'
                     f'<text x="64" y="{y(seconds) + 4:.1f}" text-anchor="end">{name}</text>')
    parts.append('<text x="310" y="370" text-anchor="middle">scans in the archive</text>')
    taken = []  # heights of the names at the right
    for i, (name, points) in enumerate(curves):
        line = " ".join(f"{x(n):.1f},{y(s):.1f}" for n, s in points)
        at = y(points[-1][1]) + 4
        while any(abs(at - other) < 15 for other in taken):
            at += 1
        taken.append(at)
        dashes = ' stroke-dasharray="6 5"' if i == len(curves) - 1 else ""
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colours[i % 4]}" stroke-width="2"{dashes}/>'
                     f'<text x="558" y="{at:.1f}" fill="{colours[i % 4]}">{name}</text>')
    return "\n".join(parts + ["</svg>\n"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("stores", nargs="+")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."))
    options = parser.parse_args()
    rows = [row for store in options.stores for row in rows_of(store)]
    planes = [r for r in rows if r["kind"] == "planes" and r["samples"] > 0]
    scenes = [r for r in rows if r["kind"] == "scene"]
    lines = []
    for name, some, terms in [("planes", planes, ["samples"]), ("scene", scenes, ["samples", "pixels"])]:
        for what in ("cpu_s", "memory"):
            model = fit(some, what, terms)
            worst = max(max(value(model, r) / r[what], r[what] / value(model, r)) for r in some)
            text = " + ".join(f"{c:.3g}" + ("" if t == "one" else f" {t}") for t, c in model.items())
            lines.append(f"| {name}, {what} | {text} | {len(some)} | {min(r['samples'] for r in some):,} to "
                         f"{max(r['samples'] for r in some):,} | {worst:.2f} |")
    text = "| unit | fitted | units | samples | worst factor |\n|---|---|---|---|---|\n" + "\n".join(lines) + "\n\n"
    # The scene of the table: the mean of all.
    scans = sum(r["scans"] for r in scenes) / len(scenes)
    scene_s = (sum(r["cpu_s"] for r in scenes) + sum(r["cpu_s"] for r in planes)) / len(scenes)
    scene_bytes = (sum(r["bytes"] for r in scenes) + sum(r["bytes"] for r in planes)) / len(scenes)
    longest_s = max(r["cpu_s"] for r in rows)
    machines = [("2 cores", 2, 1, False), ("32 cores", 32, 1, False), ("16 hosts of 32", 32, 16, True),
                ("64 hosts of 32", 32, 64, True)]
    text += (f"A scene has {scans:.1f} scans, takes {scene_s:.1f} CPU seconds and leaves {scene_bytes / 1e6:.1f} MB; "
             f"the longest unit takes {longest_s:.1f} s.\n\n| scans | " + " | ".join(m[0] for m in machines) +
             " | manifest, a process | second night |\n|---|" + "---|" * (len(machines) + 2) + "\n")
    curves = [(m[0], []) for m in machines]
    for count in (10, 100, 1000, 10_000, 100_000):
        n = count / scans
        cells = []
        for machine, (_, points) in zip(machines, curves):
            parts = night(n, scans, scene_s, scene_bytes, longest_s, *machine[1:])
            limit = max((k for k in parts if k != "plan"), key=parts.get)
            cells.append(clock(total(parts)) + f" ({limit})")
            points.append((count, total(parts)))
        text += (f"| {count:,} | " + " | ".join(cells) + f" | {n * READ_MANIFEST_BYTES / 1e6:.0f} MB | "
                 f"{clock((PLAN_AGAIN_S + READ_MANIFEST_S) * n)} |\n")
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "model.md").write_text(text)
    (options.out / "model.svg").write_text(plot(curves))
    print(text)


main()
