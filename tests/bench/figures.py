"""The figures: what is measured, the peer for comparison, and the target. Plain data, read by report.py and plot."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    name: str
    unit: str
    judged: str  # what is judged: "ratio" (peer / ours) or "ours"
    sense: str  # sense of the target: "at least" or "at most"
    target: float | None  # None for a figure that is reported beside another one
    compared: str  # what both sides do in the comparison
    case: str = ""  # distinguishes rows of the same name

    def met(self, ours, ratio):
        value = ratio if self.judged == "ratio" else ours
        if value is None or self.target is None:
            return None
        return value >= self.target if self.sense == "at least" else value <= self.target


GRID = "points and unit normals of a bicubic sheet, 8 x 8 control points, 200 x 200 samples; "

VERTICES, CONTROLS = "same vertices", "from control points"
SPHERE_PEERS = ("sphere_fcl_boxes", "sphere_fcl_turned_boxes")
SURFACES_PEERS = ("surfaces_fcl_boxes", "surfaces_fcl_turned_boxes")

# Names of Google Benchmark's cases for each figure, by the figure's name, or by its name and case.
# Each row has our case first, then the cases of the peers. Our case is compared with the fastest peer.
PAIRS = {
    "eval_vs_sisl": ("evaluate_ours/200/8", "evaluate_sisl/200/8"),
    "eval_vs_occt": ("evaluate_ours/200/8", "evaluate_occt_cached/200/8"),
    "eval_vs_eigen": ("evaluate_ours/200/8", "evaluate_eigen/200/8"),
    "refit_vs_occt": ("refit_ours/200/8", "refit_occt/200/8"),
    "refit_vs_dense": ("refit_ours/200/8", "refit_dense/200/8"),
    "springs12_vs_bullet": ("springs_ours/12", "springs_position_based/12"),
    "springs24_vs_bullet": ("springs_ours/24", "springs_explicit/24"),
    "step12_vs_bullet": ("springs_full/12", "springs_position_based/12"),
    "step24_vs_bullet": ("springs_full/24", "springs_explicit/24"),
    ("sphere_vs_fcl", VERTICES): ("sphere_ours/from_vertices", *SPHERE_PEERS),
    ("sphere_vs_fcl", CONTROLS): ("sphere_ours/from_controls", *SPHERE_PEERS),
    ("surfaces_vs_fcl", VERTICES): ("surfaces_ours/from_vertices", *SURFACES_PEERS),
    ("surfaces_vs_fcl", CONTROLS): ("surfaces_ours/from_controls", *SURFACES_PEERS),
    "sphere_on_handle_us": ("handle_sphere",),
    "nets_crossing_us": ("nets_crossing/2",),
    "png_ms": ("png_ours", "png_stb"),
    "merge_ms": ("merge_30x30",),
    "fit_ms": ("fit_scan_ours/100000/24",),
    "fit_vs_occt": ("fit_grid_ours/100/24", "fit_grid_occt/100/24"),
}

HANDLE = "assets/recordings/spoon-handle-bend.recording.jsonl"
TICK_CASES = {"handle": HANDLE, "stiff handle": "stiff:" + HANDLE, "block 12x12x12": "block:12:6",
              "handle, bulges": "swap:assets/recordings/grip-bulge.recording.jsonl",
              "jelly, median": "trial:assets/models/jelly-on-spoon.json",
              "jelly, p99": "trial:assets/models/jelly-on-spoon.json"}
LATTICE_COUNTS = (8, 12, 16, 20, 24, 28, 30, 32, 34)

LOOP = ("ticks of the 1 kHz loop late by 1 ms or more, the tick of the block in it; peer: cyclictest -m -p80, "
        "without work, just after; ")
LIVE = "60 s of `spoonbill record --live --draw`, strokes, and a command every tenth of a second while they press; "
# Model, quality of the frames, and the pixel at which the stroke begins.
WINDOW_CASES = {"handle, full quality": ("spoon-handle", "full", (900, 250)),
                "handle, lowest": ("spoon-handle", "lowest", (900, 250)),
                "jelly, lowest": ("jelly-on-spoon", "lowest", (797, 320))}
WINDOW = ("frames of `spoonbill edit` at 1280x720 with the panel, on a virtual display, while a mouse presses and stirs "
          "beside the 1 kHz loop, 15 s; ")
START_CASES = {"version": ["--version"], "info": ["info", "assets/models/trimmed-plate.json"]}
STUDY_TILTS = (-30, -20, -10, 0, 10, 20, 30)
STUDY_HEIGHTS_MM = (7, 9, 11, 14, 17, 20)  # of the food; fewer nodes the higher it is, because its cells are near cubes
START = "from starting the program to its end, the median of 21; "
LATE = "p99 of how late a tick begins, as above; "

FCL = ("ours on the true surface, every triangle of FCL's contacts in it; FCL: the faster of AABB and OBBRSS, f32, "
       "refitted, which knows nothing of the grid; ")
SPHERE = "a sheet of 200 x 200 cells deforms, then all contacts with a sphere; " + FCL
SURFACES = "a sheet of 200 x 200 cells deforms, then all contacts with another sheet; " + FCL
GIVEN = "both receive the vertices; ours also receives the control points, which bound the surface between them"

JELLY = ("the first second of a block of jelly of 12 x 10 x 6 nodes, 30 x 15 x 24 mm, E 4.3 kPa, Poisson's ratio 0.49, "
         "that sags on a fixed base; errors: of all displacements at rest, against 20-node bricks of CalculiX; ours: a "
         "trial, damped by 0.5 ms; Bullet: the fastest with no larger error than ours or, if none has (\"details\" says "
         "so), the fastest with this Poisson's ratio; deformable body, five neo-Hookean tetrahedra a cell, f32, Debian's "
         "build, explicit at the largest stable step with a drag of 200/s, also with a Poisson's ratio of 0.46, at "
         "which its error is about the smallest, or implicit at 1/240 s as in Bullet's examples and at 1/60 s, "
         "Bullet's default, one Newton step, no line search, no damping")

SPRINGS12 = "one step, 12^3 nodes, 18,788 springs; "
SPRINGS24 = "one step, 24^3 nodes, 164,588 springs; "
OURS = "ours f32, the mean of a tick's six substeps; the block is shaken so far that five of them linearise its springs; "
PARTS = "with volume force, damping and plastic flow; "
POSITIONS = "Bullet: soft body, position based, one iteration, f32, Debian's build"
EXPLICIT = "Bullet: deformable body, explicit, f32, Debian's build"

FIGURES = (
    Figure("eval_vs_sisl", "us", "ratio", "at least", 20, GRID + "ours f32, SISL s1506 f64"),
    Figure("eval_vs_occt", "us", "ratio", "at least", 40, GRID + "ours f32, OCCT GeomAdaptor_Surface::D1 f64"),
    Figure("eval_vs_eigen", "us", "ratio", "at least", 2.5,
           GRID + "both f32; Eigen: dense A_u P A_v^T, same flags and instruction set"),
    Figure("refit_vs_occt", "us", "ratio", "at least", 1000,
           "200 x 200 samples to 8 x 8 control points; OCCT GeomAPI_PointsToBSplineSurface, which also finds "
           "parameters and knots"),
    Figure("refit_vs_dense", "us", "ratio", "at least", 1 / 1.2,
           "200 x 200 samples to 8 x 8 control points, three coordinates, both f32; Eigen: the dense product with "
           "the same pseudo-inverse, same flags and instruction set"),
    Figure("springs12_vs_bullet", "us", "ratio", "at least", 10, SPRINGS12 + OURS + "springs alone; " + POSITIONS),
    Figure("springs24_vs_bullet", "us", "ratio", "at least", 20, SPRINGS24 + OURS + "springs alone; " + EXPLICIT),
    Figure("step12_vs_bullet", "us", "ratio", "at least", 6, SPRINGS12 + OURS + PARTS + POSITIONS),
    Figure("step24_vs_bullet", "us", "ratio", "at least", 15, SPRINGS24 + OURS + PARTS + EXPLICIT),
    Figure("sphere_vs_fcl", "us", "ratio", "at least", 100, SPHERE + GIVEN, VERTICES),
    Figure("sphere_vs_fcl", "us", "ratio", "at least", None, SPHERE + "ours from its control points", CONTROLS),
    Figure("surfaces_vs_fcl", "us", "ratio", "at least", 40, SURFACES + GIVEN, VERTICES),
    Figure("surfaces_vs_fcl", "us", "ratio", "at least", None, SURFACES + "ours from its control points", CONTROLS),
    Figure("sphere_on_handle_us", "us", "ours", "at most", 20,
           "the shipped handle moves, then contact with a sphere, from its control points"),
    Figure("nets_crossing_us", "us", "ours", "at most", 250,
           "two nets of 30 x 30 control points move, crossing each other from side to side: regions and depths"),
    Figure("tick_p99_us", "us", "ours", "at most", 250,
           "the whole tick while touching, p99 over ticks of the thread's own time, each the median of five rounds",
           "handle"),
    Figure("tick_p99_us", "us", "ours", "at most", 250,
           "the whole tick while touching, 6 substeps, p99 as above", "block 12x12x12"),
    Figure("stiff_tick_p99_us", "us", "ours", "at most", 1000,
           "the whole tick while touching, of ABS stepped implicitly, p99 as above", "stiff handle"),
    Figure("swap_tick_us", "us", "ours", "at most", 1000,
           "a tick before which a refinement of knots is adopted, with the adoption; the longest, thread time as above",
           "handle, bulges"),
    Figure("trial_tick_us", "us", "ours", "at most", 250,
           "the whole tick of a trial, bundled jelly of 720 nodes on its spoon, while it tilts by 10 degrees and for "
           "two seconds after; the median over ticks", "jelly, median"),
    Figure("trial_tick_us", "us", "ours", "at most", 800, "as above, p99 over ticks", "jelly, p99"),
    Figure("trial_vs_peer", "s per s", "ratio", "at least", 5, JELLY),
    Figure("frames_per_second", "1/s", "ours", "at least", 30,
           "`spoonbill replay` of the bundled recording to PNG, 1280x720, antialiasing, shadow, occlusion and "
           "reflections"),
    Figure("window_frame_ms", "ms", "ratio", "at least", 0.7,
           WINDOW + "mean from frame to frame; peer: the program that the variable SPOONBILL_PEER names, if "
           "any, which must draw in full too",
           "handle, full quality"),
    Figure("window_frame_ms", "ms", "ours", "at most", 16.7, WINDOW + "95 % of frames take no longer", "handle, lowest"),
    Figure("window_frame_ms", "ms", "ours", "at most", 16.7, WINDOW + "95 % of frames take no longer", "jelly, lowest"),
    Figure("png_ms", "ms", "ours", "at most", 8, "one frame of 1280x720 to PNG; peer: stb_image_write"),
    Figure("merge_ms", "ms", "ours", "at most", 20,
           "two patches of 30 x 30 control points that share an edge merged into one, C2"),
    Figure("fit_ms", "ms", "ours", "at most", 2000,
           "a cloud of 100,000 points without normals to 24 x 24 control points, errors measured, on one core"),
    Figure("fit_vs_occt", "ms", "ratio", "at least", 1,
           "a grid of 100 x 100 points to 24 x 24 control points; OCCT GeomAPI_PointsToBSplineSurface to 0.01 mm, "
           "which also finds parameters and knots"),
    Figure("lattice_at_1khz", "nodes", "ours", "at least", 32768,
           "the largest block of clay whose whole tick while touching, one substep, keeps its p99 of the "
           "thread's own time under 1 ms"),
    Figure("loop_missed_per_1000", "per 1,000", "ours", "at most", 1, LOOP + "nothing draws", "idle"),
    Figure("loop_missed_per_1000", "per 1,000", "ours", "at most", 1, LOOP + "a thread draws at 60 Hz", "drawing"),
    Figure("loop_p99_us", "us", "ratio", "at least", 0.5, LATE + "nothing draws", "idle"),
    Figure("loop_p99_us", "us", "ratio", "at least", 0.5, LATE + "a thread draws at 60 Hz", "drawing"),
    Figure("live_missed_per_1000", "per 1,000", "ours", "at most", 1, LIVE + "ticks late by 1 ms or more"),
    Figure("live_p99_us", "us", "ratio", "at least", 0.5,
           LIVE + "p99 of how late a tick begins; peer: cyclictest beside as much drawing"),
    Figure("live_memory_growth", "MiB", "ours", "at most", 2,
           LIVE + "resident memory, from 10 s after the beginning to the end"),
    Figure("start_ms", "ms", "ours", "at most", 50, START + "`spoonbill --version`", "version"),
    Figure("start_ms", "ms", "ours", "at most", 50, START + "`spoonbill info` of the trimmed plate", "info"),
    Figure("study_case_s", "s", "ours", "at most", 3,
           "a study of one case, gelatin in the bundled bowl at a friction of 0.1: processor time of the whole "
           "program, the longest of seven tilts"),
)

NAMES = tuple(dict.fromkeys(figure.name for figure in FIGURES))

# Plots of how cost grows. Each curve maps the size on the horizontal axis to the name of Google Benchmark's case.
GROWTH = {
    "grid": {name: {n: f"evaluate_{name}/{n}/8" for n in (25, 50, 100, 200, 400, 1000)}
             for name in ("ours", "ours_double", "eigen", "sisl", "occt_cached")},
    "net": {name: {n: f"evaluate_{name}/200/{n}" for n in (8, 16, 32, 64)}
            for name in ("ours", "ours_double", "eigen", "sisl", "occt_cached")},
    "lattice": {name: {n: f"springs_{name}/{n}" for n in (8, 12, 16, 24, 32) + more}
                for name, more in (("ours", (48, 64)), ("full", (48, 64)), ("position_based", ()), ("explicit", ()))},
}
