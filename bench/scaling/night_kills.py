"""For nights.py: nights that are killed at random moments and places until they are done, and what they leave and end with."""
import collections
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

# Named places (host/core/fail_point.hpp) on the way of a plan and of a run.
plan_places = ("cache-written", "manifest-written")
run_places = ("object-begun", "unit-sent", "unit-begun", "object-made", "object-sealed", "object-named", "object-committed",
              "result-linked")
tells_of_the_run = ("record.json", "timing.json", "timing.js", "log.txt")  # differ from run to run


def contents(store):
    """What is to be the same at the end of every night: the plan, the objects, the links to them, and nothing left over."""
    found = {}
    for part in ("manifest.json", "objects", "results", "failures", "work"):
        files = [store / part] if part == "manifest.json" else (store / part).rglob("*")
        for file in files:
            if file.is_symlink():
                found[str(file.relative_to(store))] = os.readlink(file)
            elif file.is_file() and file.name not in tells_of_the_run:
                with open(file, "rb") as opened:
                    found[str(file.relative_to(store))] = hashlib.file_digest(opened, "blake2b").hexdigest()
    return found


def whole_objects(store):
    """Inode and time of each object's seal, which never changes again."""
    return {seal.parent.name: (seal.stat().st_ino, seal.stat().st_mtime_ns) for seal in store.glob("objects/*/*/object.json")}


def lives(group):
    """Whether a process of the group is left. One that is dead and waited for by nobody is not."""
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, its_group = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue
        if int(its_group) == group and state not in "ZX":
            return True
    return False


class Kills:
    def __init__(self, hybrid, archive, store, jobs, seed, within_s):
        """Runs of `jobs` jobs into `store`, killed at most `within_s` after they began unless they die at a place."""
        self.hybrid, self.archive, self.store, self.jobs, self.within_s = hybrid, archive, store, jobs, within_s
        self.random = random.Random(seed)
        self.killed = collections.Counter()
        self.wrong = []
        self.nights = self.lost = 0

    def check(self, right, what):
        if not right:
            self.wrong.append(f"{sum(self.killed.values())} kills: {what}")

    def start(self, *words, place=None):
        environment = dict(os.environ)
        if place:
            environment["HYBRID_FAIL_AT"] = place + ":group"
        with open(self.store.parent / "disturbed.log", "a") as log:
            return subprocess.Popen([str(self.hybrid), "batch", *words], stdout=subprocess.PIPE, stderr=log, text=True,
                                    start_new_session=True, env=environment)

    def plan(self, place=None):
        return self.start("plan", str(self.archive), "--out", str(self.store), "--quiet", "--wait", place=place)

    def run(self, place=None):
        return self.start("run", "--out", str(self.store), "--jobs", str(self.jobs), "--threads", str(self.jobs), "--json",
                          "--wait", place=place)

    def until(self, clean, count):
        """Nights until `count` kills, each compared with contents() of one that nobody disturbed."""
        while sum(self.killed.values()) < count:
            self.nights += 1
            shutil.rmtree(self.store, ignore_errors=True)
            if self.random.random() < 0.5:
                place = self.random.choice(plan_places) + ":1"
                self.ended(self.plan(place), "plan, at " + place[:-2])
            plan = self.plan()
            plan.communicate()
            self.check(plan.returncode == 0, f"plan: exit code {plan.returncode}")
            while sum(self.killed.values()) < count and self.disturb():
                pass
            self.finish(clean)

    def disturb(self):
        """One run, killed. False when it came to its end before."""
        before = whole_objects(self.store)
        how = self.random.choice(("place", "place", "moment", "moment", "run alone", "worker alone"))
        place = self.random.choice(run_places)
        run = self.run(f"{place}:{self.random.randint(1, 3)}" if how == "place" else None)
        if how == "place":
            died = self.ended(run, "at " + place)
        else:
            died = self.kill_at_moment(run, how)
        after = whole_objects(self.store)
        self.check(all(after.get(key) == stamp for key, stamp in before.items()), "an object that was whole was made again")
        folders = {folder.name for folder in self.store.glob("objects/*/*")}
        self.check(folders == set(after), f"objects without a seal: {sorted(folders - set(after))}")
        if died:
            in_flight = len(list((self.store / "work").glob("*")))
            self.lost += in_flight
            self.check(in_flight <= self.jobs, f"{in_flight} units were in flight, {self.jobs} jobs were asked for")
        return died

    def kill_at_moment(self, run, how):
        try:
            run.wait(self.random.uniform(0, self.within_s))
            return self.ended(run, how)
        except subprocess.TimeoutExpired:
            pass
        if how == "worker alone":  # another takes its place, and the run goes on until it is killed itself
            listed = pathlib.Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split()
            if listed:
                os.kill(int(self.random.choice(listed)), signal.SIGKILL)
                self.killed[how] += 1
            return self.kill_at_moment(run, "moment")
        if how == "moment":
            os.killpg(run.pid, signal.SIGKILL)
        else:
            run.kill()
        return self.ended(run, how)

    def ended(self, process, how):
        """Waits for all of it; whether it was killed, which is counted, or came to its end."""
        code = process.wait()
        process.stdout.close()
        for _ in range(1000):
            if not lives(process.pid):
                break
            time.sleep(0.01)
        else:
            self.check(False, f"{how}: processes are left after it")
        if code == -signal.SIGKILL:
            self.killed[how] += 1
            return True
        self.check(code == 0, f"{how}: exit code {code}")
        return False

    def finish(self, clean):
        there = len(whole_objects(self.store))
        last = self.run()
        told = json.loads(last.communicate()[0] or "{}")
        units = told.get("units", {})
        self.check(last.returncode == 0 and set(units) == {"done"}, f"the last run: exit code {last.returncode}, {units}")
        self.check(told.get("computed") == len(whole_objects(self.store)) - there, f"the last run made {told.get('computed')}")
        verified = subprocess.run([str(self.hybrid), "batch", "verify", str(self.store)], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True)
        self.check(verified.returncode == 0, f"verify: {verified.stdout[-500:]}")
        end = contents(self.store)
        other = sorted(name for name in clean.keys() | end.keys() if clean.get(name) != end.get(name))
        self.check(not other, f"{len(other)} files are not those of an undisturbed night: {other[:5]}")
        print(f"night {self.nights}: {sum(self.killed.values())} kills so far", file=sys.stderr)

    def report(self):
        print(f"| killed: nights, kills, units that were in flight | {self.nights}, {sum(self.killed.values())}, {self.lost} |")
        for how, count in sorted(self.killed.items()):
            print(f"| killed: {how} | {count} |")
