#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs `nlos generate --slurm` on a real Slurm of one node, with tasks that are killed.

    slurm_test.py NLOS [--items N] [--shards N] [--tasks N] [--samples N] [--disturbed N]

The script that the program prints is submitted. Once each task has finished a shard, the first is
cancelled by scancel, the second killed by SIGKILL, the third sent SIGTERM, the fourth requeued
while it runs, and so on. Then the script is submitted again until `--verify` says that all is
there; the first --disturbed of these submissions are disturbed. All shards must have the bytes of
an undisturbed run in one process, and those that were there must not have been made again.

The same, smaller, for `nlos sweep --slurm`: one task is killed, and in the end all runs have the
results of a sweep in one process, times apart.

Exit status 77 where Slurm cannot be installed: elsewhere than on Debian, and without root.
"""
from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tiny_data_set import differences, generate, is_whole, shards_of, write_recipe

START_SLURM = Path(__file__).resolve().parents[2] / "support" / "start_one_node_slurm.sh"
TIMEOUT_S = 900
ROUNDS = 10


def slurm(*command: str, **where: Path) -> str:
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, **where)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    return done.stdout.strip()


def free_ports() -> int:
    """The first of two neighbouring ports that nobody listens to."""
    for port in range(16817, 17817, 2):
        try:
            with socket.create_server(("127.0.0.1", port)), \
                    socket.create_server(("127.0.0.1", port + 1)):
                return port
        except OSError:
            continue
    raise SystemExit("no free ports")


class OneNodeSlurm:
    """A Slurm in a folder, as long as the `with` lasts."""

    def __init__(self, folder: Path, processors: int):
        self.folder = folder
        self.processors = processors

    def __enter__(self) -> OneNodeSlurm:
        started = subprocess.run(
            ["bash", START_SLURM, self.folder, str(free_ports()), str(self.processors)],
            stdout=subprocess.PIPE, text=True, timeout=300)
        if started.returncode != 0:
            self.__exit__()
            raise SystemExit("Slurm does not start")
        os.environ["SLURM_CONF"] = started.stdout.strip()
        return self

    def __exit__(self, *_: object) -> None:
        processes = [int(path.read_text()) for path in self.folder.glob("*.pid")]
        for process in processes:
            try:
                os.kill(process, signal.SIGTERM)
            except ProcessLookupError:
                pass
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline and any(Path(f"/proc/{p}").exists() for p in processes):
            time.sleep(0.1)


def process_of_task(program: str, job: str, task: int) -> int | None:
    """The number of the process of the program that an array's task runs in."""
    wanted = {f"SLURM_ARRAY_JOB_ID={job}".encode(), f"SLURM_ARRAY_TASK_ID={task}".encode()}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            if os.readlink(entry / "exe") != os.path.realpath(program):
                continue
            if wanted <= set((entry / "environ").read_bytes().split(b"\0")):
                return int(entry.name)
        except OSError:  # ended meanwhile
            continue
    return None


def active_tasks(job: str) -> list[str]:
    done = subprocess.run(["squeue", "--noheader", "--array", "--job", job, "--format", "%K %T"],
                          capture_output=True, text=True, timeout=60)
    return done.stdout.splitlines()  # a job that ended long ago is unknown: no tasks


class Disturber:
    """Disturbs every task of an array once, each in the way of its turn."""

    def __init__(self, program: str, folder: Path, tasks: int, shards: int):
        self.program, self.folder, self.tasks, self.shards = program, folder, tasks, shards
        self.counts = {"scancel": 0, "SIGKILL": 0, "SIGTERM": 0, "requeue": 0}

    def disturb(self, job: str, task: int, process: int) -> None:
        way = list(self.counts)[task % len(self.counts)]
        if way == "SIGKILL":
            os.kill(process, signal.SIGKILL)
        elif way == "SIGTERM":
            os.kill(process, signal.SIGTERM)
        elif way == "scancel":
            slurm("scancel", f"{job}_{task}")
        else:
            slurm("scontrol", "requeue", f"{job}_{task}")
        self.counts[way] += 1

    def follow(self, job: str) -> None:
        """Waits until the array has ended and disturbs each task that has finished a new shard."""
        left = {task: self.finished(task) for task in range(self.tasks)}
        deadline = time.monotonic() + TIMEOUT_S
        while active_tasks(job):
            if time.monotonic() > deadline:
                raise SystemExit(f"job {job} does not end: {active_tasks(job)}")
            for task, at_start in list(left.items()):
                if not at_start < self.finished(task) < self.of_task(task):
                    continue
                process = process_of_task(self.program, job, task)
                if process is not None:
                    self.disturb(job, task, process)
                    del left[task]
            time.sleep(0.05)

    def finished(self, task: int) -> int:
        return sum((self.folder / f"shard-{shard:05}.json").exists()
                   for shard in range(task, self.shards, self.tasks))

    def of_task(self, task: int) -> int:
        return len(range(task, self.shards, self.tasks))


def run_array(program: str, recipe: Path, folder: Path, options: argparse.Namespace) -> list[str]:
    """Makes a data set by arrays that are disturbed; returns what is wrong."""
    script = folder.parent / "script.sh"
    script.write_text(
        generate(program, recipe, "-o", folder, "--slurm", options.tasks), encoding="utf-8")
    disturber = Disturber(program, folder, options.tasks, options.shards)
    problems = []
    for turn in range(ROUNDS):
        there = {path: path.stat().st_mtime_ns for path in shards_of(folder)}
        job = slurm("sbatch", "--parsable", str(script), cwd=folder.parent)
        if turn < options.disturbed:
            disturber.follow(job)
        while active_tasks(job):
            time.sleep(0.1)
        again = [path.name for path, time_ns in there.items() if path.stat().st_mtime_ns != time_ns]
        if again:
            problems.append(f"made again although they were there: {again}")
        if is_whole(program, folder):
            break
    print(f"{turn + 1} submissions of {options.tasks} tasks, disturbed: {disturber.counts}")
    if min(disturber.counts.values()) == 0:
        problems.append("not every way of disturbing was met: take more items")
    if turn == 0:
        problems.append("the first submission made all: its kills did nothing")
    return problems


def write_sweep(folder: Path) -> Path:
    scene = Path(__file__).resolve().parents[3] / "scenes" / "letter" / "scene.json"
    grid = {"scene.scan.sensing_points": [[16, 16], [24, 24], [32, 32]],
            "noise.photons_per_point": [10, 100, 1000], "reconstruct.method": ["lct", "fk"]}
    axis = {"opl_start_m": 1.2, "bin_width_m": 0.008, "num_bins": 128}
    path = folder / "sweep.json"
    path.write_text(json.dumps({"scene": str(scene), "fixed": {"scene.time_axis": axis},
                                "grid": grid, "plots": []}), encoding="utf-8")
    return path


def sweep(program: str, *arguments: object) -> str:
    done = subprocess.run([program, "sweep", *map(str, arguments)], capture_output=True, text=True,
                          timeout=TIMEOUT_S)
    if done.returncode != 0:
        raise SystemExit(f"nlos sweep {' '.join(map(str, arguments))}: {done.stderr[-2000:]}")
    return done.stdout


def without_costs(value: object) -> object:
    """A result without what differs from run to run: times and memory."""
    if isinstance(value, list):
        return [without_costs(part) for part in value]
    if not isinstance(value, dict):
        return value
    return {key: without_costs(part) for key, part in value.items()
            if "seconds" not in key and key != "peak_rss_bytes"}


def results_of(folder: Path) -> dict[str, object]:
    return {path.name: without_costs(json.loads(path.read_text(encoding="utf-8")))
            for path in sorted((folder / "runs").glob("*.json"))}


def check_sweep(program: str, folder: Path) -> list[str]:
    """Sweeps by an array of which a task is killed; returns what is wrong."""
    path = write_sweep(folder)
    one_process, array = folder / "sweep_one_process", folder / "sweep_array"
    sweep(program, path, "-o", one_process)
    expected = results_of(one_process)
    script = folder / "sweep.sh"
    script.write_text(sweep(program, path, "-o", array, "--slurm", 2), encoding="utf-8")
    kills = submissions = 0
    while len(results_of(array)) < len(expected) and submissions < ROUNDS:
        job = slurm("sbatch", "--parsable", str(script), cwd=folder)
        submissions += 1
        while active_tasks(job):
            process = process_of_task(program, job, 0) if kills == 0 else None
            if process is not None and results_of(array):
                os.kill(process, signal.SIGKILL)
                kills += 1
            time.sleep(0.02)
    sweep(program, path, "-o", array)
    print(f"sweep: {submissions} submissions, {kills} kill, {len(expected)} runs")
    problems = [] if results_of(array) == expected else ["results of the sweep differ"]
    return problems if kills and submissions > 1 else [*problems, "no kill stopped the sweep"]


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--items", type=int, default=160)
    parser.add_argument("--shards", type=int, default=16)
    parser.add_argument("--tasks", type=int, default=4)
    parser.add_argument("--samples", type=int, default=8000)
    parser.add_argument("--disturbed", type=int, default=1)
    options = parser.parse_args()
    if os.geteuid() != 0 or not Path("/etc/debian_version").exists():
        print("skipped: Slurm is installed and started on Debian as root")
        return 77
    folder = Path(tempfile.mkdtemp(prefix="slurm_"))
    os.chmod(folder, 0o755)  # munged wants a path that others may enter
    recipe = write_recipe(folder / "recipe.json", options.items, options.shards, options.samples)
    print(generate(options.program, recipe, "-o", folder / "one_process"), end="", flush=True)
    with OneNodeSlurm(folder / "slurm", options.tasks):
        problems = run_array(options.program, recipe, folder / "array", options)
        problems += check_sweep(options.program, folder)
    problems += differences(folder / "one_process", folder / "array")
    if problems:
        print("\n".join(problems), f"everything is in {folder}", sep="\n")
        return 1
    print(generate(options.program, "--merge", folder / "array"), end="")
    shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
