// SPDX-License-Identifier: GPL-3.0-or-later
// app/scene/*: scene files, from YAML and JSON to the definition and back; numbers; overrides; memory.
#include "suite.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>

#include "app/scene/overlap.h"
#include "app/scene/read.h"
#include "app/scene/write.h"
#include "base/files/record.h"
#include "base/memory.h"
#include "scene_text.h"

static const char *const full_yaml = TETLAP_SOURCE_DIR "/tests/data/scene/full.yaml";
static const char *const full_json = TETLAP_SOURCE_DIR "/tests/data/scene/full.json";

// The scene as the resolved JSON; owned by the caller (free).
static char *resolved(const FemSceneDef *scene) {
  Record *record = record_new();
  ck_assert_ok(app_scene_write_resolved(scene, record));
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(record_print(record, stream));
  fclose(stream);
  record_destroy(record);
  // The scene itself: from the inner brace to its end.
  char *begin = strchr(text + 1, '{');
  memmove(text, begin, strlen(begin) + 1);
  *strrchr(text, '}') = 0;
  return text;
}

static void ck_vector(const double *v, double x, double y, double z) {
  ck_assert_double_eq(v[0], x);
  ck_assert_double_eq(v[1], y);
  ck_assert_double_eq(v[2], z);
}

// What full.yaml says, key by key.

static void check_lower(const FemBodyDef *body) {
  ck_assert_str_eq(body->name, "lower");
  ck_assert_str_eq(body->mesh_path, "lower.msh");
  ck_vector(body->placement.scale, 2, 2, 2);
  ck_vector(body->placement.axis, 0, 0, 3);
  ck_assert_double_eq(body->placement.angle_degrees, 30);
  ck_vector(body->placement.translate, 1, 2, 3);
  ck_assert_int_eq(body->material.law, FEM_MATERIAL_STVK);
  ck_assert_double_eq(body->material.young, 1e6);
  ck_assert_double_eq(body->material.poisson, 0.25);
  ck_assert_double_eq(body->material.density, 1200);
  ck_assert_double_eq(body->material.damping, 1e-3);
  ck_assert_double_eq(body->material.yield_stress, 2e4);
  ck_assert_double_eq(body->material.hardening, 300);
  ck_vector(body->velocity, 0, 0, -1);
  ck_vector(body->spin, 0.1, 0.2, 0.3);
  ck_assert_int_eq(body->element, FEM_ELEMENT_NODAL);
}

static void check_constraints(const FemBodyDef *body) {
  ck_assert_int_eq(body->fixed_count, 2);
  ck_assert_int_eq(body->fixed[0].select.kind, FEM_SELECT_BOX);
  ck_vector(body->fixed[0].select.box_min, -1, -1, 0);
  ck_vector(body->fixed[0].select.box_max, 1, 1, 0);
  ck_assert(body->fixed[0].components[0] && body->fixed[0].components[1] && body->fixed[0].components[2]);
  ck_assert(isinf(body->fixed[0].until));
  ck_assert_int_eq(body->fixed[1].select.kind, FEM_SELECT_HALFSPACE);
  ck_vector(body->fixed[1].select.point, 0, 0, 1);
  ck_vector(body->fixed[1].select.normal, 0, 0, -2);
  ck_assert(body->fixed[1].components[0] && !body->fixed[1].components[1] && body->fixed[1].components[2]);
  ck_assert_double_eq(body->fixed[0].release, 0);
  ck_assert_double_eq(body->fixed[1].release, 1.5);
  ck_assert_int_eq(body->driven_count, 6);
  const FemConstraintDef *driven = body->driven;
  ck_assert_int_eq(driven[0].select.kind, FEM_SELECT_GROUP);
  ck_assert_str_eq(driven[0].select.group, "top");
  ck_vector(driven[0].velocity, 0, 0, -0.1);
  ck_assert_double_eq(driven[0].until, 0.5);
  ck_assert_int_eq(driven[1].select.kind, FEM_SELECT_ALL);
  ck_assert(!driven[1].components[0] && driven[1].components[1] && !driven[1].components[2]);
  ck_vector(driven[1].amplitude, 0, 0.1, 0);
  ck_assert_double_eq(driven[1].frequency, 3);
  ck_assert(isinf(driven[1].until));
  ck_assert_double_eq(driven[2].spin, 2);
  ck_vector(driven[2].axis, 1, 0, 0);
  ck_vector(driven[2].centre, 0, 0, 0.5);
  ck_assert_int_eq(driven[3].table_count, 3);
  ck_assert_double_eq(driven[3].table[4], 0.5);
  ck_assert_double_eq(driven[3].table[7], 0.1);
  ck_assert_double_eq(driven[3].table[11], 0.2);
  ck_assert_str_eq(driven[4].formula[0]->text, "0.1*sin(2*pi*t)");
  ck_assert_double_eq(expression_eval(driven[4].formula[1], 3).value, 2);
  ck_assert_double_eq(expression_eval(driven[4].formula[2], 3).value, 9);
  ck_assert_double_eq(driven[4].release, 1.75);
  ck_assert(driven[3].turns && driven[3].moves_first && !driven[4].moves_first && !driven[2].turns);
  ck_vector(driven[3].axis, 0, 0, 1);
  ck_vector(driven[3].centre, 1, 0, 0);
  ck_assert_int_eq(driven[3].angle_count, 2);
  ck_assert_double_eq(driven[3].angles[3], 1.5);
  ck_assert_double_eq(expression_eval(driven[4].angle, 3).value, 1.5);
  ck_assert(driven[5].is_external && !driven[4].is_external);
}

static void check_loads(const FemBodyDef *body) {
  const FemLoadDef *loads = body->loads;
  ck_assert_int_eq(body->load_count, 7);
  ck_assert_int_eq(loads[0].kind, FEM_LOAD_PRESSURE);
  ck_assert_str_eq(loads[0].select.group, "top");
  ck_assert_double_eq(loads[0].pressure, 5e4);
  ck_assert(loads[0].is_dead && !loads[1].is_dead);
  ck_assert_int_eq(loads[0].table_count, 3);
  ck_assert_double_eq(loads[0].table[5], 0.25);
  ck_assert_int_eq(loads[2].kind, FEM_LOAD_TRACTION);
  ck_vector(loads[2].vector, 1, 0, 2);
  ck_assert_str_eq(loads[2].factor->text, "smooth(t)");
  ck_assert_int_eq(loads[3].kind, FEM_LOAD_BODY_FORCE);
  ck_assert_ptr_null(loads[3].factor);
  ck_vector(loads[3].vector, 0, 0, -3);
  ck_assert_int_eq(loads[4].kind, FEM_LOAD_FORCE);
  ck_assert_double_eq(expression_eval(loads[4].factor, 9).value, 0.5);
  ck_assert_int_eq(loads[5].kind, FEM_LOAD_TORQUE);
  ck_vector(loads[5].vector, 0, 7, 0);
  ck_assert_int_eq(loads[6].kind, FEM_LOAD_EXTERNAL);
}

static void check_parts(const FemBodyDef *body) {
  ck_assert_int_eq(body->part_count, 4);
  const FemPartDef *parts = body->parts;
  const FemSelectKind kinds[] = {FEM_SELECT_GROUP, FEM_SELECT_BOX, FEM_SELECT_HALFSPACE, FEM_SELECT_RADIUS};
  for (int i = 0; i < 4; i++) {
    ck_assert_int_eq(parts[i].select.kind, kinds[i]);
    ck_assert_double_eq(parts[i].material.young, (7 + i) * 1e5);
    ck_assert_int_gt(parts[i].select.place.line, 0);
  }
  ck_assert_str_eq(parts[0].select.group, "core");
  ck_assert_int_eq(parts[0].material.law, FEM_MATERIAL_STVK);
  ck_assert_double_eq(parts[0].material.yield_stress, 3e4);
  ck_vector(parts[1].select.box_max, 1, 1, 2);
  ck_vector(parts[2].select.normal, 0, 0, -1);
  ck_assert_double_eq(parts[3].select.radius_max, 0.5);
  ck_assert_double_eq(parts[3].material.mooney, 0.3);
  ck_assert_double_lt(parts[3].material.damping, 0);
}

static void check_upper(const FemBodyDef *body) {
  ck_assert_str_eq(body->name, "upper-2");
  ck_assert_ptr_null(body->mesh_path);
  ck_vector(body->box_size, 0.1, 0.2, 0.3);
  for (int c = 0; c < 3; c++) ck_assert_int_eq(body->box_cells[c], c + 1);
  ck_vector(body->placement.scale, 1, -1, 2);
  ck_assert_int_eq(body->material.law, FEM_MATERIAL_NEO_HOOKEAN); // the default
  ck_vector(body->material.exponents, 1.5, -2, 3);
  ck_vector(body->material.shares, 3, 1, 0);
  ck_assert_double_eq(body->material.mooney, 0.4);
  ck_assert_double_eq(body->material.viscosity, 12);
  ck_assert_double_eq(body->material.bulk_viscosity, 5);
  ck_assert_double_eq(body->material.fibre_stiffness, 7e5);
  ck_vector(body->material.fibre_direction, 0, 1, 1);
  ck_assert(body->material.fibres_buckle);
  ck_assert_double_lt(body->material.damping, 0); // the scene's
  check_parts(body);
}

static void check_obstacles(const FemSceneDef *scene) {
  ck_assert_int_eq(scene->obstacle_count, 7);
  const FemObstacleDef *ground = &scene->obstacles[0], *tool = ground + 1, *block = ground + 2;
  ck_assert_int_eq(ground->kind, FEM_OBSTACLE_HALFSPACE);
  ck_assert(tool->kind == FEM_OBSTACLE_MESH && block->kind == FEM_OBSTACLE_MESH);
  ck_vector(ground->point, 0, 0, -1);
  ck_vector(ground->normal, 0, 0, 1);
  ck_vector(ground->motion.velocity, 0, 0, 0.5);
  ck_assert_str_eq(tool->mesh_path, "tool.stl");
  ck_assert_double_eq(tool->mesh_options.size, 0.05);
  ck_assert(tool->mesh_options.is_curved);
  ck_vector(tool->motion.velocity, 1, 0, 0);
  ck_assert_double_eq(tool->motion.spin, -1);
  ck_assert_double_eq(tool->motion.until, 4);
  ck_assert(tool->motion.components[0] && tool->motion.components[1] && tool->motion.components[2]);
  ck_assert_int_eq(block->box_cells[2], 2);
  ck_assert_str_eq(scene->obstacles[3].mesh_path, "wall.msh");
  ck_assert_int_eq(scene->obstacles[4].kind, FEM_OBSTACLE_BALL);
  ck_vector(scene->obstacles[4].point, 1, 2, 3);
  ck_assert_double_eq(scene->obstacles[4].radius, 0.5);
  ck_vector(block->motion.velocity, 0, 0, 0);
  const FemObstacleDef *step = &scene->obstacles[5], *rod = step + 1;
  ck_assert(step->kind == FEM_OBSTACLE_BOX && rod->kind == FEM_OBSTACLE_CYLINDER);
  ck_vector(step->point, 1, 0, -1);
  ck_vector(step->size, 2, 3, 4);
  ck_vector(step->turn.axis, 1, 0, 0);
  ck_assert_double_eq(step->turn.angle_degrees, 15);
  ck_vector(rod->axis, 1, 1, 0);
  ck_assert_double_eq(rod->radius, 0.25);
  ck_assert_double_eq(rod->length, 3);
}

static void check_settings(const FemSceneDef *scene) {
  ck_assert_str_eq(scene->title, "Every key: «ü»");
  ck_assert_str_eq(scene->start, "../press");
  ck_assert(scene->starts_anyhow);
  ck_assert(scene->has_gravity);
  ck_vector(scene->gravity, 0, 0, -9.81);
  ck_assert_double_eq(scene->stiffness_damping, 2e-3);
  ck_assert_double_eq(scene->end, 2);
  ck_assert_double_eq(scene->tolerance, 1e-5);
  ck_assert_double_eq(scene->velocity_tolerance, 0.5);
  ck_assert_double_eq(scene->max_step, 0.01);
  ck_assert_double_eq(scene->initial_step, 1e-6);
  ck_assert_double_eq(scene->min_step, 1e-9);
  ck_assert_int_eq(scene->max_order, 1);
  ck_assert(scene->contact.is_on);
  ck_assert_double_eq(scene->contact.stiffness, 3e6);
  ck_assert_int_eq(scene->contact.potential, CONTACT_POTENTIAL_FIELD);
  ck_assert_str_eq(scene->contact.overlap, "exact");
  ck_assert_double_eq(scene->contact.margin, 0.02);
  ck_assert_int_eq(scene->contact.smooth, 2);
  ck_assert_double_eq(scene->contact.crease, 25);
  ck_assert_double_eq(scene->contact.friction.coefficient, 0.3);
  ck_assert_double_eq(scene->contact.friction.at_rest, 0.5);
  ck_assert_double_eq(scene->contact.friction.length, 1e-6);
  ck_assert_double_eq(scene->contact.viscosity, 11);
  ck_assert_int_eq(scene->contact.law.law.kind, CONTACT_LAW_POWER);
  ck_assert_double_eq(scene->contact.law.law.exponent, 1.5);
  ck_assert_double_eq(scene->contact.law.law.pressure, 2e6);
  ck_assert_double_eq(scene->contact.law.law.depth, 1e-5);
  ck_assert_int_eq(scene->contact.pair_count, 5);
  ck_assert_int_eq(scene->contact.pairs[0].law.law.kind, CONTACT_LAW_LINEAR);
  ck_assert_int_eq(scene->contact.pairs[2].law.law.kind, CONTACT_LAW_TABLE);
  ck_assert_int_eq(scene->contact.pairs[2].law.law.table_count, 3);
  ck_assert_double_eq(scene->contact.pairs[2].law.law.table[5], 8);
  ck_assert_int_eq(scene->contact.pairs[3].law.law.kind, CONTACT_LAW_EXPONENTIAL);
  ck_assert_double_eq(scene->contact.pairs[3].law.law.pressure, 7);
  ck_assert_double_eq(scene->contact.pairs[3].law.law.depth, 3e-6);
  ck_assert_int_eq(scene->contact.pairs[4].law.law.kind, CONTACT_LAW_FORMULA);
  ck_assert_double_eq(expression_eval(scene->contact.pairs[4].law.law.formula, 2).value, 2e9);
  ck_assert_str_eq(scene->contact.pairs[0].names[0], "lower");
  ck_assert_str_eq(scene->contact.pairs[0].names[1], "ground");
  ck_assert_double_eq(scene->contact.pairs[0].stiffness, 5e6);
  ck_assert(isnan(scene->contact.pairs[0].friction.coefficient));
  ck_assert_str_eq(scene->contact.pairs[1].names[1], "upper-2");
  ck_assert_double_eq(scene->contact.pairs[1].stiffness, 0);
  ck_assert_double_eq(scene->contact.pairs[1].friction.coefficient, 0.1);
  ck_assert_double_eq(scene->contact.pairs[1].friction.at_rest, 0.2);
  ck_assert_double_eq(scene->contact.pairs[1].friction.length, 2e-6);
  ck_assert_int_eq(scene->bodies[1].probe_count, 4);
  ck_assert_str_eq(scene->bodies[1].probes[0].name, "sole");
  ck_assert_str_eq(scene->bodies[1].probes[0].select.group, "glue");
  ck_assert_int_eq(scene->bodies[1].probes[1].select.kind, FEM_SELECT_ALL);
  const FemSelectDef *hole = &scene->bodies[1].probes[2].select, *lid = &scene->bodies[1].probes[3].select;
  ck_assert_int_eq(hole->kind, FEM_SELECT_RADIUS);
  ck_vector(hole->point, 1, 2, 3);
  ck_vector(hole->normal, 0, 0, 2);
  ck_assert_double_eq(hole->radius_min, 0.1);
  ck_assert_double_eq(hole->radius_max, 0.2);
  ck_assert_int_eq(lid->kind, FEM_SELECT_NORMAL);
  ck_vector(lid->normal, 0, 1, 0);
  ck_assert_double_eq(lid->degrees, 20);
  ck_assert_int_eq(scene->bodies[1].line_count, 1);
  ck_assert_str_eq(scene->bodies[1].lines[0].name, "seam");
  ck_vector(scene->bodies[1].lines[0].from, 0, 1, 2);
  ck_vector(scene->bodies[1].lines[0].to, 3, 4, 5);
  ck_assert_int_eq(scene->bodies[1].lines[0].points, 7);
  ck_assert_int_eq(scene->bodies[1].inner_count, 2);
  ck_assert_str_eq(scene->bodies[1].inner[0].select.group, "glue");
  ck_assert_int_eq(scene->bodies[1].inner[1].select.kind, FEM_SELECT_BOX);
  ck_assert(scene->contact.rest_is_on);
  ck_assert_double_eq(scene->contact.rest_speed, 1e-3);
  ck_assert_double_eq(scene->contact.rest_acceleration, 0.02);
  ck_assert_double_eq(scene->contact.rest_time, 0.25);
  ck_assert_int_eq(scene->solver, FEM_SOLVER_PCG);
  ck_assert_double_eq(scene->solver_tolerance, 1e-6);
  ck_assert_int_eq(scene->threads, 3);
  ck_assert_int_eq(scene->frames, 7);
  ck_assert(!scene->write_vtu && scene->history == FEM_HISTORY_NONE);
}

static void check_full(const FemSceneDef *scene) {
  ck_assert_int_eq(scene->body_count, 2);
  check_lower(&scene->bodies[0]);
  check_constraints(&scene->bodies[0]);
  check_loads(&scene->bodies[0]);
  check_upper(&scene->bodies[1]);
  check_obstacles(scene);
  check_settings(scene);
}

START_TEST(a_scene_with_every_key_is_read) {
  FemSceneDef scene;
  ck_assert_ok(app_scene_read(full_yaml, NULL, 0, &scene));
  check_full(&scene);
  ck_assert_str_eq(scene.path, full_yaml);
  ck_assert_int_eq(scene.bodies[1].place.line, 31);
  ck_assert_int_eq(scene.bodies[0].driven[1].select.place.line, 18);
  ck_assert_int_eq(scene.bodies[0].driven[1].select.place.column, 9);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(json_means_the_same) {
  FemSceneDef scene;
  ck_assert_ok(app_scene_read(full_json, NULL, 0, &scene));
  check_full(&scene);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(absent_keys_take_their_defaults) {
  const char *text = "time: {end: 1}\n"
                     "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0, density: 1}}]\n";
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
  ck_assert(!scene.has_gravity && !scene.contact.is_on);
  ck_assert_double_eq(scene.tolerance, 1e-4);
  ck_assert_double_eq(scene.max_step, 0);
  ck_assert_int_eq(scene.max_order, 2);
  ck_assert_int_eq(scene.solver, FEM_SOLVER_AUTO);
  ck_assert_int_eq(scene.frames, 50);
  ck_assert(scene.write_vtu && scene.history == FEM_HISTORY_FRAMES);
  ck_vector(scene.bodies[0].placement.scale, 1, 1, 1);
  ck_assert_double_eq(scene.bodies[0].placement.angle_degrees, 0);
  ck_assert_double_eq(scene.bodies[0].material.damping, -1);
  ck_assert_ptr_null(scene.title);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(an_empty_contact_section_turns_contact_on) {
  const char *text = "time: {end: 1}\ncontact: {}\n"
                     "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0, density: 1}}]\n";
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
  ck_assert(scene.contact.is_on);
  ck_assert_double_eq(scene.contact.stiffness, 0);
  ck_assert_int_eq(scene.contact.potential, CONTACT_POTENTIAL_FIELD);
  ck_assert_str_eq(scene.contact.overlap, "clip");
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_resolved_scene_is_the_same_scene) {
  FemSceneDef scene, again;
  ck_assert_ok(app_scene_read(full_yaml, NULL, 0, &scene));
  char *text = resolved(&scene);
  ck_assert_ok(scene_text_read("resolved.json", text, strlen(text), &again));
  check_full(&again);
  char *text_again = resolved(&again);
  ck_assert_str_eq(text, text_again);
  free(text), free(text_again);
  fem_scene_destroy(&scene), fem_scene_destroy(&again);
}
END_TEST

START_TEST(a_resolved_scene_names_what_was_left_out) {
  FemSceneDef scene;
  ck_assert_ok(app_scene_read(full_yaml, NULL, 0, &scene));
  char *text = resolved(&scene);
  ck_assert_ptr_nonnull(strstr(text, "\"law\": \"neo_hookean\""));
  ck_assert_ptr_nonnull(strstr(text, "\"components\""));
  ck_assert_ptr_nonnull(strstr(text, "\"damping\": 0.001"));
  ck_assert_ptr_null(strstr(text, "\"damping\": -")); // absent: the scene's
  free(text);
  fem_scene_destroy(&scene);
}
END_TEST

static void check_written_back(const char *path) {
  FemSceneDef scene, again;
  ck_assert_ok(app_scene_read(path, NULL, 0, &scene));
  ck_assert_ptr_nonnull(scene.title);
  char *text = resolved(&scene);
  ck_assert_ok(scene_text_read(path, text, strlen(text), &again));
  char *text_again = resolved(&again);
  ck_assert_str_eq(text, text_again);
  free(text), free(text_again);
  fem_scene_destroy(&scene), fem_scene_destroy(&again);
}

START_TEST(examples_are_read_and_written_back) {
  glob_t examples;
  ck_assert_int_eq(glob(TETLAP_SOURCE_DIR "/examples/*.yaml", 0, NULL, &examples), 0);
  ck_assert_uint_gt(examples.gl_pathc, 20);
  for (size_t e = 0; e < examples.gl_pathc; e++) check_written_back(examples.gl_pathv[e]);
  globfree(&examples);
}
END_TEST

#define MATERIAL "material: {young: 1, poisson: 0, density: 1}"
#define BODY "bodies: [{name: a, mesh: a.msh, " MATERIAL "}]\n"
#define BODY_WITH(more) "bodies:\n  - name: a\n    mesh: a.msh\n    " MATERIAL "\n    " more "\n"

START_TEST(numbers_are_read_as_people_write_them) {
  static const struct {
    const char *text;
    double value;
  } cases[] = {{"1e6", 1e6},
               {"1E+6", 1e6},
               {"1.e3", 1e3},
               {".5", 0.5},
               {"+0.25", 0.25},
               {"007", 7},
               {"1e-300", 1e-300},
               {"0.1", 0.1},
               {"3", 3},
               {"2.50", 2.5},
               {"12345678901234567890", 12345678901234567890.0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char text[512];
    snprintf(text, sizeof text, "time: {end: %s}\n" BODY, cases[i].text);
    FemSceneDef scene;
    ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
    ck_assert_double_eq(scene.end, cases[i].value);
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(infinity_is_allowed_where_the_range_has_it) {
  const char *text = "time: {end: 1}\n" BODY_WITH("driven: [{all: true, velocity: [0, 0, 1], until: .inf}]");
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
  ck_assert(isinf(scene.bodies[0].driven[0].until));
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_table_may_be_written_flat) {
  const char *text = "time: {end: 1}\n" BODY_WITH("driven: [{all: true, table: [0, 0, 0, 0, 1, 0, 0, 5]}]");
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
  ck_assert_int_eq(scene.bodies[0].driven[0].table_count, 2);
  ck_assert_double_eq(scene.bodies[0].driven[0].table[7], 5);
  fem_scene_destroy(&scene);
}
END_TEST

// Memory.

START_TEST(every_failed_allocation_is_reported) {
  FemSceneDef scene;
  const char *overrides[] = {"solver.threads=2", "bodies.lower.velocity=[0, 0, 1]"};
  Status status = STATUS_MEMORY;
  long k = 1;
  for (; status == STATUS_MEMORY; k++) {
    memory_fail_at(k);
    status = app_scene_read(full_yaml, overrides, 2, &scene);
    memory_fail_at(0);
    if (status == STATUS_MEMORY) ck_assert_ptr_null(scene.path);
  }
  ck_assert_ok(status);
  ck_assert_int_gt(k, 500); // it did strike: once for every node at least
  for (status = STATUS_MEMORY, k = 1; status == STATUS_MEMORY; k++) {
    Record *record = record_new();
    memory_fail_at(k);
    status = app_scene_write_resolved(&scene, record);
    memory_fail_at(0);
    record_destroy(record);
  }
  ck_assert_ok(status);
  ck_assert_int_gt(k, 10);
  fem_scene_destroy(&scene);
}
END_TEST

// Overrides.

START_TEST(overrides_replace_values) {
  static const char *const overrides[] = {"contact.stiffness=1e5",
                                          "bodies.lower.material.young=7",
                                          "bodies[1].velocity=[1, 2, 3]",
                                          "obstacles.tool.mesh.size=0.25",
                                          "bodies.upper-2.place=null",
                                          "bodies[1].fixed=[{all: true}]",
                                          "output={frames: 9}",
                                          "title=it's: \"new\"",
                                          "bodies[0].driven[0].until=.inf",
                                          "time.min_step=null"};
  FemSceneDef scene;
  ck_assert_int_eq(app_scene_read(full_yaml, overrides, 10, &scene), STATUS_USAGE); // title is no YAML
  static const char *const good[] = {"contact.stiffness=1e5",
                                     "bodies.lower.material.young=7",
                                     "bodies[1].velocity=[1, 2, 3]",
                                     "obstacles.tool.mesh.size=0.25",
                                     "bodies.upper-2.place=null",
                                     "bodies[1].fixed=[{all: true}]",
                                     "output={frames: 9}",
                                     "title=new = better",
                                     "bodies[0].driven[0].until=.inf",
                                     "time.min_step=null"};
  ck_assert_ok(app_scene_read(full_yaml, good, 10, &scene));
  ck_assert_double_eq(scene.contact.stiffness, 1e5);
  ck_assert_double_eq(scene.bodies[0].material.young, 7);
  ck_vector(scene.bodies[1].velocity, 1, 2, 3);
  ck_assert_double_eq(scene.obstacles[1].mesh_options.size, 0.25);
  ck_vector(scene.bodies[1].placement.scale, 1, 1, 1);
  ck_assert_int_eq(scene.bodies[1].fixed_count, 1);
  ck_assert_int_eq(scene.frames, 9);
  ck_assert(scene.write_vtu);
  ck_assert_str_eq(scene.title, "new = better");
  ck_assert(isinf(scene.bodies[0].driven[0].until));
  ck_assert_double_eq(scene.min_step, 0);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_history_is_of_frames_or_steps_or_none) {
  const char *const words[] = {"output.history=steps", "output.history=true", "output.history=frames",
                               "output.history=false", "output.history=none"};
  const FemHistoryRows rows[] = {FEM_HISTORY_STEPS, FEM_HISTORY_FRAMES, FEM_HISTORY_FRAMES, FEM_HISTORY_NONE,
                                 FEM_HISTORY_NONE};
  for (int k = 0; k < 5; k++) {
    FemSceneDef scene;
    ck_assert_ok(app_scene_read(full_yaml, &words[k], 1, &scene));
    ck_assert_int_eq(scene.history, rows[k]);
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(a_byte_order_mark_is_read_over) {
  const char *text = "\xef\xbb\xbf"
                     "time: {end: 1}\n"
                     "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0, density: 1}}]\n";
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, strlen(text), &scene));
  fem_scene_destroy(&scene);
  Record *record;
  ck_assert_ok(record_parse(&record, "\xef\xbb\xbf{\"a\": 1}", 11, "a.json"));
  record_destroy(record);
}
END_TEST

START_TEST(another_overlap_model_does_not_turn_contact_on) {
  static const char *const on[] = {"contact.potential=nodal"};
  const char *path = TETLAP_SOURCE_DIR "/examples/04_cantilever.yaml";
  FemSceneDef scene;
  ck_assert_int_eq(app_scene_overlap_read(path, NULL, 0, "clip", &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "has no section 'contact'"));
  ck_assert_ok(app_scene_overlap_read(path, on, 1, "exact", &scene));
  ck_assert_str_eq(scene.contact.overlap, "exact");
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(an_override_turns_contact_off_and_on) {
  static const char *const off[] = {"contact=null"};
  static const char *const on[] = {"contact=null", "contact.potential=nodal"};
  FemSceneDef scene;
  ck_assert_ok(app_scene_read(full_yaml, off, 1, &scene));
  ck_assert(!scene.contact.is_on);
  fem_scene_destroy(&scene);
  ck_assert_ok(app_scene_read(full_yaml, on, 2, &scene));
  ck_assert(scene.contact.is_on);
  ck_assert_int_eq(scene.contact.potential, CONTACT_POTENTIAL_NODAL);
  ck_assert_str_eq(scene.contact.overlap, "clip");
  fem_scene_destroy(&scene);
}
END_TEST

// As a formula alone it says which kind it is, too.
START_TEST(a_law_may_be_a_formula_alone) {
  FemSceneDef scene;
  const char *const overrides[] = {"contact.law=2e9*d + 4e13*d^2"};
  ck_assert_ok(app_scene_read(full_yaml, overrides, 1, &scene));
  ck_assert_int_eq(scene.contact.law.law.kind, CONTACT_LAW_FORMULA);
  ck_assert_double_eq(expression_eval(scene.contact.law.law.formula, 1).value, 2e9 + 4e13);
  fem_scene_destroy(&scene);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("scene");
  tcase_add_test(cases, a_law_may_be_a_formula_alone);
  tcase_add_test(cases, a_scene_with_every_key_is_read);
  tcase_add_test(cases, json_means_the_same);
  tcase_add_test(cases, absent_keys_take_their_defaults);
  tcase_add_test(cases, a_byte_order_mark_is_read_over);
  tcase_add_test(cases, another_overlap_model_does_not_turn_contact_on);
  tcase_add_test(cases, an_empty_contact_section_turns_contact_on);
  tcase_add_test(cases, a_resolved_scene_is_the_same_scene);
  tcase_add_test(cases, a_resolved_scene_names_what_was_left_out);
  tcase_add_test(cases, examples_are_read_and_written_back);
  tcase_add_test(cases, numbers_are_read_as_people_write_them);
  tcase_add_test(cases, infinity_is_allowed_where_the_range_has_it);
  tcase_add_test(cases, a_table_may_be_written_flat);
  tcase_add_test(cases, every_failed_allocation_is_reported);
  tcase_add_test(cases, overrides_replace_values);
  tcase_add_test(cases, a_history_is_of_frames_or_steps_or_none);
  tcase_add_test(cases, an_override_turns_contact_off_and_on);
  return suite_run("scene", cases, 60);
}
