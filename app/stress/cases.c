// SPDX-License-Identifier: GPL-3.0-or-later
// The hard scenes: what each is made of, and the physics that it must keep. Bodies and obstacles by number,
// in the order of their scene file, obstacles after the bodies.
#include <math.h>
#include <string.h>

#include "app/stress/linking.h"
#include "app/stress/scenes.h"
#include "app/stress/slabs.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"

static const double G = 9.81;

static double length_of(const double v[3]) {
  return vec3_length(vec3_at(v));
}

static void judge_nothing(const AppStressRun *run, AppStressRow *row) {
  (void)run, (void)row;
}

// The largest covered volume, over the upper body's: what passes through is covered whole on its way.
static void ask_no_passage(const AppStressRun *run, AppStressRow *row) {
  const FemModelBody *upper = &run->model.bodies[1];
  double volume = upper->mass / run->model.parts[upper->part_begin].material.density;
  app_stress_ask_most(row, "share of the body inside", run->result.contact.overlap_volume_max / volume, 0.02);
}

// No force can exceed what crushes the base: E times its area.
static void ask_sharp(const AppStressRun *run, AppStressRow *row) {
  ask_no_passage(run, row);
  double width = app_stress_run_highest(run, 0, 1, 0) - app_stress_run_lowest(run, 0, 1, 0);
  double depth = app_stress_run_highest(run, 0, 1, 1) - app_stress_run_lowest(run, 0, 1, 1);
  double young = run->model.parts[1].material.young;
  app_stress_ask_most(row, "force over E A", run->result.contact.force_max / (young * width * depth), 1);
}

static void ask_mirrored(const AppStressRun *run, AppStressRow *row, int frame, double most) {
  app_stress_ask_most(row, "asymmetry in x", app_stress_run_asymmetry(run, frame, 0), most);
  app_stress_ask_most(row, "asymmetry in y", app_stress_run_asymmetry(run, frame, 1), most);
}

static void judge_sharp(const AppStressRun *run, AppStressRow *row) {
  ask_sharp(run, row);
  ask_mirrored(run, row, -1, 1e-6);
}

// The first frame in which the two bodies touch; the last if none.
static int find_touch(const AppStressRun *run) {
  int last = app_stress_run_frames(run) - 1;
  for (int f = 0; f < last; f++) {
    double force[3] = {0, 0, 0};
    app_stress_run_force(run, f, "lower, upper", force);
    if (length_of(force) > 0) return f;
  }
  return last;
}

// What is balanced on a tip or an edge is unstable: an asymmetry grows at a rate of √(k/m), k the slope of
// the force sideways and m the mass of the tip: here by e² to e⁹ in a frame of 1 ms, at any tolerance. Two
// frames after the touch, rounding has grown to 1e-16 e¹⁸ = 7e-9 at most, and a method that prefers a side
// stands out. At the end the body has slid off, and no energy was gained or lost.
static void judge_balanced(const AppStressRun *run, AppStressRow *row) {
  int frame = find_touch(run) + 2, last = app_stress_run_frames(run) - 1;
  const FemAudit *audit = &run->result.energy.audit;
  double end = fmax(app_stress_run_asymmetry(run, -1, 0), app_stress_run_asymmetry(run, -1, 1));
  ask_sharp(run, row);
  ask_mirrored(run, row, frame < last ? frame : last, 1e-8);
  app_stress_ask_occurred(row, "asymmetry at the end", end, 0.01);
  app_stress_ask_most(row, "energy lost", fem_audit_lost(audit) / audit->scale, 0.01);
}

// The tilt of the first body's top at the end: highest less lowest of its vertices, over its width.
static double tilt_of(const AppStressRun *run) {
  double top = app_stress_run_highest(run, 0, 0, 2), low = INFINITY, high = -INFINITY;
  double width = app_stress_run_highest(run, 0, 0, 0) - app_stress_run_lowest(run, 0, 0, 0);
  for (int a = run->model.bodies[0].vertex_begin; a < run->model.bodies[0].vertex_end; a++) {
    if (run->model.rest[3 * a + 2] < top - 1e-9) continue;
    low = fmin(low, app_stress_run_position(run, -1, a)[2]);
    high = fmax(high, app_stress_run_position(run, -1, a)[2]);
  }
  return (high - low) / width;
}

static void judge_cliff(const AppStressRun *run, AppStressRow *row) {
  double before[3], after[3];
  app_stress_run_centre(run, 0, 0, before), app_stress_run_centre(run, -1, 0, after);
  app_stress_ask_most(row, "tilt", tilt_of(run), 0.01);
  app_stress_ask_most(row, "sideways", hypot(after[0] - before[0], after[1] - before[1]) / 0.1, 0.01);
  app_stress_ask_most(row, "fall", (before[2] - after[2]) / 0.1, 0.02);
}

// 0.24 m at 0.8 m/s over two joints.
static void judge_tiles(const AppStressRun *run, AppStressRow *row) {
  double before[3], after[3], last[3], highest = -INFINITY;
  int frames = app_stress_run_frames(run);
  app_stress_run_centre(run, 0, 0, before), app_stress_run_centre(run, -1, 0, after);
  app_stress_run_centre(run, -2, 0, last);
  for (int f = 0; f < frames; f++) {
    double centre[3];
    app_stress_run_centre(run, f, 0, centre);
    highest = fmax(highest, centre[2]);
  }
  double way = after[0] - before[0], step = run->scene.end / (frames - 1);
  app_stress_ask_occurred(row, "way past both joints [m]", way, 0.18);
  app_stress_ask_most(row, "sideways over the way", fabs(after[1] - before[1]) / way, 1e-3);
  app_stress_ask_least(row, "speed kept", (after[0] - last[0]) / step / 0.8, 0.98);
  app_stress_ask_most(row, "jump over the size", (highest - before[2]) / 0.1, 5e-3);
  app_stress_ask_most(row, "tilt", tilt_of(run), 0.01);
}

static void judge_tight(const AppStressRun *run, AppStressRow *row) {
  double worst = 0, before[3], after[3];
  for (int a = 0; a < run->model.bodies[0].vertex_end; a++)
    worst = fmax(worst, vec3_length(vec3_sub(vec3_at(app_stress_run_position(run, -1, a)),
                                             vec3_at(app_stress_run_position(run, -2, a)))));
  app_stress_run_centre(run, 0, 0, before), app_stress_run_centre(run, -1, 0, after);
  app_stress_ask_most(row, "motion in the last frame [m]", worst, 1e-6);
  app_stress_ask_most(row, "way over the size", vec3_length(vec3_sub(vec3_at(after), vec3_at(before))) / 0.1,
                      0.01);
}

// The lowest body carries all: its force on the ground against the weight.
static void judge_stack(const AppStressRun *run, AppStressRow *row) {
  double mass = 0, force[3] = {NAN, NAN, NAN}, order = 1;
  int bodies = run->scene.body_count;
  for (int b = 0; b < bodies; b++) mass += run->model.bodies[b].mass;
  app_stress_run_force(run, -1, "cube1, ground", force);
  for (int b = 1; b < bodies; b++)
    if (!(app_stress_run_lowest(run, -1, b, 2) > app_stress_run_lowest(run, -1, b - 1, 2) + 0.1)) order = 0;
  app_stress_ask_most(row, "error of the weight", fabs(force[2] / (mass * G) - 1), 1e-3);
  app_stress_ask_least(row, "each stands on the one below", order, 1);
}

static void judge_burden(const AppStressRun *run, AppStressRow *row) {
  double force[3] = {NAN, NAN, NAN}, weight = run->model.bodies[1].mass * G;
  app_stress_run_force(run, -1, "soft, heavy", force);
  app_stress_ask_most(row, "error of the weight", fabs(force[2] / -weight - 1), 1e-2);
  app_stress_ask_least(row, "height over the soft one's", app_stress_run_lowest(run, -1, 1, 2) / 0.1, 0.9);
}

enum { MAT_CELLS = 20, MAT_LINES = 9 };

// The line halfway through the mat at rest at this y, in the order of x, in a frame.
static bool mat_line(const AppStressRun *run, int frame, double y, double line[3 * (MAT_CELLS + 1)]) {
  int count = 0;
  memset(line, 0, 3 * (MAT_CELLS + 1) * sizeof *line);
  for (int a = 0; a < run->model.vertex_count; a++) {
    const double *X = run->model.rest + 3 * a, *x = app_stress_run_position(run, frame, a);
    int k = (int)lround(X[0] * MAT_CELLS);
    if (fabs(X[1] - y) > 1e-9 || k < 0 || k > MAT_CELLS) continue;
    for (int c = 0; c < 3; c++) line[3 * k + c] += x[c] / 2;
    count++;
  }
  return count == 2 * (MAT_CELLS + 1);
}

// Lines along the mat wind around each other by what the ends are turned; where a layer passed through
// another, their linking jumps by a turn from one frame to the next. They run halfway through the thickness
// and inside of the rims: lines on the surface cross wherever two layers overlap at all.
static void judge_mat(const AppStressRun *run, AppStressRow *row) {
  double lines[MAT_LINES][3 * (MAT_CELLS + 1)], before[MAT_LINES][MAT_LINES] = {{0}}, jump = 0, turns = 0;
  for (int f = 0; f < app_stress_run_frames(run); f++) {
    for (int k = 0; k < MAT_LINES; k++)
      if (!mat_line(run, f, 0.1 * (k + 1), lines[k])) jump = NAN;
    for (int k = 0; k < MAT_LINES; k++)
      for (int l = 0; l < k; l++) {
        double linking = app_stress_linking(lines[k], MAT_CELLS + 1, lines[l], MAT_CELLS + 1);
        if (f > 0 && !(fabs(linking - before[k][l]) <= jump)) jump = fabs(linking - before[k][l]);
        before[k][l] = linking, turns = fmax(turns, fabs(linking));
      }
  }
  app_stress_ask_occurred(row, "deepest overlap of an element", run->result.contact.deepest_overlap_max,
                          0.05);
  app_stress_ask_occurred(row, "turns that lines along it wind around each other", turns, 1);
  app_stress_ask_most(row, "jump of their linking (a passage: 1)", jump, 0.5);
  app_stress_ask_most(row, "covered share of an element", run->result.contact.deepest_overlap_max, 0.9);
}

static void judge_ball(const AppStressRun *run, AppStressRow *row) {
  double deepest = INFINITY, before[3], after[3];
  for (int f = 0; f < app_stress_run_frames(run); f++)
    deepest = fmin(deepest, app_stress_run_lowest(run, f, 0, 0));
  app_stress_run_centre(run, -2, 0, before), app_stress_run_centre(run, -1, 0, after);
  double step = run->scene.end / run->scene.frames, speed = (after[0] - before[0]) / step;
  app_stress_ask_least(row, "deepest vertex over the wall", deepest / 0.02, -0.5);
  app_stress_ask_least(row, "speed out over in", speed / 67, 0.2);
  app_stress_ask_most(row, "speed out over in, at most", speed / 67, 1);
}

static void judge_spheres(const AppStressRun *run, AppStressRow *row) {
  double linear[3], angular[3];
  for (int c = 0; c < 3; c++) {
    linear[c] = run->momentum[1][c] - run->momentum[0][c];
    angular[c] = run->angular[1][c] - run->angular[0][c];
  }
  app_stress_ask_most(row, "change of momentum", length_of(linear) / length_of(run->momentum[0]), 1e-8);
  app_stress_ask_most(row, "change of angular momentum", length_of(angular) / length_of(run->angular[0]),
                      1e-8);
}

static void judge_drop(const AppStressRun *run, AppStressRow *row) {
  double deepest = INFINITY;
  for (int f = 0; f < app_stress_run_frames(run); f++)
    deepest = fmin(deepest, app_stress_run_lowest(run, f, 0, 2));
  app_stress_ask_least(row, "deepest vertex [m]", deepest, -0.05);
}

static void judge_onset(const AppStressRun *run, AppStressRow *row) {
  app_stress_ask_occurred(row, "pairs at once", run->result.contact.pairs_max, 100);
  app_stress_ask_most(row, "restarts", (double)run->result.integrator.restarts, 60);
}

// Apart at the end, or reported.
static void judge_deep(const AppStressRun *run, AppStressRow *row) {
  double gap = app_stress_run_lowest(run, -1, 1, 0) - app_stress_run_highest(run, -1, 0, 0);
  const FemTrouble *trouble = &run->result.trouble;
  bool is_told = run->message[0] || trouble->of[FEM_TROUBLE_ENCLOSED].steps > 0 ||
                 trouble->of[FEM_TROUBLE_WRONG_WAY].steps > 0;
  app_stress_ask_occurred(row, "deepest overlap of an element", run->result.contact.deepest_overlap_max, 0.3);
  app_stress_ask_least(row, "apart, or told of", gap > 0 || is_told, 1);
  app_stress_ask_least(row, "gap at the end [m]", gap, 0);
}

static void judge_inside(const AppStressRun *run, AppStressRow *row) {
  app_stress_ask_occurred(row, "enclosed pairs", (double)run->result.contact.pairs.enclosed, 1);
  app_stress_ask_least(row, "steps told of", (double)run->result.trouble.of[FEM_TROUBLE_ENCLOSED].steps, 1);
}

static void judge_crush(const AppStressRun *run, AppStressRow *row) {
  double least = INFINITY;
  for (int f = 0; f < app_stress_run_frames(run); f++)
    least = fmin(least, app_stress_run_highest(run, f, 0, 2));
  app_stress_ask_occurred(row, "pressed to, of its height (negative)", -least / 0.1, -0.65);
  app_stress_ask_most(row, "distortion at the end", app_stress_run_distortion(run), 0.02);
}

static void judge_inverted(const AppStressRun *run, AppStressRow *row) {
  app_stress_ask_occurred(row, "inverted at first (−det F)", -run->result.min_det_F, 1e-3);
  app_stress_ask_occurred(row, "steps told of", (double)run->result.trouble.of[FEM_TROUBLE_INVERTED].steps,
                          1);
  app_stress_ask_most(row, "distortion at the end", app_stress_run_distortion(run), 0.05);
}

// The middle vertex goes through its neighbours.
static Status run_inverted(AppStressRun *run) {
  double *displacement = memory_zeroed(3 * (size_t)run->model.vertex_count, sizeof *displacement);
  if (!displacement) return status_no_memory("an initial displacement");
  for (int a = 0; a < run->model.bodies[0].vertex_end; a++) {
    const double *X = run->model.rest + 3 * a;
    if (fabs(X[0] - 0.1) + fabs(X[1] - 0.1) + fabs(X[2] - 0.0995) < 1e-9) displacement[3 * a] = 0.13;
  }
  run->initial_displacement = displacement;
  Status status = app_stress_run_scene(run);
  run->initial_displacement = NULL;
  memory_free(displacement);
  return status;
}

// Timoshenko under its weight: q L⁴/(8 E I) + q L²/(2 k G A), k = 5/6.
static void judge_beam(const AppStressRun *run, AppStressRow *row) {
  double L = 0.5, h = 0.1, q = 1000 * 1.0 * h * h, young = run->model.parts[0].material.young, tip = 0;
  double shear = young / (2 * (1 + run->model.parts[0].material.poisson));
  double theory = q * pow(L, 4) / (8 * young * pow(h, 4) / 12) + q * L * L / (2 * (5.0 / 6) * shear * h * h);
  int count = 0;
  for (int a = 0; a < run->model.vertex_count; a++) {
    if (run->model.rest[3 * a] < L - 1e-9) continue;
    tip += run->model.rest[3 * a + 2] - app_stress_run_position(run, -1, a)[2];
    count++;
  }
  app_stress_ask_occurred(row, "deflection over theory", tip / count / theory, 0.1);
  app_stress_ask_most(row, "error of the deflection", fabs(tip / count / theory - 1), 0.1);
}

// `least`: elements of 2 cm flown through in the longest step.
static void judge_tunnel(const AppStressRun *run, AppStressRow *row, double least) {
  double plate[3], target[3];
  app_stress_run_centre(run, -1, 1, plate), app_stress_run_centre(run, -1, 0, target);
  app_stress_ask_occurred(row, "elements in one step", run->flight / 0.02, least);
  app_stress_ask_least(row, "plate before the target [m]", plate[0] - target[0], 0);
}

static void judge_tunnel_1(const AppStressRun *run, AppStressRow *row) {
  judge_tunnel(run, row, 0.9);
}
static void judge_tunnel_10(const AppStressRun *run, AppStressRow *row) {
  judge_tunnel(run, row, 9);
}
static void judge_tunnel_100(const AppStressRun *run, AppStressRow *row) {
  judge_tunnel(run, row, 90);
}
static void judge_tunnel_1000(const AppStressRun *run, AppStressRow *row) {
  judge_tunnel(run, row, 900);
}

enum {
  SOUND = APP_STRESS_ENDS | APP_STRESS_TOUCHES | APP_STRESS_ENERGY,
  UPRIGHT = SOUND | APP_STRESS_UPRIGHT,
};

// Regular tetrahedra, turned so that one edge lies along y at the bottom and the opposite one along x on top;
// or that by 90° about z.
#define ON_EDGE "rotate: {axis: [0, 1, 0], degrees: -54.7356103}, "
#define ON_EDGE_TURNED "rotate: {axis: [0.417681254, -0.417681254, 0.806898222], degrees: 102.200004}, "
#define LOWER_ON_EDGE "bodies.lower.place={" ON_EDGE "translate: [0.0166667, 0, 0.0235702]}"

// Upside down, its point at a height.
#define DOWN_TO(z) "bodies.upper.place={rotate: {axis: [1, 0, 0], degrees: 180}, translate: [0, 0, " z "]}"
#define HELD_ABOVE(z)                                                                                        \
  "bodies.upper.driven=[{halfspace: {point: [0, 0, " z "], normal: [0, 0, -1]}, velocity: [0, 0, -1]}]"
#define HELD_AT_BOTTOM "bodies.lower.fixed=[{halfspace: {point: [0, 0, -0.149999], normal: [0, 0, 1]}}]"
#define MESH(body, name) "bodies." body ".mesh=../../../meshes/" name ".mesh"

// A plate that needs one step of `step` s at 1 m/s to come within reach of the target, `gap` m away.
#define FIRED(gap, step, end)                                                                                \
  "bodies.plate.place={translate: [" gap ", 0.021, 0.019]}", "time.initial_step=" step,                      \
      "time.max_step=" step, "time.end=" end

// An upper slab of so many cubes of an edge of the lower one's times `ratio`.
#define SLAB(width, height, count, corner)                                                                   \
  "bodies.upper.mesh={box: {size: [" width ", " width ", " height "], cells: [" count ", " count ", 2]}}",   \
      "bodies.upper.place={translate: [" corner ", 0]}"
#define FLAT_SLABS "slabs", 0, .judge = app_stress_slabs_judge, .run = app_stress_slabs_run, .is_still = true

#define DROP "drop", SOUND, .judge = judge_drop

static const AppStressScene cases[] = {
    {"vertex on face", "tetrahedra", UPRIGHT, .judge = judge_nothing, .is_quick = true,
     .overrides = {"bodies.upper.place={rotate: {axis: [1, 0, 0], degrees: 180}, translate: [0.0096, 0.0167, "
                   "0.15]}"}},
    {"face on vertex", "tetrahedra", UPRIGHT, .judge = judge_nothing},
    {"vertex on vertex", "tetrahedra", UPRIGHT, .judge = judge_nothing, .is_quick = true,
     .overrides = {DOWN_TO("0.18")}},
    {"edge on edge, crossed", "tetrahedra", UPRIGHT, .judge = judge_nothing, .is_quick = true,
     .overrides = {LOWER_ON_EDGE, "bodies.upper.place={" ON_EDGE "translate: [0.0166667, 0, 0.11]}"}},
    {"edge on edge, parallel", "tetrahedra", UPRIGHT, .judge = judge_nothing,
     .overrides = {LOWER_ON_EDGE, "bodies.upper.place={" ON_EDGE_TURNED "translate: [0, 0.0166667, 0.11]}"}},
    {"spikes", "sharp", SOUND, .judge = judge_balanced, .is_quick = true},
    {"wedges, crossed", "sharp", SOUND, .judge = judge_sharp,
     .overrides = {MESH("lower", "wedge"), MESH("upper", "wedge"),
                   "bodies.upper.place={rotate: {axis: [1, 1, 0], degrees: 180}, translate: [0, 0, 0.242]}"}},
    {"wedges, parallel", "sharp", SOUND, .judge = judge_balanced,
     .overrides = {MESH("lower", "wedge"), MESH("upper", "wedge")}},
    {"spike and wedge", "sharp", SOUND, .judge = judge_balanced,
     .overrides = {MESH("lower", "wedge"), "time.end=0.024", "output.frames=24"}},
    {"wedge in a crack", "sharp", SOUND, .judge = judge_sharp,
     .overrides = {MESH("lower", "crack"), MESH("upper", "wedge"), HELD_AT_BOTTOM, DOWN_TO("0.032"),
                   HELD_ABOVE("0.0319")}},
    {"spike in a hole", "sharp", SOUND, .judge = judge_sharp, .is_quick = true,
     .overrides = {MESH("lower", "hole"), HELD_AT_BOTTOM, DOWN_TO("0.032"), HELD_ABOVE("0.0319")}},
    {"cliff edge", "cliff", UPRIGHT, .judge = judge_cliff},
    {"internal edges", "tiles", UPRIGHT, .judge = judge_tiles},
    {"flat slabs, edge ratio 1", FLAT_SLABS, .overrides = {SLAB("9", "2", "9", "-4.47, -4.19")}},
    {"flat slabs, edge ratio 1/2", FLAT_SLABS, .overrides = {SLAB("9", "1", "18", "-4.47, -4.19")}},
    {"flat slabs, edge ratio 0.77", FLAT_SLABS, .is_quick = true},
    {"flat slabs, aligned", FLAT_SLABS, .overrides = {SLAB("9", "2", "9", "-5, -5")}},
    {"tight fit", "tight", UPRIGHT, .judge = judge_tight},
    {"stack of 5", "stack5", UPRIGHT, .judge = judge_stack, .limit_s = 120},
    {"stack of 10", "stack10", UPRIGHT, .judge = judge_stack, .limit_s = 300},
    {"mass ratio 1e4", "burden", UPRIGHT, .judge = judge_burden,
     .overrides = {"bodies.soft.material.density=0.1"}},
    {"mass ratio 1e6", "burden", UPRIGHT, .judge = judge_burden,
     .overrides = {"bodies.soft.material.density=1e-3"}},
    {"stiffness ratio 1e4", "burden", UPRIGHT, .judge = judge_burden,
     .overrides = {"bodies.heavy.material.young=1e9"}},
    {"stiffness ratio 1e6", "burden", UPRIGHT, .judge = judge_burden,
     .overrides = {"bodies.heavy.material.young=1e11"}},
    {"mat twist", "mat", UPRIGHT, .judge = judge_mat, .limit_s = 300},
    {"mat twist, 3.2 turns", "mat", UPRIGHT, .judge = judge_mat, .limit_s = 300,
     .overrides = {"time.end=8", "output.frames=80"}},
    {"ball on wall, 67 m/s", "ball", SOUND, .judge = judge_ball, .limit_s = 120},
    {"two spheres", "spheres", SOUND, .judge = judge_spheres, .limit_s = 120},
    {"drop, stiffness 1e6", DROP, .overrides = {"contact.stiffness=1e6"}},
    {"drop, stiffness 1e7", DROP, .is_quick = true, .overrides = {"contact.stiffness=1e7"}},
    {"drop, stiffness 1e8", DROP, .overrides = {"contact.stiffness=1e8"}},
    {"drop, stiffness 1e9", DROP, .overrides = {"contact.stiffness=1e9"}},
    {"drop, stiffness 1e10", DROP, .overrides = {"contact.stiffness=1e10"}},
    {"drop, tolerance 1e-2", DROP, .is_quick = true, .overrides = {"time.tolerance=1e-2"}},
    {"drop, tolerance 1e-3", DROP, .overrides = {"time.tolerance=1e-3"}},
    {"drop, tolerance 1e-5", DROP, .overrides = {"time.tolerance=1e-5"}},
    {"drop, tolerance 1e-6", DROP, .limit_s = 120, .overrides = {"time.tolerance=1e-6"}},
    {"drop, stiffness 1e6, tolerance 1e-2", DROP,
     .overrides = {"contact.stiffness=1e6", "time.tolerance=1e-2"}},
    {"drop, stiffness 1e6, tolerance 1e-6", DROP, .limit_s = 120,
     .overrides = {"contact.stiffness=1e6", "time.tolerance=1e-6"}},
    {"drop, stiffness 1e10, tolerance 1e-2", DROP,
     .overrides = {"contact.stiffness=1e10", "time.tolerance=1e-2"}},
    {"drop, stiffness 1e10, tolerance 1e-6", DROP, .limit_s = 120,
     .overrides = {"contact.stiffness=1e10", "time.tolerance=1e-6"}},
    {"simultaneous onset", "onset", SOUND, .judge = judge_onset},
    {"deep start", "deep", APP_STRESS_TOUCHES | APP_STRESS_ENERGY, .judge = judge_deep, .is_quick = true},
    {"tetrahedron inside", "inside", APP_STRESS_TOUCHES, .judge = judge_inside, .is_quick = true},
    {"crush", "crush", SOUND, .judge = judge_crush},
    {"inverted start", "inverted", SOUND, .judge = judge_inverted, .run = run_inverted},
    {"nearly incompressible, 0.45", "beam", APP_STRESS_ENDS, .judge = judge_beam, .is_any = true,
     .limit_s = 200},
    {"nearly incompressible, 0.49", "beam", APP_STRESS_ENDS, .judge = judge_beam, .is_any = true,
     .limit_s = 200, .overrides = {"bodies.beam.material.poisson=0.49"}},
    {"nearly incompressible, 0.499", "beam", APP_STRESS_ENDS, .judge = judge_beam, .is_any = true,
     .limit_s = 200, .overrides = {"bodies.beam.material.poisson=0.499"}},
    {"nearly incompressible, 0.499, quadratic", "beam", APP_STRESS_ENDS, .judge = judge_beam, .is_any = true,
     .overrides = {"bodies.beam.material.poisson=0.499", "bodies.beam.element=quadratic",
                   "bodies.beam.mesh.box.cells=[10, 2, 2]"}},
    {"tunnelling, 1 element a step", "tunnel", SOUND, .judge = judge_tunnel_1,
     .overrides = {FIRED("0.055", "0.02", "0.1")}},
    {"tunnelling, 10 elements a step", "tunnel", SOUND, .judge = judge_tunnel_10,
     .overrides = {FIRED("0.35", "0.2", "0.4")}},
    {"tunnelling, 100 elements a step", "tunnel", SOUND, .judge = judge_tunnel_100,
     .overrides = {FIRED("3.5", "2", "3.6")}},
    {"tunnelling, 1000 elements a step", "tunnel", SOUND, .judge = judge_tunnel_1000, .is_quick = true,
     .overrides = {FIRED("70", "40", "70.2")}},
};

const AppStressScene *app_stress_cases(int *count) {
  *count = (int)(sizeof cases / sizeof *cases);
  return cases;
}
