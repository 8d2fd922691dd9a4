"""Tests the report of the benchmarks (rows, targets, names) on made-up measurements. Nothing is timed."""

import contextlib
import io
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import report
from figures import FIGURES, NAMES, PAIRS


class MadeUp:
    """Made-up times: ours 10, every peer 250, a tick 300 us; blocks with more than 20 nodes a side miss 1 kHz."""

    def __init__(self, _build):
        pass

    def medians(self, cases, **_settings):
        return {case: 10.0 if "_ours" in case else 250.0 for case in cases}

    def ticks(self, case, rounds=3):
        count = int(case.split(":")[1]) if case.startswith("block") else 0
        return {"thread_p99_us": 1500.0 if count > 20 else 300.0, "thread_median_us": 200.0,
                "thread_most_us": 400.0}

    def jelly(self):
        alike = {"poissons_ratio": 0.49}
        return {"ours": {"s_per_s": 0.1, "error": 0.06, **alike},
                "bullet": {"explicit": {"s_per_s": 0.3, "error": 0.2, **alike},
                           "looser": {"s_per_s": 0.2, "error": 0.1, "poissons_ratio": 0.46},
                           "implicit": {"s_per_s": 2.0, "error": 0.05, **alike}}}

    def replay(self):
        return 300, 6.0, 9.0

    def window(self, _model, quality, _start, program=None):
        return {"frames_per_second": 50.0 if program else 40.0, "touching": 1.0,
                "frame_ms": [float(k) for k in range(1, 21 if quality == "lowest" else 41)]}

    def start(self, _arguments):
        return [20.0, 30.0, 90.0]

    def study_case(self, tilt_deg, height_mm=14):
        return {"processor_s": 1.0 + abs(tilt_deg) / 20, "nodes": 10000 // height_mm, "motion_s": 2.0 + abs(tilt_deg) / 10}

    def loop(self, load):
        ours = {"ticks": 9990, "missed": 10 if load == "idle" else 30, "p99_us": 80.0}
        return ours, {"ticks": 10000, "missed": 5, "p99_us": 60}

    def live(self):
        ours = {"ticks": 60000, "missed": 30, "lateness_p99_s": 1e-4}
        memory = [(second, 2**20 * (100 + (second > 30))) for second in range(60)]
        return ours, memory, {"ticks": 20000, "missed": 5, "p99_us": 60}


def run(*arguments):
    out = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(report, "Measurements", MadeUp), \
            mock.patch.object(sys, "argv", ["run", "--build", folder, *arguments]), \
            contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        code = report.main()
    return code, out.getvalue()


class Report(unittest.TestCase):
    def test_json_has_every_figure_once_and_nothing_beside(self):
        code, text = run("--json")
        rows = json.loads(text)["figures"]
        self.assertEqual(code, 0)
        self.assertEqual([(row["name"], row["case"]) for row in rows], [(f.name, f.case) for f in FIGURES])
        for row in rows:
            self.assertGreaterEqual(row.keys(), {"name", "ours", "peer", "ratio", "target", "met"})

    def test_growth_has_the_cost_of_a_case_by_nodes_and_by_seconds(self):
        growth = json.loads(run("--json", "--growth", "png_ms")[1])["growth_us"]
        self.assertGreater(len(growth["study_nodes"]), 4)
        self.assertIn([5.0, 2.5e6], growth["study_seconds"])

    def test_targets_are_judged_by_ratio_or_by_our_own_value(self):
        rows = {row["name"]: row for row in json.loads(run("--json")[1])["figures"]}
        self.assertEqual(rows["eval_vs_sisl"]["ratio"], 25.0)
        self.assertTrue(rows["eval_vs_sisl"]["met"])
        self.assertFalse(rows["eval_vs_occt"]["met"])
        self.assertFalse(rows["tick_p99_us"]["met"])
        self.assertEqual(rows["frames_per_second"]["ours"], 50.0)
        self.assertTrue(rows["frames_per_second"]["met"])
        self.assertEqual(rows["lattice_at_1khz"]["ours"], 20**3)

    def test_table_names_what_is_missed(self):
        _, text = run("eval_vs_sisl", "tick_p99_us")
        lines = text.splitlines()
        self.assertEqual(lines[0].split(), ["name", "ours", "peer", "ratio", "target", "met"])
        self.assertEqual(lines[1].split(), ["eval_vs_sisl", "10", "us", "250", "us", "25", ">=", "20", "yes"])
        self.assertIn("NO", lines[2])

    def test_a_failure_is_a_row_and_an_exit_code(self):
        with mock.patch.object(MadeUp, "medians", side_effect=RuntimeError("broken")):
            code, text = run("--json", "png_ms")
        self.assertEqual(code, 1)
        row = json.loads(text)["figures"][0]
        self.assertEqual((row["ours"], row["met"], row["error"]), (None, None, "broken"))

    def test_the_loop_is_judged_beside_cyclictest(self):
        rows = json.loads(run("--json", "loop_missed_per_1000", "loop_p99_us")[1])["figures"]
        self.assertEqual([row["met"] for row in rows], [True, False, True, True])
        self.assertEqual(rows[0]["peer"], 0.5)
        late = report.lateness_of("# Histogram\n000010 000900\n000020 000095\n001500 000003\n"
                                  "# Histogram Overflows: 00002\n")
        self.assertEqual(late, {"ticks": 1000, "missed": 5, "p50_us": 10, "p99_us": 20, "p999_us": 1500})

    def test_the_window_is_judged_beside_another_program_if_one_is_named(self):
        alone = json.loads(run("--json", "window_frame_ms")[1])["figures"]
        self.assertEqual([(row["ours"], row["met"]) for row in alone], [(25.0, None), (20.0, False), (20.0, False)])
        with mock.patch.dict(os.environ, {"SPOONBILL_PEER": "other"}):
            row = json.loads(run("--json", "window_frame_ms")[1])["figures"][0]
        self.assertEqual((row["peer"], row["ratio"], row["met"]), (20.0, 0.8, True))

    def test_unknown_names_are_wrong_use(self):
        with self.assertRaises(SystemExit) as stopped:
            run("eval_vs_nobody")
        self.assertEqual(stopped.exception.code, 2)

    def test_every_pair_is_a_figure(self):
        self.assertLessEqual({key if isinstance(key, str) else key[0] for key in PAIRS}, set(NAMES))

    def test_the_fastest_peer_counts_and_what_has_no_target_is_only_stated(self):
        times = {"sphere_fcl_boxes": 300.0}
        with mock.patch.object(MadeUp, "medians", lambda _self, cases: {case: times.get(case, 900.0) for case in cases}):
            rows = json.loads(run("--json", "sphere_vs_fcl")[1])["figures"]
            text = run("sphere_vs_fcl")[1]
        self.assertEqual([(row["peer"], row["met"], row["target"]) for row in rows], [(300.0, False, 100), (300.0, None, None)])
        self.assertEqual(text.splitlines()[2].split()[-2:], ["-", "-"])

    def test_a_peer_with_a_larger_error_counts_only_if_no_other_is_as_true(self):
        row = json.loads(run("--json", "trial_vs_peer")[1])["figures"][0]
        self.assertEqual((row["peer"], row["met"], row["details"]["compared_with"]), (2.0, True, "implicit"))
        wrong = {**MadeUp(None).jelly(), "ours": {"s_per_s": 0.1, "error": 0.01, "poissons_ratio": 0.49}}
        with mock.patch.object(MadeUp, "jelly", lambda _self: wrong):
            row = json.loads(run("--json", "trial_vs_peer")[1])["figures"][0]
        self.assertEqual((row["peer"], row["met"], row["details"]["compared_with"]), (0.3, False, "explicit"))
        self.assertFalse(row["details"]["a_peer_meets_our_error"])


if __name__ == "__main__":
    unittest.main()
