#!/usr/bin/env python3
"""Nights of an archive of small churches: everything, nothing changed, killed again and again, one scan changed.

    python3 bench/scaling/nights.py WORK [--scenes 200] [--kills 0] [--jobs 2] [--bin build/bin] [--first-seed 1]

Makes WORK/archive (`hybrid-synth archive`, preset tiny) where it is not there yet, plans and runs it into a new
WORK/store, and prints Markdown: wall clock against the units' CPU seconds (each unit on one thread) shared by the jobs, the
second night's share of the first and how many files it wrote, what was made again after one scan had changed (a bit of one
coordinate; put back at the end) against what depends on it, and how far the plan's estimates were off. With --kills N, nights
into WORK/disturbed are killed N times in all and resumed each time: at random moments (all processes, the run alone, a worker)
and at places named in the program (all processes); after each kill no whole object may be gone, made again or without its seal,
and no more units in flight than jobs; each night's end has to verify and to have the first night's bytes. Exit code 1 when
anything of this is wrong, a unit is not done, the second night wrote a file, or others than the dependants were made again.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

import night_kills


def call(command):
    """(stdout, events on stderr, wall clock, CPU seconds of it and all that it waited for, exit code)"""
    start, before = time.monotonic(), os.times()
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    after, wall = os.times(), time.monotonic() - start
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    if process.returncode not in (0, 3):
        sys.exit(f"{' '.join(command)}: exit code {process.returncode}: {process.stderr[-1000:]}")
    events = [json.loads(line) for line in process.stderr.splitlines() if line.startswith("{")]
    return process.stdout, events, wall, cpu, process.returncode


def stamps(store):
    """What tells a file that was written from one that was not. Not of the lock, which names its holder, and of the plans, the
    latest of which is in force."""
    found = {}
    for file in store.rglob("*"):
        status = os.lstat(file)
        if not file.is_dir() and file.name != "lock" and file.parent.name != "manifests":
            found[str(file.relative_to(store))] = (status.st_ino, status.st_mtime_ns, status.st_ctime_ns)
    return found


class Nights:
    def __init__(self, options):
        self.hybrid, self.jobs = options.bin / "hybrid", options.jobs
        self.archive, self.store = options.work / "archive", options.work / "store"
        self.wrong = []

    def night(self):
        """Plans and runs; the plan's units, what the run told, wall clock and CPU seconds of both."""
        plan = call([self.hybrid, "batch", "plan", str(self.archive), "--out", str(self.store), "--quiet"])
        run = call([self.hybrid, "batch", "run", "--out", str(self.store), "--jobs", str(self.jobs), "--threads",
                    str(self.jobs), "--json"])
        units = json.loads((self.store / "manifest.json").read_text())["units"]
        return units, json.loads(run[0]), run[1], plan[2], run[2], plan[3] + run[3]

    def check(self, right, what):
        if not right:
            self.wrong.append(what)

    def first(self):
        units, told, _, plan_s, run_s, cpu_s = self.night()
        done = told["units"].get("done", 0)
        self.check(done == len(units), f"{len(units) - done} of {len(units)} units are not done: {told['failed'][:3]}")
        records = [json.loads(file.read_text()) for file in self.store.glob("objects/*/*/record.json")]
        units_s = sum(record["cpu_s"] for record in records)
        self.first_s, self.unit_s = plan_s + run_s, run_s / len(units)
        print("| | |\n|---|---|")
        print(f"| units done | {done} of {len(units)} |")
        print(f"| plan, run | {plan_s:.1f} s, {run_s:.1f} s |")
        print(f"| CPU of the units; of all processes | {units_s:.1f} s; {cpu_s:.1f} s |")
        print(f"| run / (units' CPU / {self.jobs} jobs) | {run_s / (units_s / self.jobs):.3f} |")
        self.estimates(records)

    def estimates(self, records):
        for kind in ("planes", "scene", "report"):
            some = [record for record in records if record["unit"].split()[0] == kind]
            for what in ("cpu_s", "memory_bytes"):
                # A process keeps memory between units: only one that grew tells what its unit took.
                tell = [r for r in some if what == "cpu_s" or r["memory_bytes"] > 1.1 * r["kept_bytes"]]
                ratios = [r[what] / r["estimate"][what] for r in tell if r["estimate"][what] > 0]
                if ratios:
                    print(f"| {kind}: {what}, measured / estimated, median (min-max) of {len(ratios)} | "
                          f"{statistics.median(ratios):.2f} ({min(ratios):.2f}-{max(ratios):.2f}) |")

    def second(self):
        before = stamps(self.store)
        _, told, _, plan_s, run_s, _ = self.night()
        after = stamps(self.store)
        written = [f for f in after if before.get(f) != after[f]]
        self.check(told["computed"] == 0 and not written, f"the second night computed {told['computed']}, wrote {written[:5]}")
        print(f"| second night: share of the first, computed, files written | {100 * (plan_s + run_s) / self.first_s:.2f} % "
              f"({plan_s + run_s:.2f} s), {told['computed']}, {len(written)} |")

    def killed(self, count, seed):
        # Some units of a run come to their end, most of its time is in between.
        kills = night_kills.Kills(self.hybrid, self.archive, self.store.parent / "disturbed", self.jobs, seed,
                                  2 + 4 * self.jobs * self.unit_s)
        kills.until(night_kills.contents(self.store), count)
        kills.report()
        self.wrong += kills.wrong

    def changed_scan(self):
        scans = sorted(file for file in self.archive.glob("*/scans/*") if file.suffix in (".ply", ".ptx", ".e57"))
        scan = next(file for file in scans[len(scans) // 2:] if file.suffix == ".ply")
        bytes_before = scan.read_bytes()
        changed = bytearray(bytes_before)
        changed[-12 if len(changed) > 12 else 0] ^= 1
        scan.write_bytes(changed)
        try:
            units, told, events, plan_s, run_s, _ = self.night()
        finally:
            scan.write_bytes(bytes_before)
        dependants = set()
        for unit in units:
            if any(pathlib.Path(i["file"]) == scan for i in unit["inputs"]) or dependants & set(unit["needs"]):
                dependants.add(unit["number"])
        made = {event["unit"] for event in events if event.get("event") == "unit"}
        self.check(made == dependants and told["computed"] == len(dependants),
                   f"{scan}: units {sorted(made)} were made again, {sorted(dependants)} depend on it")
        print(f"| one scan changed: depend on it, made again, seconds | {len(dependants)}, {told['computed']}, "
              f"{plan_s + run_s:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    options = parser.parse_args()
    options.work = options.work.resolve()
    nights = Nights(options)
    if len(list(nights.archive.glob("*/scene.toml"))) != options.scenes:
        shutil.rmtree(nights.archive, ignore_errors=True)
        call([str(options.bin / "hybrid-synth"), "archive", str(options.scenes), "--out", str(nights.archive), "--seed",
              str(options.first_seed), "--quiet"])
    shutil.rmtree(nights.store, ignore_errors=True)
    nights.first()
    nights.second()
    if options.kills:
        nights.killed(options.kills, options.first_seed)
    nights.changed_scan()
    for what in nights.wrong:
        print(f"wrong: {what}", file=sys.stderr)
    return 1 if nights.wrong else 0


sys.exit(main())
