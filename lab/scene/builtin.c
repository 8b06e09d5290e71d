// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/builtin.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/scene/read.h"

enum { TEXT_SIZE = 2048 };

Status lab_scene_builtin_beam(int nodes, double slenderness, FemSceneDef *scene) {
  int side = (int)fmax(2, round(cbrt(nodes / slenderness)));       // vertices across
  int length = (int)fmax(2, round(nodes / ((double)side * side))); // vertices along
  double edge = 0.1 / (side - 1);
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A clamped beam falls under its weight\n"
           "bodies:\n"
           "  - name: beam\n"
           "    mesh: {box: {size: [%.17g, 0.1, 0.1], cells: [%d, %d, %d]}}\n"
           "    material: {law: neo_hookean, young: 1e6, poisson: 0.4, density: 1000, damping: 1e-3}\n"
           "    fixed: [{box: {min: [-1e-9, -1, -1], max: [1e-9, 1, 1]}}]\n"
           "effects: {gravity: [0, 0, -9.81]}\n"
           "time: {end: 1}\n"
           "output: {frames: 1, vtu: false}\n",
           edge * (length - 1), length - 1, side - 1, side - 1);
  return app_scene_read_text("(beam)", text, strlen(text), scene);
}

Status lab_scene_builtin_drop(double stiffness, double tolerance, FemSceneDef *scene) {
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A block falls onto the ground\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [0.2, 0.2, 0.2], cells: [4, 4, 4]}}\n"
           "    place: {translate: [0, 0, 0.05]}\n"
           "    material: {law: neo_hookean, young: 1e6, poisson: 0.4, density: 1000}\n"
           "obstacles:\n"
           "  - {name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}\n"
           "effects: {gravity: [0, 0, -9.81]}\n"
           "contact: {stiffness: %.17g}\n"
           "time: {end: 0.3, tolerance: %.17g}\n"
           "output: {frames: 30, vtu: false}\n",
           stiffness, tolerance);
  return app_scene_read_text("(drop)", text, strlen(text), scene);
}

Status lab_scene_builtin_blocks(int nodes, FemSceneDef *scene) {
  // (n + 1)³ + (1.25 n + 1)³ vertices
  int lower = (int)fmax(2, round(cbrt(nodes / 2.95) - 0.9)), upper = (int)round(1.25 * lower);
  double edge = 0.1 / lower;
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A block is pressed into another\n"
           "bodies:\n"
           "  - name: lower\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {translate: [-0.05, -0.05, 0]}\n"
           "    material: {young: 1e5, poisson: 0.4, density: 1000, damping: 1e-3}\n"
           "    fixed: [{box: {min: [-1, -1, -1e-9], max: [1, 1, 1e-9]}}]\n"
           "  - name: upper\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {rotate: {axis: [0, 0, 1], degrees: 20}, translate: [-0.03, -0.07, %.17g]}\n"
           "    material: {young: 2e5, poisson: 0.3, density: 1000, damping: 1e-3}\n"
           "effects: {gravity: [0, 0, -9.81]}\n"
           "contact: {stiffness: 1e6}\n"
           "time: {end: 0.1}\n"
           "output: {frames: 1, vtu: false}\n",
           lower, upper, 0.1 - 0.02 * edge);
  return app_scene_read_text("(blocks)", text, strlen(text), scene);
}

// Blocks of builtin_blocks, the upper one held by nothing but contact in statics, or pushed down and aside.
static Status read_blocks(int nodes, const char *poisson, const char *upper, const char *rest,
                          FemSceneDef *scene) {
  int lower = (int)fmax(2, round(cbrt(nodes / 2.95) - 0.9)), above = (int)round(1.25 * lower);
  double edge = 0.1 / lower;
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A block is pressed into another\n"
           "bodies:\n"
           "  - name: lower\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {translate: [-0.05, -0.05, 0]}\n"
           "    material: {young: 1e5, poisson: %s, density: 1000, damping: 1e-3}\n"
           "    fixed: [{box: {min: [-1, -1, -1e-9], max: [1, 1, 1e-9]}}]\n"
           "  - name: upper\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {rotate: {axis: [0, 0, 1], degrees: 20}, translate: [-0.03, -0.07, %.17g]}\n"
           "    material: {young: 2e5, poisson: %s, density: 1000, damping: 1e-3}\n"
           "%s%s"
           "output: {frames: 1, vtu: false}\n",
           lower, poisson, above, 0.1 - 0.02 * edge, poisson, upper, rest);
  return app_scene_read_text("(blocks)", text, strlen(text), scene);
}

static Status read_pressed(int nodes, FemSceneDef *scene) {
  return read_blocks(nodes, "0.45", "    driven: [{group: z_max, velocity: [0.05, 0, -0.1]}]\n",
                     "contact: {friction: 0.5}\n"
                     "time: {end: 0.1}\n",
                     scene);
}

static Status read_floating(int nodes, FemSceneDef *scene) {
  return read_blocks(nodes, "0.45", "",
                     "effects: {gravity: [0, 0, -9.81]}\n"
                     "contact: {friction: 0.5}\n"
                     "time: {end: 1, static: true}\n",
                     scene);
}

// A cube of n cells along an edge has (n + 1)³ vertices.
static int cells_of(int nodes) {
  return (int)fmax(2, round(cbrt(nodes) - 1));
}

static Status read_ball(int nodes, FemSceneDef *scene) {
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A rigid ball is pressed into a block and turns\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {translate: [-0.05, -0.05, -0.1]}\n"
           "    material: {young: 1e5, poisson: 0.3, density: 1000, damping: 1e-3}\n"
           "    fixed: [{group: z_min}]\n"
           "obstacles:\n"
           "  - name: ball\n"
           "    sphere: {centre: [0, 0, 0.0499], radius: 0.05}\n"
           "    motion: {velocity: [0, 0, -0.1], spin: 6, axis: [0, 1, 0], centre: [0, 0, 0.0499]}\n"
           "contact: {friction: 0.6}\n"
           "time: {end: 0.1}\n"
           "output: {frames: 1, vtu: false}\n",
           cells_of(nodes));
  return app_scene_read_text("(ball)", text, strlen(text), scene);
}

static Status read_press(int nodes, FemSceneDef *scene) {
  int cells = cells_of(nodes);
  char text[TEXT_SIZE];
  snprintf(text, sizeof text,
           "title: A driven plate presses a block\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: %d}}\n"
           "    place: {translate: [-0.05, -0.05, 0]}\n"
           "    material: {young: 1e6, poisson: 0.3, density: 1000, damping: 2e-3}\n"
           "    fixed: [{group: z_min}]\n"
           "obstacles:\n"
           "  - name: plate\n"
           "    mesh: {box: {size: [0.16, 0.16, 0.02], cells: [%d, %d, 2]}}\n"
           "    place: {translate: [-0.08, -0.08, 0.09999]}\n"
           "    motion: {velocity: [0, 0, -0.026]}\n"
           "contact: {}\n"
           "time: {end: 0.8}\n"
           "output: {frames: 1, vtu: false}\n",
           cells, cells, cells);
  return app_scene_read_text("(press)", text, strlen(text), scene);
}

const LabSceneLarge lab_scene_builtin_large[LAB_SCENE_LARGE_COUNT] = {
    {"blocks", "two blocks in contact", lab_scene_builtin_blocks},
    {"pressed", "two blocks pressed with friction, nu 0.45", read_pressed},
    {"ball", "a rigid ball that turns in a block", read_ball},
    {"press", "a plate with a mesh presses a block", read_press},
    {"floating", "statics: two blocks, the upper held by contact and friction alone, nu 0.45", read_floating},
};
