#!/usr/bin/env python3
"""What a process pays for the size of a plan.

  python3 bench/scaling/manifest.py STORE UNITS [--hybrid build/bin/hybrid]

Copies the store's plan (made by `hybrid batch plan` from a small archive with at least one scene) until it has UNITS units,
and prints CPU seconds and peak memory of `batch status` (every unit's schedule) and of `run --unit 0` (engine and worker) with it
and with the plan as it was. The store's unit 0 must have been made (`run --unit 0`), so that nothing is computed. Works on a
copy of the store's small files; the store is left alone.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def write_plan(file, plan, count):
    """The plan's planes and scenes over and over, renumbered; the layout of host/archive/manifest_file.cpp."""
    scene = next(unit for unit in plan["units"] if unit["kind"] == "scene")
    planes = [plan["units"][need] for need in scene["needs"]]
    head = {key: plan[key] for key in ("format", "archive", "build", "problems", "notes")}
    compact = {"separators": (",", ":"), "ensure_ascii": False}
    offsets = []
    copies = max(1, count // (len(planes) + 1))
    with open(file, "wb") as out:
        out.write((json.dumps(head, **compact)[:-1] + ',\n"units":[\n').encode())

        def add(unit, number, needs, last=False):
            unit = dict(unit, number=number, needs=needs)
            if number >= len(planes):
                unit["key"] = f"{number:032x}"
            rest = {key: unit.pop(key) for key in ("settings", "inputs", "from")}
            offsets.append(out.tell())
            out.write((json.dumps(unit, **compact)[:-1] + ",\n" + json.dumps(rest, **compact)[1:] +
                       ("\n" if last else ",\n")).encode())

        number = 0
        for copy in range(copies):
            for one in planes:
                add(one, number, [])
                number += 1
        for copy in range(copies):
            first = copy * len(planes)
            add(scene, number, list(range(first, first + len(planes))), copy + 1 == copies)
            number += 1
        out.write(b'],\n"offsets":[\n')
        begin = out.tell()
        for i, offset in enumerate(offsets):
            out.write(f'"{offset:016x}"{" " if i + 1 == len(offsets) else ","}\n'.encode())
        out.write(f'],\n"count":"{number:016x}","offsets_at":"{begin:016x}"}}\n'.encode())
    return number


def cost(command):
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    complaint = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    code = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        sys.exit(f"{' '.join(command)}: exit code {code}: {complaint[-500:]}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("store", type=pathlib.Path)
    parser.add_argument("units", type=int)
    parser.add_argument("--hybrid", default="build/bin/hybrid")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        store = pathlib.Path(scratch) / "store"
        shutil.copytree(options.store, store, symlinks=True)
        plan = json.loads((store / "manifest.json").read_text())
        print("| units | manifest, MB | command | CPU s | peak MB |\n|---|---|---|---|---|")
        for count in (len(plan["units"]), options.units):
            if count != len(plan["units"]):
                count = write_plan(store / "manifest.json", plan, count)
            size = (store / "manifest.json").stat().st_size / 1e6
            for name, words in (("run --unit 0", ["run", "--out", str(store), "--unit", "0"]),
                                ("status", ["status", str(store)])):
                seconds, peak = cost([options.hybrid, "batch", *words, "--quiet"])
                print(f"| {count} | {size:.1f} | {name} | {seconds:.2f} | {peak:.0f} |", flush=True)


if __name__ == "__main__":
    main()
