# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables and pictures that tools/measure/all makes: what is run for each, and what is made of what it says.

A Bench is commands whose standard output, one after the other, is handed to `shape`. A Runs is a list of whole runs of scenes, a row each;
its columns are functions of the run's summary.json. `minutes` is about the processor time on one core. In a command {program} is the program, {python} a Python with NumPy (TETLAP_PYTHON, else
python3), {folder} a folder for what it writes; `picture` is a file in that folder that replaces one of the manual.
"""
import glob
import json
import os
import re
from typing import Callable, NamedTuple

MODELS = "clip,clip32,exact,cgal,geo,geo-small,hybrid,tpn"
LEARNED = "geo,geo-small,hybrid"
MOVING = ("01_drop", "02_two_blocks", "03_spheres", "05_press", "06_bunny_like", "10_incline", "11_rolling_ball", "12_fold", "13_dead_bounce", "14_rollers", "15_sleepers")
STATIC = ("26_hertz", "30_snap_fit", "31_seal")
BETWEEN_MESHES = ("02_two_blocks", "03_spheres", "05_press", "12_fold", "15_sleepers", "30_snap_fit")  # in the others contact is with obstacles alone
BOUND_PAIRS = (("scenes", ("--law", "scene", "--mix", "scene=1", "--seed", "9003")), ("uniform V", ("--law", "paper-test", "--mix", "volumetric=1", "--seed", "9001")))
BOUND_DOUBTS = (".005", ".01")


class Bench(NamedTuple):
    commands: list
    shape: Callable
    minutes: float
    picture: tuple = ()
    lacks: int = -1  # the exit code that says that this machine cannot measure it: then the table stays as it is
    fails: int = 0  # an exit code with which it makes its table all the same: cases failed, and stand in it as such
    shown: str = ""  # in place of the commands, where they are many of one form


class Runs(NamedTuple):
    heads: list  # of the labels
    rows: list  # (labels, scene, values, further words of `tetlap run`)
    columns: dict  # heading: function of the summary and of the list of all rows' (labels, summary)
    minutes: float


def figure(value, digits=2):
    return "–" if value is None else f"{value:.{digits}g}"


def table(heads, rows, aligned=1):
    """Markdown; all columns but the first `aligned` are numbers."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * aligned + "--:|" * (len(heads) - aligned)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def objects(told):
    return [json.loads(line) for line in told.splitlines() if line.startswith("{")]


def as_told(told):
    """What is Markdown already."""
    return told.strip()


def by_quantity(value, sets, quantities):
    """A row a model and set, a column a quantity."""
    def shape(told):
        found = {(row["model"], row["set"], row["quantity"]): row for row in objects(told)}
        models = list(dict.fromkeys(model for model, _, _ in found))
        rows = [[f"`{model}`", name, *(figure(found[model, name, quantity][value], 3) if (model, name, quantity) in found else "–" for quantity in quantities)]
                for name in sets for model in models]
        return table(["model", "set", *(quantity.replace("+grad", " + ∇V").replace("+hess", " + ∇²V").replace("+centroid", " + x̄") for quantity in quantities)], rows, 2)
    return shape


def models_beside_clip(told):
    """Speeds by processor time over those of clip in the same rounds, and errors."""
    found = {(row["model"], row["quantity"]): row for row in objects(told)}
    rows = []
    for model in MODELS.split(","):
        v, grad = found[model, "V"], found[model, "V+grad"]
        rows.append([f"`{model}`", figure(v["cpu_ratio"]), figure(grad["cpu_ratio"]), figure(v["error"]), figure(grad["error"])])
    return table(["model", "V: speed over that of `clip`", "V + ∇V: speed over that of `clip`", "error of V", "error of ∇V"], rows)


def threads(told):
    rows = [[f"`{row['model']}`", row["quantity"], row["batch"], figure(row["pairs_per_second"], 3), figure(row["thread_gain"], 3)]
            for row in objects(told) if row["threads"] > 1]
    return table(["model", "quantity", "batch", "pairs a second of wall time, on all threads", "over one thread"], rows, 2)


def networks(told):
    rows = [[row["net"], row["implementation"], row["quantity"], figure(row["samples_per_cpu_second"], 3), figure(row["cpu_ratio_to_torch"], 3), figure(row["peak_share"], 3)]
            for row in objects(told)]
    return table(["net", "by", "quantity", "samples a processor second", "over PyTorch", "of peak"], rows, 3)


def unseen(told):
    keys = {"V": "volume_error", "moments": "moment_error", "nodal forces": "nodal_force_error", "total force": "total_force_error", "false friction": "tangential_error",
            "work round the path": "path_work", "of `clip`": "path_work_clip", "processor time over `clip`": "time_ratio"}
    return table(["case", "model", *keys], [[row["case"], f"`{row['model']}`", *(figure(row[key]) for key in keys.values())] for row in objects(told)], 2)


def cubes(told):
    return "\n".join(["| scene, friction | steps | failures of Newton | deepest, of an element | steps with enclosed elements | with a wrong-way push | with inverted elements |",
                      "|---|--:|--:|--:|--:|--:|--:|", told.strip()])


# Table 4 of "Tetrahedron-Tetrahedron Intersection and Volume Computation Using Neural Networks": key of `tetlap eval --json`, heading, the paper's figure.
TABLE_4 = (("accuracy.none", "status correct, no intersection", "98.02 %"), ("accuracy.vertex-face", "vertex–face", "99.07 %"), ("accuracy.edge-face", "edge–face", "99.97 %"),
           ("accuracy.face-face", "face–face", "99.92 %"), ("accuracy.volumetric", "volumetric", "99.07 %"), ("accuracy_mean", "mean of the five", "99.37 %"),
           ("accuracy_swapped_mean", "mean, the two tetrahedra exchanged", "–"), ("mae_by_kind.none", r"mean \|ΔV\|, no intersection", "1.67e-7"),
           ("mae_by_kind.vertex-face", "vertex–face", "4.27e-9"), ("mae_by_kind.edge-face", "edge–face", "4.72e-9"), ("mae_by_kind.face-face", "face–face", "1.65e-9"),
           ("mae_by_kind.volumetric", "volumetric", "2.88e-3"), ("mae_small", "small (V < .0067)", "1.47e-3"), ("mae_medium", "medium (< .0133)", "2.80e-3"),
           ("mae_large", "large", "4.44e-3"), ("bin_accuracy_small", "correct bin, small", "88 %"), ("bin_accuracy_medium", "medium", "60 %"), ("bin_accuracy_large", "large", "41 %"))


def table_4(told):
    models = lists(told)

    def cell(model, key):
        for part in key.split("."):
            model = model[part]
        return figure(model, 3) if key.startswith("mae") else f"{100 * model:.{0 if key.startswith('bin') else 2}f} %"
    rows = [[heading, cell(models[0], key), paper, *(cell(model, key) for model in models[1:])] for key, heading, paper in TABLE_4]
    return table(["", f"`{models[0]['model']}`", "paper", *(f"`{model['model']}`" for model in models[1:])], rows)


def lists(told):
    """The JSON values that were printed one after the other."""
    decoder, found, told = json.JSONDecoder(), [], told.strip()
    while told:
        value, end = decoder.raw_decode(told)
        found.append(value)
        told = told[end:].lstrip()
    return found


def percent(share):
    return "–" if share is None else f"{100 * share:.2g} %"


def whole_runs(told):
    """A row a model and scene, from what `tetlap compare --json` printed for each scene."""
    rows = []
    for runs in lists(told):
        for run in runs:
            summary, counters = run["summary"], run["summary"]["counters"]
            pairs = counters["contact_pairs"]
            is_reference = run["model"] == run["reference"]
            rows.append([os.path.basename(run["scene"])[:-5], f"`{run['model']}`", run["outcome"], summary["steps"], counters["newton_iterations"], counters["newton_failures"],
                         "–" if is_reference else figure(run["trajectory_error"]), "–" if is_reference else figure(run["force_error_l2"]),
                         *("–" if is_reference else percent(counters[name] / pairs) for name in ("overlap_fallbacks", "overlap_blended")), figure(summary["cpu_s"], 3)])
    return table(["example", "model", "outcome", "steps", "Newton iterations", "failures", "path", "forces", "wholly", "partly", "processor time [s]"], rows, 3)


def bound(told):
    """A row a set of pairs and limit of the doubt, from what `tetlap eval hybrid --json` printed."""
    return table(["pairs", "`doubt`", "error within B", "B/V, median", "95 %", r"\|ΔV\|/V, median", "95 %", "wholly `clip`", "partly", "ΣΔV/ΣV", "moments", "∇V error"],
                 [[pairs, doubt, *(percent(row[key]) for key in ("bound_coverage", "bound_width_median", "bound_width_p95", "bound_error_median", "bound_error_p95", "handed_on",
                                                               "handed_on_in_part", "volume_error_sum", "moment_error", "gradient_error"))]
                  for (pairs, doubt), row in zip(((pairs, doubt) for pairs, _ in BOUND_PAIRS for doubt in BOUND_DOUBTS), lists(told))], 1)


def endurance(told):
    """A row a run of tests/long/endurance: name: t = …, N frames, N steps, memory N kB, growth N %, drift N m, weight to N, energy gain N."""
    rows = re.findall(r"^(\w+): t = .*?, (\d+) frames, (\d+) steps, memory (\d+) kB, growth (.*?), drift (.*?), weight to (.*?), energy gain (.*)$", told, re.M)
    return table(["run", "frames", "steps", "memory [kB]", "growth", "drift", "error of the weight", "energy gain"], rows)


def counter(name):
    return lambda summary, _: summary["counters"].get(name)


def counts(*names):
    return lambda summary, _: sum(summary["counters"].get(name) or 0 for name in names)


def value(name, digits=2):
    return lambda summary, _: figure(summary.get(name), digits)


COST = {"outcome": lambda summary, _: summary["outcome"], "steps": lambda summary, _: summary["steps"], "Newton iterations": counter("newton_iterations"),
        "failures": counter("newton_failures"), "factorisations": counter("factorisations"), "processor time [s]": value("cpu_s", 3)}
HEALTH = {"taken back": counts("energy_retries", "momentum_retries", "slip_retries"), "deepest": value("deepest_overlap_max"), "momentum gap": value("momentum_gap"),
          "energy gain": value("energy_gain_relative")}
PHASES = ("broad_phase", "overlap", "contact", "forces", "assembly", "analysis", "factorisation", "solve", "integration", "measures", "other")


def share_of(phase):
    return lambda summary, _: f"{100 * summary['phases'].get(phase, 0) / summary['wall_s']:.0f} %"


def examples():
    return [os.path.basename(path)[:-5] for path in sorted(glob.glob("examples/[0-9]*.yaml"))]


def contacts_give(summary, _):
    return figure(summary["contacts"][0]["estimate"]["give"], 3) if summary.get("contacts") else "–"


def last_of_scene(summary, rows):
    """The last row of the same scene: the stiffest, or the finest."""
    scene = next(labels[0] for labels, told in rows if told is summary)
    return [told for labels, told in rows if labels[0] == scene][-1]


def missing(summary, rows):
    stiff = last_of_scene(summary, rows)
    return "–" if stiff is summary else figure(1 - summary["contact_force_last"] / stiff["contact_force_last"], 3)


def peak_error(summary, rows):
    finest = last_of_scene(summary, rows)
    return "–" if finest is summary else f"{100 * abs(summary['contact_force_max'] / finest['contact_force_max'] - 1):.2g} %"


def peak_estimate(summary, _):
    return f"{100 * max((contact['estimate']['tolerance_over_depth'] or 0 for contact in summary['contacts']), default=0):.2g} %"


def example(name):
    return f"examples/{name}.yaml"


PRESS = "benchmarks/scenes/lost.yaml"
TABLES = {
    "models": Bench([["tetlap", "bench", "overlap", "-m", MODELS, "-s", "near", "-Q", "V,V+grad", "-r", "5", "--json"]], models_beside_clip, 1),
    "overlap": Bench([["tetlap", "bench", "overlap", "-t", "1", "-r", "3", "--json"]],
                     by_quantity("pairs_per_cpu_second", ("near", "uniform", "disjoint"), ("V", "V+centroid", "V+grad", "V+grad+hess")), 4),
    "overlap-threads": Bench([["tetlap", "bench", "overlap", "-s", "near", "-Q", "V,V+grad", "-b", "512,131072", "-t", "1,2", "-r", "3", "--json"]], threads, 4),
    "threads": Bench([["tools/measure/threads", "--program", "{program}", "--rounds", "2", "--plot", "{folder}/threads.svg", "heap:2", "heap:3", "heap:4", "tests/scenes/cubes.yaml", "examples/12_fold.yaml",
                       "examples/02_two_blocks.yaml@time.end=0.08;bodies.lower.mesh.box.cells=16;bodies.upper.mesh.box.cells=18"]], as_told, 15, ("threads.svg", "docs/images/threads.svg")),
    "networks": Bench([["tetlap-lab", "net", "-t", "1", "-r", "5", "--json"]], networks, 3),
    "frontier": Bench([["tools/measure/frontier", "--program", "{program}", "--pairs", "near", "-r", "3", "--sweep", "examples/train/sweep", "--wall", "5", "-o", "{folder}",
                        "examples/precision/edge.yaml"]], as_told, 12),
    "frontier-picture": Bench([["tools/measure/frontier", "--program", "{program}", "--pairs", "near", "--draw", "V+grad", "-o", "{folder}"]], as_told, 3,
                              ("pareto.svg", "docs/images/frontier.svg")),
    "centroid": Bench([["tetlap", "bench", "overlap", "-m", LEARNED, "-s", "near", "-Q", "V,V+centroid,V+grad", "-r", "7", "--json"]],
                      by_quantity("pairs_per_cpu_second", ("near",), ("V", "V+centroid", "V+grad")), 1),
    "unseen": Bench([["tetlap", "bench", "unseen", "-m", LEARNED, "--seeds", "3", "--json"]], unseen, 6),
    "whole-runs": Bench([["tetlap", "compare", "-q", "-j", "-t", "1", "--audit=0", "-m", "clip,geo-small,geo,hybrid", "-o", f"{{folder}}/{name}", example(name)] for name in BETWEEN_MESHES],
                        whole_runs, 3, shown="tetlap compare -q -j -t 1 --audit=0 -m clip,geo-small,geo,hybrid examples/NAME.yaml"),
    "bound": Bench([["tetlap", "eval", f"hybrid:{doubt}=geo-small", *law, "--count", "40000", "--json"] for _, law in BOUND_PAIRS for doubt in BOUND_DOUBTS], bound, 1,
                   shown="tetlap eval hybrid:DOUBT=geo-small --law LAW --mix KIND=1 --seed SEED --count 40000 --json"),
    "in-place": Bench([["{python}", "tools/measure/in_place", "{program}"]], as_told, 1),
    "ranking": Bench([["tools/measure/ranking", "--rows", "benchmarks/ranking.json"]], as_told, 0.1),
    "learned": Bench([["tools/measure/learned", "{program}"]], as_told, 10),
    "own-models": Bench([["tools/measure/own", "{program}"]], as_told, 2),
    "precision": Bench([["tools/measure/precision", "--program", "{program}", "-m", "clip,geo,geo-small,hybrid", *(f"examples/precision/{name}.yaml"
                        for name in ("blocks", "collision", "edge", "landing", "press", "spheres"))]], as_told, 30),
    "time": Bench([["tools/measure/time_errors", "--program", "{program}", "--finer", "10"]], as_told, 20),
    "table-4": Bench([["tetlap", "eval", model, "--law", "paper-test", "--count", "500000", "--seed", "9001", "--json"] for model in ("tpn-published", "tpn")], table_4, 1),
    "data": Bench([["tools/measure/data", "{program}"]], as_told, 1),
    "endurance": Bench([["tests/long/endurance", "3600", "{program}"]], endurance, 3),
    "stepping": Bench([["python/rate_simulation"]], as_told, 2),
    "gradients": Bench([["tools/measure/gradients", "{program}"]], as_told, 1),
    "hard-scenes": Bench([["tetlap", "stress", "-q", "--scenes", "--overlap", "clip,geo", "--json", "{folder}/scenes.json"], ["tools/measure/hard_cases", "{folder}/scenes.json"]], as_told, 15, fails=70),
    "hard-pairs": Bench([["tetlap", "stress", "-q", "--pairs", "--json", "{folder}/pairs.json"], ["tools/measure/hard_cases", "{folder}/pairs.json"]], as_told, 15, fails=70),
    "cubes": Bench([["tests/long/cubes", "{program}"]], cubes, 2),
    "effects": Bench([["tools/measure/frame_cost", "{build}"]], as_told, 2),
    "validation": Bench([["tools/measure/validate", "{program}"]], lambda told: "| what | theory | measured | steps |\n|---|---|---|---|\n" + told.strip(), 15),
    "gpu": Bench([["tools/measure/gpu"]], as_told, 8, lacks=69),
    "examples": Runs(["example"], [([name], example(name), (), ()) for name in examples()], {**COST, **HEALTH}, 2),
    "potentials": Runs(["scene", "potential"], [([name, potential], example(name), (f"contact.potential={potential}", "contact.friction=0"), ()) for name in (*MOVING, *STATIC)
                                                for potential in ("field", "nodal")], COST, 3),
    "damped": Runs(["15_sleepers"], [([label], example("15_sleepers"), sets, ()) for label, sets in
                                     (("as it is", ()), *((f"`{one}`", (one,)) for one in ("contact.stiffness=5e8", "contact.stiffness=1e9", "contact.stiffness=2e9", "effects.damping=1e-4")))],
                   {"deepest": value("deepest_overlap_max"), "largest force [N]": value("contact_force_max", 3), **COST}, 0.5),
    "give": Runs(["press", "c [Pa/m]"], [([press, stiffness or "chosen"], PRESS, (*sets, *([f"contact.stiffness={stiffness}"] if stiffness else [])), ())
                                         for press, sets in (("two equal blocks, ν = 0", ("bodies[0].material.poisson=0", "bodies[1].material.poisson=0")),
                                                             ("ν = 0.3", ()), ("ν = 0.45", ("bodies[0].material.poisson=0.45", "bodies[1].material.poisson=0.45")),
                                                             ("half as large into a block", ("bodies[1].mesh.box.size=[0.05,0.05,0.05]", "bodies[1].driven[0].table=[[0,0,0,0],[1,0,0,-0.0005]]",
                                                                                             "bodies[1].place.translate=[0.025,0.025,0.1]")))
                                         for stiffness in (None, "2e7", "1e9", "1e10")],
                 {"force [N]": value("contact_force_last", 4), "`give`": contacts_give, "of the force is missing": missing}, 0.5),
    "peaks": Runs(["scene", "`time.tolerance`"], [([name, tolerance], example(name), (f"time.tolerance={tolerance}",), ()) for name in ("01_drop", "03_spheres", "05_press", "10_incline", "13_dead_bounce")
                                                  for tolerance in ("1e-3", "1e-4", "1e-5")],
                  {"largest force [N]": value("contact_force_max", 4), "from the finest": peak_error, "`tolerance_over_depth`": peak_estimate}, 2),
    "peers": Bench([command for name in ("lost", "pressed_deep") for command in
                    (["{python}", "tools/measure/peers", "write", "calculix", f"benchmarks/scenes/{name}.yaml", "-o", f"{{folder}}/{name}", "--program", "{program}"],
                     ["sh", "-c", f"cd {{folder}}/{name} && command -v ccx > ccx.log || exit 127; OMP_NUM_THREADS=1 ccx scene > ccx.log"])]
                   + [["{python}", "tools/measure/peers", "read", "{folder}/lost", "{folder}/pressed_deep"]],
                   lambda told: "\n".join(line for line in told.splitlines() if line.startswith("|")), 1, lacks=127),
    "drop": Runs(["c [Pa/m]", "tolerance"], [([stiffness, tolerance], "app/stress/scenes/drop.yaml", (f"contact.stiffness={stiffness}", f"time.tolerance={tolerance}"), ())
                                             for stiffness in ("1e6", "1e7", "1e8", "1e9", "1e10") for tolerance in ("1e-2", "1e-4", "1e-6")],
                 {"energy gain": value("energy_gain_relative"), "steps": COST["steps"], "taken back": HEALTH["taken back"], "processor time [s]": value("cpu_s", 3)}, 1),
    "phases": Runs(["scene"], [([label], scene, sets, ()) for label, scene, sets in
                               (("02_two_blocks", example("02_two_blocks"), ()), ("02_two_blocks, `geo`", example("02_two_blocks"), ("contact.overlap=geo",)),
                                ("02_two_blocks, 20,736 elements", example("02_two_blocks"), ("time.end=0.05", "bodies[0].mesh.box.cells=12", "bodies[1].mesh.box.cells=12",
                                                                                              "bodies[1].place.translate=[-0.04,-0.08,0.2]")),
                                ("04_cantilever", example("04_cantilever"), ()))],
                   {"steps": COST["steps"], "wall time [s]": value("wall_s", 3), **{phase: share_of(phase) for phase in PHASES}}, 1),
    "steps": Runs(["vertices", "solver"], [([vertices, solver], "benchmarks/scenes/blocks.yaml", (f"bodies.lower.mesh.box.cells={lower}", f"bodies.upper.mesh.box.cells={upper}",
                                                                                                 f"solver.linear={solver}"), ())
                                           for solver, sizes in (("cholmod", ((1072, 6, 8), (10234, 14, 18), (26837, 20, 25))), ("amg", ((10234, 14, 18), (45416, 24, 30), (137781, 35, 44))))
                                           for vertices, lower, upper in sizes],
                  {"processor time a step [s]": lambda summary, _: figure(summary["cpu_s"] / summary["steps"], 3), "Newton iterations": counter("newton_iterations"),
                   "factorisations": counter("factorisations"), "iterations a solve": lambda summary, _: figure((summary["counters"].get("linear_iterations") or 0) / max(1, summary["counters"]["linear_solves"])),
                   "largest memory [MB]": lambda summary, _: round(summary["peak_rss_bytes"] / 1e6)}, 3),
    "pairs": Bench([["tetlap", "bench", "overlap", "-m", "clip,geo-small,geo", "-s", "near", "-Q", "V+grad", "-b", "1e3,1e4,1e5,1e6", "-r", "3", "--json"]],
                   lambda told: table(["model", "pairs", "processor time a pair [s]"], [[f"`{row['model']}`", row["batch"], figure(1 / row["pairs_per_cpu_second"], 3)] for row in objects(told)]), 1),
    "solvers": Runs(["vertices", "solver"], [([vertices, solver], "benchmarks/scenes/beam.yaml", (f"bodies.beam.mesh.box.cells={cells}", f"solver.linear={solver}"), ())
                                             for vertices, cells, solvers in ((5000, "[49,9,9]", ("cholmod", "amg", "gamg", "pcg", "klu")), (19968, "[77,15,15]", ("cholmod", "amg", "gamg", "pcg")))
                                             for solver in solvers],
                    {"steps": COST["steps"], "set-ups": counter("factorisations"), "a set-up [s]": lambda summary, _: per(summary, "factorisation", "factorisations"),
                     "a solution [s]": lambda summary, _: per(summary, "solve", "linear_solves"), "iterations a solve": lambda summary, _: figure((summary["counters"].get("linear_iterations") or 0) / max(1, summary["counters"]["linear_solves"])),
                     "processor time [s]": value("cpu_s", 3)}, 4),
    "large": Runs(["scene", "solver"], [([name, solver], f"benchmarks/scenes/{name}.yaml", (*cells, f"solver.linear={solver}"), ()) for name, cells in
                                        (("blocks", ("bodies.lower.mesh.box.cells=24", "bodies.upper.mesh.box.cells=30")), ("pressed", ("bodies.lower.mesh.box.cells=24", "bodies.upper.mesh.box.cells=30")),
                                         ("ball", ("bodies.block.mesh.box.cells=36",))) for solver in ("cholmod", "amg")],
                  {**COST, "largest memory [MB]": lambda summary, _: round(summary["peak_rss_bytes"] / 1e6)}, 5),
    "million": Bench([["tests/long/million", "4", "{build}"]], as_told, 10),
    "ranks": Runs(["ranks", "vertices"], [([count, (cells + 1)**3], "benchmarks/scenes/ball.yaml", (f"bodies.block.mesh.box.cells={cells}", "solver.linear=amg"), ("--ranks", str(count)))
                                          for count, cells in ((1, 27), (2, 34), (4, 43))],
                  {"Newton iterations": counter("newton_iterations"), "iterations": counter("linear_iterations"),
                   "memory a rank [MB]": lambda summary, _: round(rank_most(summary, "peak_rss_bytes") / 1e6)}, 3),
}


def per(summary, phase, count):
    number = summary["counters"].get(count)
    return figure(summary["phases"][phase] / number, 3) if number else "–"


def rank_most(summary, name):
    told = (summary.get("ranks") or {}).get(name)
    return told["most"] if told else summary[name]
