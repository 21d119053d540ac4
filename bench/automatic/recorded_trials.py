#!/usr/bin/env python3
"""How often poses in scan files place the scans of a survey, on random sets of a synthetic church's stations.

    hybrid-synth church --seed 5 --preset tiny --megapixels 0.1 --scans 25 --format ptx --out CHURCH
    python3 bench/automatic/recorded_trials.py CHURCH exact|one|rough model|nomodel SEED SETS LEAST MOST PROGRAM

exact: files right within 1 mm and 0.005 degrees (standard deviations), in a frame of their own; one: but for one,
5 cm to 1 m and up to 3 degrees off; rough: each 50 cm and 3 degrees off. model: landmarks of one scan of the set
are kept; nomodel: none are. Right is what lies within 2 cm of the truth. Needs numpy; works in CHURCH/trials.
"""
import json
import pathlib
import random
import re
import subprocess
import sys

import numpy as np

church, mode, kind, seed, sets, least, most, program = sys.argv[1:]
church = pathlib.Path(church)
work = church / "trials"
(work / "scans").mkdir(parents=True, exist_ok=True)
text = (church / "scene.toml").read_text()
truth = {s["id"]: np.array(s["world_from_scan"]).reshape(4, 4)
         for s in json.loads((church / "truth.json").read_text())["scans"]}
tables = {}
for part in re.split(r"(?m)^(?=\[)", text):
    if part.startswith("[[scan]]"):
        tables[re.search(r'(?m)^id = "([^"]+)"', part).group(1)] = part
normals, draws = np.random.default_rng(int(seed)), random.Random(int(seed))


def rotation(axis, degrees):
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def motion(metres, degrees):
    pose = np.eye(4)
    pose[:3, :3] = rotation(normals.normal(size=3), degrees)
    along = normals.normal(size=3)
    pose[:3, 3] = metres * along / np.linalg.norm(along)
    return pose


def moved(pose, by):
    """Turned about the scanner, and shifted."""
    result = pose.copy()
    result[:3, :3] = by[:3, :3] @ pose[:3, :3]
    result[:3, 3] += by[:3, 3]
    return result


def noisy(pose, metres, degrees):
    return moved(pose, motion(metres * abs(normals.normal()), degrees * abs(normals.normal())))


def survey_frame():
    pose = np.eye(4)
    pose[:3, :3] = rotation([0, 0, 1], normals.uniform(0, 360))
    pose[:3, 3] = normals.uniform(-50, 50, 3)
    return pose


def write_scan(scan, pose):
    row = lambda *values: " ".join(f"{v:.9f}" for v in values)
    lines = (church / "scans" / f"{scan}.ptx").read_text().split("\n")
    axes = [pose[:3, k] for k in range(3)]
    header = [row(*pose[:3, 3])] + [row(*a) for a in axes] + [row(*a, 0) for a in axes] + [row(*pose[:3, 3], 1)]
    (work / "scans" / f"{scan}.ptx").write_text("\n".join(lines[:2] + header + lines[10:]))


def error_m(pose, scan, frame):
    found, true = np.array(pose).reshape(4, 4), truth[scan]
    if kind == "nomodel":
        first = json.loads((work / "out/scans" / frame / "pose.json").read_text())["world_from_scan"]
        found = np.linalg.inv(np.array(first).reshape(4, 4)) @ found
        true = np.linalg.inv(truth[frame]) @ true
    return np.linalg.norm(found[:3, 3] - true[:3, 3])


right = wrong = none = 0
for _ in range(int(sets)):
    some = draws.sample(list(tables), draws.randint(int(least), int(most)))
    frame_of_files, _unused = survey_frame(), survey_frame()
    off = draws.choice(some)
    for scan in some:
        pose = noisy(frame_of_files @ truth[scan], *((0.5, 3) if mode == "rough" else (0.001, 0.005)))
        if mode == "one" and scan == off:
            pose = moved(pose, motion(normals.uniform(0.05, 1), normals.uniform(0, 3)))
        write_scan(scan, pose)
    clicked = [scan for scan in some if "landmarks = [" in tables[scan]]
    if kind == "model" and not clicked:
        continue
    keep = draws.choice(clicked) if clicked else None
    scene = '[scene]\nname = "trial"\n'
    for scan in some:
        kept = kind == "model" and scan == keep
        scene += "\n" + (tables[scan] if kept else re.sub(r"(?ms)^landmarks = \[.*?^\]\n", "", tables[scan]))
    if kind == "model":
        (work / "proxy.obj").write_bytes((church / "proxy.obj").read_bytes())
        scene += '\n[model]\nfile = "proxy.obj"\nunit = "m"\n'
    (work / "scene.toml").write_text(scene)
    subprocess.run([program, "run", work / "scene.toml", "--only", "planes,register", "--quiet", "--force",
                    "--out", work / "out"], capture_output=True)
    joint = json.loads((work / "out/summary.json").read_text()).get("joint") or {}
    for scan in some:
        pose = json.loads((work / "out/scans" / scan / "pose.json").read_text())["world_from_scan"]
        if pose is None:
            none += 1
        elif error_m(pose, scan, joint.get("frame") or some[0]) < 0.02:
            right += 1
        else:
            wrong += 1
            print("elsewhere:", scan, "of", *some, flush=True)
print(f"{right} right, {wrong} elsewhere, {none} without a pose")
