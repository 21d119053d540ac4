#!/usr/bin/env python3
"""Memory of a program per stage, from outside it.

  python3 bench/scaling/memory.py hybrid planes west.e57 --out out [--memory 2G]

Starts the program (a `hybrid` that prints its stages on stderr), looks at /proc every 5 ms and prints one Markdown row per
stage: resident bytes at its start, its peak, of that in pages of files (which the system can drop or write back), and
bytes a sample where --samples says how many millions. Children count too. The last line is the whole run's peak.
"""
import os
import re
import subprocess
import sys
import threading
import time

PAGE = os.sysconf("SC_PAGESIZE")


def resident(pid):
    """(resident, of that shared or of files) in bytes of a process and its children; zeros when it has gone."""
    try:
        with open(f"/proc/{pid}/statm") as file:
            _, total, shared = (int(word) for word in file.read().split()[:3])
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            children = file.read().split()
    except (FileNotFoundError, ProcessLookupError, ValueError):
        return 0, 0
    total, shared = total * PAGE, shared * PAGE
    for child in children:
        more = resident(int(child))
        total, shared = total + more[0], shared + more[1]
    return total, shared


def main():
    arguments = sys.argv[1:]
    samples = 0.0
    if arguments[:1] == ["--samples"]:
        samples = float(arguments[1]) * 1e6
        arguments = arguments[2:]
    if not arguments or arguments[0].startswith("-"):
        sys.exit(__doc__)
    process = subprocess.Popen(arguments, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    rows = [["start", 0, 0, 0, time.monotonic()]]  # stage, at start, peak, of files at peak, since
    log = []

    def read_stages():
        for line in process.stderr:
            log.append(line)
            found = re.search(r"\[\d+/\d+\] (?:.*: )?(.*)$", line.rstrip())
            if found:
                rows.append([found.group(1), resident(process.pid)[0], 0, 0, time.monotonic()])

    reader = threading.Thread(target=read_stages)
    reader.start()
    while process.poll() is None:
        total, shared = resident(process.pid)
        if total > rows[-1][2]:
            rows[-1][2:4] = total, shared
        time.sleep(0.005)
    reader.join()
    if process.returncode != 0:
        sys.stderr.writelines(log[-5:])
    print("| stage | at its start, MB | peak, MB | of files | bytes a sample at the peak | s |")
    print("|---|---|---|---|---|---|")
    rows.append(["", 0, 0, 0, time.monotonic()])
    for row, after in zip(rows, rows[1:]):
        each = f"{row[2] / samples:.0f}" if samples else ""
        print(f"| {row[0]} | {row[1] / 1e6:.0f} | {row[2] / 1e6:.0f} | {row[3] / 1e6:.0f} | {each} "
              f"| {after[4] - row[4]:.1f} |")
    used = os.times()
    print(f"exit code {process.returncode}, peak {max(row[2] for row in rows) / 1e9:.2f} GB "
          f"({max(row[2] for row in rows) / (1 << 30):.2f} GiB), {used.children_user + used.children_system:.0f} CPU s")
    sys.exit(process.returncode)


if __name__ == "__main__":
    main()
