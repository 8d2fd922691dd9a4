#!/usr/bin/env python3
"""Runs the benchmarks of a build folder and reports each figure beside its target. tests/bench/run calls it."""

import argparse
import csv
import functools
import json
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from figures import (FIGURES, GROWTH, HANDLE, LATTICE_COUNTS, NAMES, PAIRS, START_CASES, STUDY_HEIGHTS_MM, STUDY_TILTS,
                     TICK_CASES, WINDOW_CASES)
from window import drawn_while_pressing, quantile

LOOP_SECONDS = 20
LIVE_SECONDS = 60
LIVE_WARM_UP_SECONDS = 10
ROOT = Path(__file__).resolve().parents[2]


def say(text):
    print(f"bench: {text}", file=sys.stderr, flush=True)


def output_of(command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{Path(command[0]).name} failed with {done.returncode}")
    return done.stdout.decode()


class Measurements:
    """Runs the programs of a build folder."""

    def __init__(self, build):
        self.build = build

    def medians(self, cases, repetitions=15, seconds=0.05):
        """Returns the medians of the cases' processor times. Repetitions of all cases run in random order."""
        pattern = "^(" + "|".join(cases) + ")$"
        report = json.loads(output_of([
            self.build / "tests/bench/kernel_bench", f"--benchmark_filter={pattern}", "--benchmark_format=json",
            f"--benchmark_repetitions={repetitions}", f"--benchmark_min_time={seconds}",
            "--benchmark_enable_random_interleaving=true"]))
        times = {}
        for run in report["benchmarks"]:
            if run.get("error_occurred"):
                raise RuntimeError(f"{run['name']}: {run['error_message']}")
            if run.get("aggregate_name") == "median":
                times[run["run_name"]] = run["cpu_time"]
        missing = set(cases) - set(times)
        if missing:
            raise RuntimeError(f"not measured: {', '.join(sorted(missing))}")
        return times

    def ticks(self, case, rounds=5):
        kind, colon, file = case.rpartition(":")
        case = kind + colon + str(ROOT / file) if file.endswith((".jsonl", ".json")) else case
        return json.loads(output_of([self.build / "tests/bench/tick_bench", rounds, case]))[case]

    def jelly(self, rounds=5):
        """Returns the times and errors of a block of jelly, ours and Bullet's."""
        return json.loads(output_of([self.build / "tests/bench/jelly_bench",
                                     ROOT / "tests/bench/calculix/jelly-sag.csv", rounds]))

    def replay(self):
        """Replays the bundled recording. Returns the number of frames, the seconds and the processor seconds."""
        with tempfile.TemporaryDirectory() as folder:
            before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            done = json.loads(output_of([self.build / "app/spoonbill", "replay", ROOT / HANDLE, "--out", folder,
                                         "--size", "1280x720", "--json"]))
            seconds, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return done["frames"], seconds, used

    def window(self, model, quality, start, program=None):
        """Presses in the window of a program, ours by default. Returns how it drew."""
        return drawn_while_pressing(program or self.build / "app/spoonbill", ROOT / f"assets/models/{model}.json",
                                    quality, start)

    def start(self, arguments, rounds=21):
        """Returns the milliseconds from starting the program with these arguments to its end, sorted."""
        times = []
        for _ in range(rounds):
            start = time.perf_counter()
            subprocess.run([str(self.build / "app/spoonbill"), *arguments], cwd=ROOT, stdout=subprocess.DEVNULL,
                           check=True)
            times.append(1e3 * (time.perf_counter() - start))
        return sorted(times)

    def study_case(self, tilt_deg, height_mm=14):
        """Makes a study of one case, with food of a height. Returns its processor seconds, from starting the program to
        its end, the nodes of the food and the seconds of its motion."""
        with tempfile.TemporaryDirectory() as folder:
            study = Path(folder) / "study.json"
            study.write_text(json.dumps({
                "spoonbill_study": 1, "tilts_deg": [tilt_deg], "frictions": [0.1], "vary": {}, "claim": False, "repeats": False,
                "frames_deg": [], "foods": [{"name": "gelatin", "material": "gelatin-20-1", "size_mm": [28, height_mm, 22]}]}))
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = json.loads(output_of([
                self.build / "app/spoonbill", "study", ROOT / "assets/models/spoon-bowl.json", "--file", study,
                "--out", Path(folder) / "out", "--workers", "1", "--json"]))
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            with (Path(folder) / "out/cases.csv").open(encoding="utf-8", newline="") as file:
                case = next(csv.DictReader(file))
        if done["cases"] != 1 or done["not_judged"] != 0:
            raise RuntimeError("the case was not judged")
        return {"processor_s": after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
                "nodes": int(case["nodes"]), "motion_s": float(case["motion_s"])}

    @functools.cache
    def loop(self, load):
        """Returns the lateness of our loop, and that of cyclictest under the same load (None if cyclictest fails)."""
        ours = json.loads(output_of([self.build / "tests/bench/loop_bench", LOOP_SECONDS, "loop", load]))
        if ours["notice"]:
            say(ours["notice"])
        return ours, self.cyclictest(load)

    def cyclictest(self, load):
        program = shutil.which("cyclictest") or "/usr/sbin/cyclictest"
        background = subprocess.Popen(
            [str(self.build / "tests/bench/loop_bench"), str(LOOP_SECONDS + 3), "none", load],
            stdout=subprocess.DEVNULL)
        try:
            time.sleep(1.5)
            return lateness_of(output_of([program, "-q", "-m", "-p80", "-i1000", "-h", 50000,
                                          "-l", 1000 * LOOP_SECONDS]))
        except (RuntimeError, OSError) as error:
            say(f"no cyclictest beside it: {error}")
            return None
        finally:
            background.wait()

    @functools.cache
    def live(self):
        """Runs a live session that draws while it receives strokes and commands, then cyclictest with drawing."""
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder) / "live.script.json"
            script.write_text(json.dumps(live_script(LIVE_SECONDS)))
            program = subprocess.Popen(
                [str(self.build / "app/spoonbill"), "record", str(script), "--live", "--draw", "--json", "--out",
                 str(Path(folder) / "live.recording.jsonl")], stdout=subprocess.PIPE)
            resident = resident_memory_of(program)
            done = json.loads(program.stdout.read())
            if program.wait() != 0:
                raise RuntimeError(f"spoonbill record --live failed with {program.returncode}")
        return done, resident, self.cyclictest("drawing")


def live_script(seconds):
    """Returns a script that presses and releases for `seconds`, with a command every tenth of a second of a press."""
    steps = [{"start_mm": [88, 26, 0]}, {"command": "place_plane", "point_mm": [40, 0, 0], "normal": [1, 0, 0]},
             {"hold_s": 0.4}]
    for stroke in range(int(seconds / 2.4)):
        steps.append({"move_to_mm": [88, 11.5, 0], "over_s": 0.4})
        for step in range(10):
            radius = 8 + 0.1 * ((stroke + step) % 3)
            steps.append({"command": "set_tool", "kind": "sphere", "action": "push", "radius_mm": radius,
                          "substeps": 6})
            steps.append({"move_to_mm": [88, 11.5 - step, 0], "over_s": 0.1})
        steps += [{"move_to_mm": [88, 26, 0], "over_s": 0.5}, {"command": "undo"}, {"hold_s": 0.5}]
    return {"spoonbill_script": 1, "model": str(ROOT / "assets/models/spoon-handle.json"), "steps": steps}


def resident_memory_of(program):
    """Returns pairs of seconds and bytes of resident memory, sampled while the program runs."""
    samples, start, page = [], time.monotonic(), os.sysconf("SC_PAGE_SIZE")
    while program.poll() is None:
        pages = Path(f"/proc/{program.pid}/statm").read_text().split()
        if pages:
            samples.append((time.monotonic() - start, page * int(pages[1])))
        time.sleep(0.25)
    return samples


def lateness_of(histogram):
    """Returns the quantiles of cyclictest's histogram of microseconds."""
    bins, beyond = [], 0
    for line in histogram.splitlines():
        words = line.split()
        if len(words) == 2 and words[0].isdigit() and words[1].isdigit():
            bins.append((int(words[0]), int(words[1])))
        elif line.startswith("# Histogram Overflows:"):
            beyond = int(words[-1])
    total = beyond + sum(count for _, count in bins)
    if not total:
        raise RuntimeError("cyclictest printed no histogram")

    def quantile(share):
        seen = 0
        for late_us, count in bins:
            seen += count
            if seen >= share * total:
                return late_us
        return bins[-1][0]

    missed = beyond + sum(count for late_us, count in bins if late_us >= 1000)
    return {"ticks": total, "missed": missed, "p50_us": quantile(0.5), "p99_us": quantile(0.99),
            "p999_us": quantile(0.999)}


def measured_missed(measure, figure):
    ours, peer = measure.loop(figure.case)
    return {"ours": 1000 * ours["missed"] / (ours["ticks"] + ours["missed"]),
            "peer": 1000 * peer["missed"] / peer["ticks"] if peer else None,
            "details": {"ours": ours, "cyclictest": peer}}


def measured_lateness(measure, figure):
    ours, peer = measure.loop(figure.case)
    return {"ours": ours["p99_us"], "peer": peer["p99_us"] if peer else None,
            "ratio": peer["p99_us"] / ours["p99_us"] if peer else None}


def measured_live_missed(measure, _figure):
    ours, _, peer = measure.live()
    return {"ours": 1000 * ours["missed"] / (ours["ticks"] + ours["missed"]),
            "peer": 1000 * peer["missed"] / peer["ticks"] if peer else None,
            "details": {"ours": ours, "cyclictest": peer}}


def measured_live_lateness(measure, _figure):
    ours, _, peer = measure.live()
    late_us = 1e6 * ours["lateness_p99_s"]
    return {"ours": late_us, "peer": peer["p99_us"] if peer else None,
            "ratio": peer["p99_us"] / late_us if peer else None}


def measured_live_memory(measure, _figure):
    samples = measure.live()[1]
    end = samples[-1][0]
    early = [size for at, size in samples if LIVE_WARM_UP_SECONDS <= at < LIVE_WARM_UP_SECONDS + 5]
    late = [size for at, size in samples if at >= end - 5]
    return {"ours": (max(late) - max(early)) / 2**20,
            "details": [[round(at, 1), size] for at, size in samples[::20]]}


def measured_pair(measure, figure):
    ours, *peers = pair_of(figure)
    times = measure.medians([ours, *peers])
    if not peers:
        return {"ours": times[ours]}
    best = min(times[peer] for peer in peers)
    return {"ours": times[ours], "peer": best, "ratio": best / times[ours],
            "details": {"peers": {peer: times[peer] for peer in peers}}}


def pair_of(figure):
    return PAIRS.get(figure.name) or PAIRS.get((figure.name, figure.case))


def measured_tick(measure, figure):
    ticks = measure.ticks(TICK_CASES[figure.case])
    return {"ours": ticks["thread_p99_us"], "details": ticks}


def measured_swap(measure, figure):
    ticks = measure.ticks(TICK_CASES[figure.case])
    return {"ours": ticks["thread_most_us"], "details": ticks}


def measured_trial(measure, figure):
    ticks = measure.ticks(TICK_CASES[figure.case], rounds=3)
    return {"ours": ticks["thread_p99_us" if figure.case.endswith("p99") else "thread_median_us"], "details": ticks}


def measured_jelly(measure, _figure):
    """Compares with the fastest peer whose error is no larger than ours or, if there is none, with the fastest of those
    that simulate the same material."""
    jelly = measure.jelly()
    ours, peers = jelly["ours"], jelly["bullet"]
    as_true = {name: peer for name, peer in peers.items() if peer["error"] <= ours["error"]}
    alike = {name: peer for name, peer in peers.items() if peer["poissons_ratio"] == ours["poissons_ratio"]}
    name, peer = min((as_true or alike).items(), key=lambda each: each[1]["s_per_s"])
    return {"ours": ours["s_per_s"], "peer": peer["s_per_s"], "ratio": peer["s_per_s"] / ours["s_per_s"],
            "details": {"compared_with": name, "a_peer_meets_our_error": bool(as_true), **jelly}}


def measured_frames(measure, _figure):
    frames, seconds, used = measure.replay()
    return {"ours": frames / seconds,
            "details": {"frames": frames, "seconds": seconds, "processor_seconds": used,
                        "frames_per_second_if_two_cores_were_free": 2 * frames / used}}


def measured_window(measure, figure):
    """Without a peer, the frame rate at full quality is reported and not judged."""
    model, quality, start = WINDOW_CASES[figure.case]
    drawn = measure.window(model, quality, start)
    if drawn["touching"] < 0.2:
        raise RuntimeError(f"the tool touched in {drawn['touching']:.0%} of the frames only")
    details = {key: value for key, value in drawn.items() if key != "frame_ms"}
    if figure.judged == "ours":
        return {"ours": quantile(drawn["frame_ms"], 0.95), "details": details}
    program = os.environ.get("SPOONBILL_PEER")
    rates = [drawn["frames_per_second"]]
    if program:
        rates.append(measure.window(model, None, start, program)["frames_per_second"])
    if None in rates:
        raise RuntimeError("Mesa counted no frames")
    ours, *peer = (1e3 / rate for rate in rates)
    return {"ours": ours, "details": details, **({"peer": peer[0], "ratio": peer[0] / ours} if peer else {})}


def measured_start(measure, figure):
    times = measure.start(START_CASES[figure.case])
    return {"ours": times[len(times) // 2], "details": {"least": times[0], "most": times[-1]}}


def measured_study_case(measure, _figure):
    times = {tilt: measure.study_case(tilt)["processor_s"] for tilt in STUDY_TILTS}
    return {"ours": max(times.values()), "details": {str(tilt): seconds for tilt, seconds in times.items()}}


def measured_lattice(measure, _figure):
    times, largest = {}, 0
    for count in LATTICE_COUNTS:
        times[count] = measure.ticks(f"block:{count}:1", rounds=1)
        if times[count]["thread_p99_us"] >= 1000:
            break
        largest = count**3
    return {"ours": largest, "details": {str(count**3): ticks for count, ticks in times.items()}}


def measured(measure, figure):
    if pair_of(figure):
        return measured_pair(measure, figure)
    return {"tick_p99_us": measured_tick, "stiff_tick_p99_us": measured_tick, "swap_tick_us": measured_swap,
            "trial_tick_us": measured_trial, "trial_vs_peer": measured_jelly,
            "frames_per_second": measured_frames,
            "lattice_at_1khz": measured_lattice, "loop_missed_per_1000": measured_missed,
            "live_missed_per_1000": measured_live_missed, "live_p99_us": measured_live_lateness,
            "live_memory_growth": measured_live_memory,
            "loop_p99_us": measured_lateness, "start_ms": measured_start, "study_case_s": measured_study_case,
            "window_frame_ms": measured_window}[figure.name](measure, figure)


def row_of(measure, figure):
    say(figure.name + (f", {figure.case}" if figure.case else ""))
    row = {"name": figure.name, "case": figure.case, "unit": figure.unit, "ours": None, "peer": None, "ratio": None,
           "target": figure.target, "target_is": f"{figure.judged} {figure.sense}", "met": None,
           "compared": figure.compared}
    try:
        row.update(measured(measure, figure))
    except (RuntimeError, OSError, KeyError, subprocess.CalledProcessError, json.JSONDecodeError) as error:
        row["error"] = str(error)
        say(f"{figure.name} failed: {error}")
    row["met"] = figure.met(row["ours"], row["ratio"])
    return row


def grown(measure):
    growth = {}
    for axis, curves in GROWTH.items():
        say(f"growth with the {axis}")
        cases = [case for curve in curves.values() for case in curve.values()]
        times = measure.medians(cases, repetitions=3, seconds=0.02)
        growth[axis] = {name: {str(n): times[case] for n, case in curve.items()} for name, curve in curves.items()}
    say("growth of a study's case")
    by_height = [measure.study_case(0, height) for height in STUDY_HEIGHTS_MM]
    by_tilt = [measure.study_case(tilt) for tilt in STUDY_TILTS]
    growth["study_nodes"] = [[case["nodes"], 1e6 * case["processor_s"]] for case in by_height]
    growth["study_seconds"] = [[case["motion_s"], 1e6 * case["processor_s"]] for case in by_tilt]
    return growth


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def number(value):
    if value is None:
        return "-"
    if value >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def table(rows):
    lines = [("name", "ours", "peer", "ratio", "target", "met")]
    for row in rows:
        judged, sense = row["target_is"].split(" ", 1)
        unit = "" if judged == "ratio" else " " + row["unit"]
        peer = "-" if row["peer"] is None else f"{number(row['peer'])} {row['unit']}"
        lines.append((row["name"] + (f" ({row['case']})" if row["case"] else ""),
                      f"{number(row['ours'])} {row['unit']}", peer, number(row["ratio"]),
                      "-" if row["target"] is None else
                      f"{'>=' if sense == 'at least' else '<='} {number(row['target'])}{unit}",
                      {True: "yes", False: "NO", None: "failed" if "error" in row else "-"}[row["met"]]))
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    text = [
        "  ".join(cell.ljust(width) if k == 0 else cell.rjust(width)
                  for k, (cell, width) in enumerate(zip(line, widths))) for line in lines
    ]
    text.append("")
    text += [f"{row['name']}{' (' + row['case'] + ')' if row['case'] else ''}: {row['compared']}" for row in rows]
    text += ["", "Times are medians of the processor's time, ours and peer interleaved; ratio = peer / ours."]
    return "\n".join(text)


def arguments():
    parser = argparse.ArgumentParser(prog="tests/bench/run", allow_abbrev=False,
                                     description="Runs the benchmarks and prints each figure beside its target.",
                                     epilog="Names: " + " ".join(NAMES))
    parser.add_argument("--json", action="store_true", help="one JSON object on standard output, nothing else")
    parser.add_argument("--growth", action="store_true", help="also measure how cost grows, for tests/bench/plot")
    parser.add_argument("--build", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("names", nargs="*", metavar="NAME", help="figure to measure; default: all")
    options = parser.parse_args()
    for name in options.names:
        if name not in NAMES:
            parser.error(f"unknown name '{name}'; the names are: {' '.join(NAMES)}")
    return options


def main():
    options = arguments()
    if options.check:
        return 0
    measure = Measurements(options.build)
    wanted = [figure for figure in FIGURES if not options.names or figure.name in options.names]
    load = os.getloadavg()[0]
    report = {"machine": {"processor": processor(), "cores": os.cpu_count(), "load_before": load},
              "figures": [row_of(measure, figure) for figure in wanted]}
    if options.growth:
        report["growth_us"] = grown(measure)
    (options.build / "figures.json").write_text(json.dumps(report, indent=1) + "\n")
    print(json.dumps(report) if options.json else table(report["figures"]))
    return 1 if any("error" in row for row in report["figures"]) else 0


if __name__ == "__main__":
    sys.exit(main())
