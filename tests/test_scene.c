// SPDX-License-Identifier: GPL-3.0-or-later
// app/scene_*: scene files, from YAML and JSON to the definition and back; every way in which a file can be
// wrong, with the place and the words of the message; overrides; the manual and the schema.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/program.h"
#include "app/scene_manual.h"
#include "app/scene_read.h"
#include "app/scene_schema.h"
#include "app/scene_write.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/text.h"

static const char *const full_yaml = TETLAP_SOURCE_DIR "/tests/data/scene/full.yaml";
static const char *const full_json = TETLAP_SOURCE_DIR "/tests/data/scene/full.json";

static const char *const examples[] = {
    "01_drop",  "02_two_blocks",    "03_spheres",     "04_cantilever", "05_press",           "06_bunny_like",
    "20_loads", "21_release",       "22_rubber_beam", "23_fibres",     "24_pressure_vessel", "25_plastic_bar",
    "26_hertz", "27_quadratic_beam"};
enum { EXAMPLE_COUNT = sizeof examples / sizeof *examples };

// What is printed to the stream that `print` is given; owned by the caller (free).
static char *printed(Status (*print)(FILE *stream)) {
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(print(stream));
  fclose(stream);
  return text;
}

// The scene as the resolved JSON; owned by the caller (free).
static char *resolved(const FemSceneDef *scene) {
  Record *record = record_new();
  ck_assert_ok(app_scene_write_resolved(scene, record, "scene"));
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
  ck_assert_int_eq(body->driven_count, 5);
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
}

static void check_loads(const FemBodyDef *body) {
  const FemLoadDef *loads = body->loads;
  ck_assert_int_eq(body->load_count, 5);
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
  ck_assert_int_eq(rod->faces, 32);
}

static void check_settings(const FemSceneDef *scene) {
  ck_assert_str_eq(scene->title, "Every key: «ü»");
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
  ck_assert(scene->contact.is_on && !scene->contact.use_full_hessian);
  ck_assert_double_eq(scene->contact.stiffness, 3e6);
  ck_assert_int_eq(scene->contact.potential, CONTACT_POTENTIAL_NODAL);
  ck_assert_str_eq(scene->contact.overlap, "exact");
  ck_assert_double_eq(scene->contact.margin, 0.02);
  ck_assert_double_eq(scene->contact.friction, 0.3);
  ck_assert_double_eq(scene->contact.slip_speed, 1e-4);
  ck_assert_double_eq(scene->contact.viscosity, 11);
  ck_assert(scene->contact.rest_is_on);
  ck_assert_double_eq(scene->contact.rest_speed, 1e-3);
  ck_assert_double_eq(scene->contact.rest_acceleration, 0.02);
  ck_assert_double_eq(scene->contact.rest_time, 0.25);
  ck_assert_int_eq(scene->solver, FEM_SOLVER_PCG);
  ck_assert_double_eq(scene->solver_tolerance, 1e-6);
  ck_assert_int_eq(scene->threads, 3);
  ck_assert_int_eq(scene->frames, 7);
  ck_assert(!scene->write_vtu && !scene->write_history);
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
  ck_assert_int_eq(scene.bodies[1].place.line, 28);
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

// Whether a key of the table stands anywhere in a tree that the section describes.
static bool occurs(const SceneSection *section, const SceneNode *node, const SceneKey *wanted) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    const SceneNode *entry = app_scene_tree_find(node, key->name);
    if (!entry) continue;
    if (key == wanted) return true;
    if (key->type == SCENE_SECTION && occurs(key->section, entry, wanted)) return true;
    for (const SceneNode *item = key->type == SCENE_LIST ? entry->first : NULL; item; item = item->next)
      if (occurs(key->section, item, wanted)) return true;
  }
  return false;
}

static void check_all_occur(const SceneSection *section, const SceneNode *root) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    ck_assert_msg(occurs(&app_scene_keys_root, root, key), "full.yaml lacks the key '%s' (%s)", key->name,
                  section->help);
    if (key->section) check_all_occur(key->section, root);
  }
}

// A key that the full scene lacks would be tested by nothing.
START_TEST(the_full_scene_has_every_key_of_the_table) {
  SceneNode *root;
  ck_assert_ok(app_scene_tree_read(full_yaml, &root));
  check_all_occur(&app_scene_keys_root, root);
  app_scene_tree_destroy(root);
}
END_TEST

START_TEST(absent_keys_take_their_defaults) {
  const char *text = "time: {end: 1}\n"
                     "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0, density: 1}}]\n";
  FemSceneDef scene;
  ck_assert_ok(app_scene_read_text("s.yaml", text, strlen(text), &scene));
  ck_assert(!scene.has_gravity && !scene.contact.is_on);
  ck_assert_double_eq(scene.tolerance, 1e-4);
  ck_assert_double_eq(scene.max_step, 0);
  ck_assert_int_eq(scene.max_order, 2);
  ck_assert_int_eq(scene.solver, FEM_SOLVER_AUTO);
  ck_assert_int_eq(scene.frames, 50);
  ck_assert(scene.write_vtu && scene.write_history);
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
  ck_assert_ok(app_scene_read_text("s.yaml", text, strlen(text), &scene));
  ck_assert(scene.contact.is_on && scene.contact.use_full_hessian);
  ck_assert_double_eq(scene.contact.stiffness, 0);
  ck_assert_int_eq(scene.contact.potential, CONTACT_POTENTIAL_NODAL);
  ck_assert_str_eq(scene.contact.overlap, "geo");
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_resolved_scene_is_the_same_scene) {
  FemSceneDef scene, again;
  ck_assert_ok(app_scene_read(full_yaml, NULL, 0, &scene));
  char *text = resolved(&scene);
  ck_assert_ok(app_scene_read_text("resolved.json", text, strlen(text), &again));
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

START_TEST(examples_are_read_and_written_back) {
  char path[512];
  snprintf(path, sizeof path, "%s/examples/%s.yaml", TETLAP_SOURCE_DIR, examples[_i]);
  FemSceneDef scene, again;
  ck_assert_ok(app_scene_read(path, NULL, 0, &scene));
  ck_assert_ptr_nonnull(scene.title);
  char *text = resolved(&scene);
  ck_assert_ok(app_scene_read_text(path, text, strlen(text), &again));
  char *text_again = resolved(&again);
  ck_assert_str_eq(text, text_again);
  free(text), free(text_again);
  fem_scene_destroy(&scene), fem_scene_destroy(&again);
}
END_TEST

// Errors: a scene text and how the message begins (up to "…", after which it must go on so).
typedef struct Wrong {
  const char *text;
  const char *message;
} Wrong;

#define TIME "time: {end: 1}\n"
#define MATERIAL "material: {young: 1, poisson: 0, density: 1}"
#define BODY "bodies: [{name: a, mesh: a.msh, " MATERIAL "}]\n"
#define BODY_WITH(more) "bodies:\n  - name: a\n    mesh: a.msh\n    " MATERIAL "\n    " more "\n"

static const Wrong wrong[] = {
    // YAML itself.
    {"", "s.yaml:1:1: the scene is empty; it needs at least 'time' and 'bodies'"},
    {"# only a comment\n", "s.yaml:1:1: the scene is empty"},
    {"- a\n- b\n", "s.yaml:1:1: the scene: expected a mapping {key: value}, found a list of 2"},
    {"just words\n", "s.yaml:1:1: the scene: expected a mapping {key: value}, found the text 'just words'"},
    {"time:\n\tend: 1\n", "s.yaml:2:1: a tab; YAML is indented with spaces"},
    {"time: {end: 1\n", "s.yaml:2:1: not valid YAML: did not find expected ',' or '}'"},
    {"time: \"open\nmore", "s.yaml:2:5: not valid YAML"},
    {"time: &t {end: 1}\n", "s.yaml:1:7: the anchor '&t'"},
    {"time: *t\n", "s.yaml:1:7: the alias '*t'; aliases are not supported"},
    {"time: {end: !!float 1}\n", "s.yaml:1:13: the tag 'tag:yaml.org,2002:float'; tags are not supported"},
    {TIME BODY "---\ntime: {end: 2}\n", "s.yaml:3:1: a second document ('---'); one scene a file"},
    {"? [a, b]\n: c\n", "s.yaml:1:3: a key must be a word"},
    {TIME "time: {end: 2}\n", "s.yaml:2:1: duplicate key 'time'; it stands at line 1, column 1 already"},
    {"time: {end: 1, end: 2}\n", "s.yaml:1:16: duplicate key 'end'; it stands at line 1, column 8 already"},
    {"title: caf\xe9\n", "s.yaml:1:11: the byte 0xe9 is not UTF-8"},
    {"title: \"\xc3\xa9\xc3\xa9\" x\n", "s.yaml:1:13: not valid YAML"},
    {"title: a\x01\n", "s.yaml:1:9: control characters are not allowed"},
    {"title: \"a\\0b\"\n", "s.yaml:1:8: a text with a zero character in it"},
    {"a: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]\n",
     "s.yaml:1:35: nested more than 32 deep"},
    // Keys.
    {"tiem: {end: 1}\n", "s.yaml:1:1: unknown key 'tiem' in the scene; did you mean 'time'?"},
    {"time: {End: 1}\n", "s.yaml:1:8: unknown key 'End' in time; did you mean 'end'?"},
    {"time: {end: 1}\nkappa: 3\n",
     "s.yaml:2:1: unknown key 'kappa' in the scene; the keys here are title, time"},
    {"stiffness: 3\n",
     "s.yaml:1:1: unknown key 'stiffness' in the scene; there is contact.stiffness, and here"},
    {TIME "bodies:\n  - name: a\n    mesh: a.msh\n    material:\n      yong: 1e6\n",
     "s.yaml:6:7: unknown key 'yong' in bodies[0].material; did you mean 'young'?"},
    {BODY, "s.yaml:1:1: the scene needs 'time', for example time: {end: 0.5}"},
    {TIME, "s.yaml:1:1: the scene needs 'bodies', for example bodies: [{name"},
    {"time: {}\n", "s.yaml:1:7: time needs 'end', for example end: 0.5"},
    {"time:\n" BODY, "s.yaml:1:1: the scene needs 'time'"},
    {TIME "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0}}]\n",
     "s.yaml:2:43: bodies[0].material needs 'density', for example density: 1000"},
    {TIME "bodies: []\n", "s.yaml:2:9: bodies: expected a list of mappings, found a list of 0, one at least"},
    {TIME BODY "contact:\n", "s.yaml:3:1: nothing stands after 'contact:'; write '{}' for the defaults"},
    {TIME BODY "effects: {gravity: }\n", "s.yaml:3:11: nothing stands after 'gravity:'; write a value"},
    // Types.
    {"time: 3\n", "s.yaml:1:7: time: expected a mapping {key: value}, found the number 3"},
    {"time: {end: soon}\n",
     "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the text 'soon'"},
    {"time: {end: '1'}\n", "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the text '1'"},
    {"time: {end: [1]}\n", "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found a list of 1"},
    {"time: {end: true}\n", "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found true"},
    {"time: {end: 0x10}\n",
     "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the text '0x10'"},
    {"time: {end: 1_000}\n", "s.yaml:1:13: time.end: expected a number"},
    {"time: {end: 1, max_order: 1.5}\n",
     "s.yaml:1:27: time.max_order: expected a whole number in [1, 2], found the number 1.5"},
    {TIME "title: 3\n", "s.yaml:2:8: title: expected text, found the number 3; put it in quotes"},
    {TIME "title: ''\n", "s.yaml:2:8: title: expected text, found the text ''"},
    {TIME "output: {vtu: yes}\n", "s.yaml:2:15: output.vtu: expected true or false, found the text 'yes'"},
    {TIME "output: {vtu: 1}\n", "s.yaml:2:15: output.vtu: expected true or false, found the number 1"},
    {TIME "effects: {gravity: -9.81}\n",
     "s.yaml:2:20: effects.gravity: expected three numbers [x, y, z] [m/s²], found the number -9.81"},
    {TIME "effects: {gravity: [0, 0]}\n",
     "s.yaml:2:20: effects.gravity: expected three numbers [x, y, z] [m/s²], found a list of 2"},
    {TIME "effects: {gravity: [0, 0, down]}\n",
     "s.yaml:2:27: effects.gravity[2]: expected a number [m/s²], found the text 'down'"},
    {TIME "bodies: {name: a}\n", "s.yaml:2:9: bodies: expected a list of mappings, found a mapping"},
    {TIME "bodies: [a]\n", "s.yaml:2:10: bodies[0]: expected a mapping {key: value}, found the text 'a'"},
    {TIME "bodies: [{mesh: 3}]\n",
     "s.yaml:2:17: bodies[0].mesh: expected a mapping {key: value} or text (its 'file'), found the number 3"},
    {TIME "bodies: [{name: 'a b'}]\n", "s.yaml:2:17: bodies[0].name: expected a name of letters, digits"},
    {TIME BODY
     "obstacles: [{name: o, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}, motion: {spin: 1, axis: "
     "[1, 0, 0]}}]\n",
     "s.yaml:3:81: obstacles[0]: a half-space does not turn; use a box"},
    {TIME BODY "obstacles: [{name: o, sphere: {centre: [0, 0, 0], radius: 0}}]\n",
     "s.yaml:3:59: obstacles[0].sphere.radius: expected a number in (0, inf) [m], found the number 0"},
    {TIME BODY
     "obstacles: [{name: o, sphere: {centre: [0, 0, 0], radius: 1}, velocity: [1, 0, 0], motion: {velocity: "
     "[1, 0, 0]}}]\n",
     "s.yaml:3:"},
    {TIME BODY "effects: {friction: 0.3}\n",
     "s.yaml:3:11: unknown key 'friction' in effects; there is contact.friction"},
    {TIME BODY "contact: {friction: -1}\n",
     "s.yaml:3:21: contact.friction: expected a number in [0, inf), found the number -1"},
    {TIME BODY "contact: {friction: much}\n",
     "s.yaml:3:21: contact.friction: expected a mapping {key: value} or a number (its 'coefficient'), found"},
    {TIME BODY "contact: {potential: pair, viscosity: 1}\n",
     "s.yaml:3:39: contact: viscosity builds on the potential nodal"},
    {TIME BODY "contact: {friction: {slip_speed: 1}}\n", "s.yaml:3:21: contact.friction needs 'coefficient'"},
    {TIME BODY "contact: {friction: 1}\ncontact: {}\n",
     "s.yaml:4:1: duplicate key 'contact'; it stands at line 3, column 1 already"},
    {TIME BODY "contact: {potential: nodel}\n", "s.yaml:3:22: contact.potential: expected one of nodal, "
                                                "element, pair, linear, body, found the text 'nodel'; "
                                                "did you mean 'nodal'?"},
    {TIME BODY "contact: {overlap: clop}\n", "s.yaml:3:20: contact.overlap: expected one of clip"},
    {TIME BODY "contact: {hessian: true}\n",
     "s.yaml:3:20: contact.hessian: expected one of gauss_newton, full, found true"},
    {TIME BODY_WITH("fixed: [{all: false}]"),
     "s.yaml:6:19: bodies[0].fixed[0].all: expected true, found false"},
    {TIME BODY_WITH("fixed: [{all: true, components: [x, w]}]"),
     "s.yaml:6:41: bodies[0].fixed[0].components[1]: expected a list of some of x, y, z, found the text "
     "'w'"},
    {TIME BODY_WITH("fixed: [{all: true, components: [x, x]}]"),
     "s.yaml:6:41: bodies[0].fixed[0].components"},
    {TIME BODY_WITH("fixed: [{all: true, components: []}]"), "s.yaml:6:37: bodies[0].fixed[0].components"},
    // Ranges.
    {"time: {end: 0}\n", "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the number 0"},
    {"time: {end: -1}\n", "s.yaml:1:13: time.end"},
    {"time: {end: .inf}\n",
     "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the number .inf"},
    {"time: {end: .nan}\n",
     "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the number .nan"},
    {"time: {end: 1e999}\n",
     "s.yaml:1:13: time.end: expected a number in (0, inf) [s], found the number 1e999"},
    {"time: {end: 1, max_order: 3}\n", "s.yaml:1:27: time.max_order: expected a whole number in [1, 2]"},
    {"time: {end: 1, max_step: 1e-3, min_step: 1e-2}\n",
     "s.yaml:1:42: time: min_step must not exceed max_step"},
    {"time: {end: 1, max_step: 1e-3, initial_step: 1}\n", "s.yaml:1:46: time: initial_step must not exceed"},
    {TIME "effects: {gravity: [0, 0, .nan]}\n", "s.yaml:2:27: effects.gravity[2]: expected a number [m/s²]"},
    {TIME "bodies: [{material: {young: 0}}]\n",
     "s.yaml:2:29: bodies[0].material.young: expected a number in (0"},
    {TIME "bodies: [{material: {poisson: 0.5}}]\n",
     "s.yaml:2:31: bodies[0].material.poisson: expected a number in (-1, 0.5), found the number 0.5"},
    {TIME "bodies: [{material: {poisson: -1}}]\n", "s.yaml:2:31: bodies[0].material.poisson"},
    {TIME "bodies: [{material: {density: -3}}]\n", "s.yaml:2:31: bodies[0].material.density"},
    {TIME "bodies: [{mesh: {box: {size: [1, 1, 0], cells: 1}}}]\n",
     "s.yaml:2:37: bodies[0].mesh.box.size[2]: expected a number in (0, inf) [m], found the number 0"},
    {TIME "bodies: [{mesh: {box: {size: [1, 1, 1], cells: 0}}}]\n",
     "s.yaml:2:48: bodies[0].mesh.box.cells: expected a whole number or three [x, y, z] in [1, 10000]"},
    {TIME "bodies: [{mesh: {box: {size: [1, 1, 1], cells: [1, 2.5, 1]}}}]\n",
     "s.yaml:2:52: bodies[0].mesh.box.cells[1]: expected a whole number in [1, 10000], found the number 2.5"},
    {TIME "bodies: [{place: {scale: 0}}]\n",
     "s.yaml:2:26: bodies[0].place.scale: expected a number or three"},
    {TIME "bodies: [{place: {scale: [1, 0, 1]}}]\n", "s.yaml:2:26: bodies[0].place.scale"},
    {TIME "bodies: [{place: {rotate: {axis: [0, 0, 0], degrees: 3}}}]\n",
     "s.yaml:2:34: bodies[0].place.rotate.axis: expected a direction [x, y, z], not zero, found"},
    {TIME "bodies: [{place: {rotate: {degrees: 3}}}]\n", "s.yaml:2:27: bodies[0].place.rotate needs 'axis'"},
    {TIME BODY_WITH("fixed: [{box: {min: [0, 0, 1], max: [1, 1, 0]}}]"),
     "s.yaml:6:41: bodies[0].fixed[0].box: max must not be below min"},
    {TIME BODY_WITH("driven: [{all: true, table: [[0, 0, 0, 0], [1, 0, 0, 1], [1, 0, 0, 2]]}]"),
     "s.yaml:6:62: bodies[0].driven[0].table: the time 1 of row 2 does not follow 1; times must increase"},
    {TIME BODY_WITH("driven: [{all: true, table: [[0, 0, 0]]}]"),
     "s.yaml:6:34: bodies[0].driven[0].table[0]: expected rows [t, x, y, z] of four numbers, t increasing "
     "[s, m], "
     "found a list of 3"},
    {TIME BODY_WITH("driven: [{all: true, table: []}]"),
     "s.yaml:6:33: bodies[0].driven[0].table: expected rows"},
    {TIME BODY_WITH("driven: [{all: true, table: [0, 0, 0, 0, 1]}]"),
     "s.yaml:6:33: bodies[0].driven[0].table"},
    {TIME BODY_WITH("driven: [{all: true, velocity: [0, 0, 1], until: 0}]"),
     "s.yaml:6:54: bodies[0].driven[0].until: expected a number in (0, inf] [s], found the number 0"},
    {TIME BODY "output: {frames: 0}\n",
     "s.yaml:3:18: output.frames: expected a whole number in [1, 1000000]"},
    {TIME BODY "obstacles: [{name: g, halfspace: {point: [0, 0, 0], normal: [0, 0, 0]}}]\n",
     "s.yaml:3:61: obstacles[0].halfspace.normal: expected a direction"},
    // Contradictions.
    {TIME BODY_WITH("fixed: [{components: [x]}]"),
     "s.yaml:6:13: bodies[0].fixed[0] needs one of these keys: box halfspace group all"},
    {TIME BODY_WITH("fixed: [{all: true, group: top}]"),
     "s.yaml:6:25: 'all' and 'group' in bodies[0].fixed[0] contradict each other"},
    {TIME BODY_WITH("driven: [{all: true}]"), "s.yaml:6:14: bodies[0].driven[0] needs at least one of these "
                                              "keys: velocity amplitude table formula spin"},
    {TIME BODY_WITH("driven: [{all: true, velocity: [0, 0, 1], table: [[0, 0, 0, 0]]}]"),
     "s.yaml:6:26: 'velocity' in bodies[0].driven[0] contradicts 'table'; keep one of them"},
    {TIME BODY_WITH("driven: [{all: true, amplitude: [0, 0, 1]}]"),
     "s.yaml:6:26: 'amplitude' in bodies[0].driven[0] needs 'frequency' beside it"},
    {TIME BODY_WITH("driven: [{all: true, spin: 1}]"),
     "s.yaml:6:26: 'spin' in bodies[0].driven[0] needs 'axis'"},
    {TIME "bodies: [{name: a, mesh: {file: a, box: {size: [1, 1, 1], cells: 1}}, " MATERIAL "}]\n",
     "s.yaml:2:36: 'file' and 'box' in bodies[0].mesh contradict each other"},
    {TIME "bodies: [{name: a, mesh: {}, " MATERIAL "}]\n",
     "s.yaml:2:26: bodies[0].mesh needs one of these keys: file box"},
    {TIME "bodies: [{name: a, mesh: {size: 1, box: {size: [1, 1, 1], cells: 1}}, " MATERIAL "}]\n",
     "s.yaml:2:27: 'size' in bodies[0].mesh needs 'file' beside it"},
    {TIME BODY "obstacles: [{name: g, cylinder: {centre: [0, 0, 0], axis: [0, 0, 1], radius: 1, length: 1, "
               "faces: 9}}]\n",
     "s.yaml:3:99: obstacles[0].cylinder: the number of faces must be even"},
    {"bodies: [{name: b, mesh: m.msh, material: {young: 1, poisson: 0, density: 1}}]\ntime: {end: 1, static: "
     "true}\ncontact: {rest: {}}\n",
     "s.yaml:3:11: a static scene is at rest always; take 'rest' or time.static away"},
    {TIME BODY "obstacles: [{name: g}]\n",
     "s.yaml:3:13: obstacles[0] needs one of these keys: halfspace sphere box cylinder mesh"},
    {TIME BODY "obstacles: [{name: g, mesh: g.msh, velocity: [0, 0, 1]}]\n",
     "s.yaml:3:36: 'velocity' in obstacles[0] contradicts 'mesh'; keep one of them"},
    {TIME BODY_WITH("self_contact: true"), "s.yaml:6:5: 'self_contact' needs contact"},
    {TIME BODY "obstacles:\n  - name: a\n    mesh: g.msh\n",
     "s.yaml:4:11: the name 'a' is taken by another of the bodies"},
};
enum { WRONG_COUNT = sizeof wrong / sizeof *wrong };

START_TEST(a_wrong_scene_is_refused_with_its_place) {
  const Wrong *w = &wrong[_i];
  FemSceneDef scene;
  Status status = app_scene_read_text("s.yaml", w->text, strlen(w->text), &scene);
  ck_assert_msg(status == STATUS_INPUT, "%s\nstatus %d: %s", w->text, (int)status, status_message());
  ck_assert_msg(strncmp(status_message(), w->message, strlen(w->message)) == 0,
                "%s\nsaid:     %s\nexpected: %s", w->text, status_message(), w->message);
  ck_assert_ptr_null(scene.path);
  ck_assert_int_eq(scene.body_count, 0);
}
END_TEST

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
    ck_assert_ok(app_scene_read_text("s.yaml", text, strlen(text), &scene));
    ck_assert_double_eq(scene.end, cases[i].value);
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(infinity_is_allowed_where_the_range_has_it) {
  const char *text = TIME BODY_WITH("driven: [{all: true, velocity: [0, 0, 1], until: .inf}]");
  FemSceneDef scene;
  ck_assert_ok(app_scene_read_text("s.yaml", text, strlen(text), &scene));
  ck_assert(isinf(scene.bodies[0].driven[0].until));
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_table_may_be_written_flat) {
  const char *text = TIME BODY_WITH("driven: [{all: true, table: [0, 0, 0, 0, 1, 0, 0, 5]}]");
  FemSceneDef scene;
  ck_assert_ok(app_scene_read_text("s.yaml", text, strlen(text), &scene));
  ck_assert_int_eq(scene.bodies[0].driven[0].table_count, 2);
  ck_assert_double_eq(scene.bodies[0].driven[0].table[7], 5);
  fem_scene_destroy(&scene);
}
END_TEST

// Files.

START_TEST(a_missing_file_is_an_io_error) {
  FemSceneDef scene;
  ck_assert_int_eq(app_scene_read("/nowhere/s.yaml", NULL, 0, &scene), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "/nowhere/s.yaml"));
  ck_assert_int_eq(app_scene_read("/tmp", NULL, 0, &scene), STATUS_IO);
}
END_TEST

START_TEST(a_huge_file_is_refused) {
  size_t size = SCENE_TREE_MAX_BYTES + 1;
  char *text = memory_zeroed(size + 1, 1);
  memset(text, ' ', size);
  FemSceneDef scene;
  ck_assert_int_eq(app_scene_read_text("s.yaml", text, size, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "at most 16777216"));
  memory_free(text);
}
END_TEST

START_TEST(too_many_keys_or_values_are_refused) {
  size_t size = 4 << 20;
  char *text = memory_zeroed(size, 1);
  size_t used = 0;
  for (int i = 0; i <= SCENE_TREE_MAX_KEYS; i++) text_append(text, size, &used, "k%d: 1\n", i);
  FemSceneDef scene;
  ck_assert_int_eq(app_scene_read_text("s.yaml", text, used, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "s.yaml:1001:1: more than 1000 keys"));
  text[0] = '[';
  for (size_t i = 0; i <= SCENE_TREE_MAX_NODES; i++) memcpy(text + 1 + 2 * i, "1,", 2);
  ck_assert_int_eq(app_scene_read_text("s.yaml", text, 2 * SCENE_TREE_MAX_NODES + 2, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "more than 1000000 values"));
  memory_free(text);
}
END_TEST

// Whatever stands in a file, reading ends with a scene or with a message that names the file.
static void check_survives(const char *text, size_t size) {
  FemSceneDef scene;
  Status status = app_scene_read_text("s.yaml", text, size, &scene);
  ck_assert(status == STATUS_OK || status == STATUS_INPUT);
  if (status) ck_assert_msg(strncmp(status_message(), "s.yaml:", 7) == 0, "%s", status_message());
  fem_scene_destroy(&scene);
}

START_TEST(a_truncated_scene_is_survived) {
  char *text;
  size_t size;
  ck_assert_ok(file_read(full_yaml, &text, &size));
  for (size_t cut = 0; cut < size; cut++) check_survives(text, cut);
  memory_free(text);
}
END_TEST

START_TEST(a_corrupted_scene_is_survived) {
  char *text;
  size_t size;
  ck_assert_ok(file_read(full_yaml, &text, &size));
  static const char bytes[] = "{}[]:,-#&*!|>'\"%@`\n\t 0123456789.e~\\\x00\x80\xff";
  Random random = random_seeded(2025, 1);
  for (int trial = 0; trial < 3000; trial++) {
    char *copy = memory_copy(text, size + 1, 1);
    int changes = 1 + random_below(&random, 4);
    for (int c = 0; c < changes; c++)
      copy[random_below(&random, (int)size)] = bytes[random_below(&random, sizeof bytes - 1)];
    check_survives(copy, size);
    memory_free(copy);
  }
  memory_free(text);
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
    status = app_scene_write_resolved(&scene, record, "scene");
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

START_TEST(an_override_turns_contact_off_and_on) {
  static const char *const off[] = {"contact=null"};
  static const char *const on[] = {"contact=null", "contact.potential=pair"};
  FemSceneDef scene;
  ck_assert_ok(app_scene_read(full_yaml, off, 1, &scene));
  ck_assert(!scene.contact.is_on);
  fem_scene_destroy(&scene);
  ck_assert_ok(app_scene_read(full_yaml, on, 2, &scene));
  ck_assert(scene.contact.is_on);
  ck_assert_int_eq(scene.contact.potential, CONTACT_POTENTIAL_PAIR);
  ck_assert_str_eq(scene.contact.overlap, "geo");
  fem_scene_destroy(&scene);
}
END_TEST

static const Wrong wrong_overrides[] = {
    {"contact.stiffness", "--set contact.stiffness: no '='"},
    {"=3", "--set =3: no path before the '='"},
    {"a..b=3", "--set a..b=3: the path cannot be understood"},
    {"a.=3", "--set a.=3: the path cannot be understood"},
    {"bodies[x]=3", "--set bodies[x]=3: the path cannot be understood"},
    {"bodies[0=3", "--set bodies[0=3: the path cannot be understood"},
    {"contact.stifness=3",
     "--set contact.stifness=3: unknown key 'stifness' in contact; did you mean 'stiffness'?"},
    {"contcat.stiffness=3",
     "--set contcat.stiffness=3: unknown key 'contcat' in the scene; did you mean 'contact'?"},
    {"contact.stiffness=soft",
     "--set contact.stiffness=soft: contact.stiffness: expected a number in (0, inf)"},
    {"contact.stiffness=[1", "--set contact.stiffness=[1: not valid YAML: did not find expected ',' or ']'"},
    {"bodies.middle.velocity=[0, 0, 0]",
     "--set bodies.middle.velocity=[0, 0, 0]: bodies has no item 'middle'; there are 2: lower, upper-2"},
    {"bodies.1.velocity=[0, 0, 0]",
     "--set bodies.1.velocity=[0, 0, 0]: an item's number stands in brackets, from 0: bodies[1]"},
    {"bodies[2].velocity=[0, 0, 0]",
     "--set bodies[2].velocity=[0, 0, 0]: bodies has no item '2'; there are 2"},
    {"bodies.lower.mesh.size=1",
     "--set bodies.lower.mesh.size=1: bodies[0].mesh is the text 'lower.msh', so it "
     "has no 'size'; set all of bodies[0].mesh"},
};
enum { WRONG_OVERRIDE_COUNT = sizeof wrong_overrides / sizeof *wrong_overrides };

START_TEST(a_wrong_override_is_refused_by_name) {
  const Wrong *w = &wrong_overrides[_i];
  FemSceneDef scene;
  Status status = app_scene_read(full_yaml, &w->text, 1, &scene);
  ck_assert_msg(status == STATUS_USAGE, "%s: status %d: %s", w->text, (int)status, status_message());
  ck_assert_msg(strncmp(status_message(), w->message, strlen(w->message)) == 0, "said:     %s\nexpected: %s",
                status_message(), w->message);
}
END_TEST

// Words.

START_TEST(distances_count_slips_of_the_finger) {
  ck_assert_int_eq(text_distance("young", "young"), 0);
  ck_assert_int_eq(text_distance("yong", "young"), 1);
  ck_assert_int_eq(text_distance("tiem", "time"), 1); // neighbours swapped
  ck_assert_int_eq(text_distance("kitten", "sitting"), 3);
  ck_assert_int_eq(text_distance("End", "end"), 0);
  ck_assert_int_eq(text_distance("", "abc"), 3);
  char longer[TEXT_MAX_WORD + 2];
  memset(longer, 'a', sizeof longer);
  longer[sizeof longer - 1] = 0;
  ck_assert_int_eq(text_distance(longer, "a"), TEXT_MAX_WORD);
}
END_TEST

START_TEST(a_guess_is_near_or_none) {
  TextGuess guess = text_guess_of("densty");
  text_guess_offer(&guess, "young"), text_guess_offer(&guess, "density");
  ck_assert_str_eq(guess.best, "density");
  guess = text_guess_of("colour");
  text_guess_offer(&guess, "young"), text_guess_offer(&guess, "density");
  ck_assert_ptr_null(guess.best);
}
END_TEST

START_TEST(utf8_is_told_from_what_is_not) {
  static const char *const good[] = {"a", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xef\xbf\xbf"};
  static const char *const bad[] = {
      "\x80",    "\xc0\xaf", "\xc3", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80",
      "\xe2\x82"};
  for (int i = 0; i < 5; i++) ck_assert_uint_eq(text_utf8_valid(good[i], strlen(good[i])), strlen(good[i]));
  for (int i = 0; i < 8; i++) ck_assert_uint_eq(text_utf8_valid(bad[i], strlen(bad[i])), 0);
}
END_TEST

// The manual and the schema.

static Status print_schema(FILE *stream) {
  Record *schema = record_new();
  TRY(app_scene_schema_record(schema));
  Status status = record_print(schema, stream);
  record_destroy(schema);
  return status;
}

static void check_current(const char *path, Status (*print)(FILE *stream), const char *command) {
  char *text, *now = printed(print);
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_msg(strcmp(text, now) == 0, "%s is out of date: %s", path, command);
  memory_free(text);
  free(now);
}

START_TEST(the_manual_page_is_current) {
  check_current(TETLAP_SOURCE_DIR "/docs/scene.md", app_scene_manual_print,
                "tetlap schema --markdown > docs/scene.md");
}
END_TEST

START_TEST(the_schema_file_is_current) {
  check_current(TETLAP_SOURCE_DIR "/docs/scene.schema.json", print_schema,
                "tetlap schema > docs/scene.schema.json");
}
END_TEST

// Every range can be read, and its message shows it as the table has it.
static void check_ranges(const SceneSection *section) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (key->section) check_ranges(key->section);
    ck_assert_msg(key->help && key->help[0], "'%s' has no help", key->name);
    if (!key->range) continue;
    SceneRange range = app_scene_keys_range(key);
    ck_assert_msg(range.min < range.max, "'%s' has the range %s", key->name, key->range);
    ck_assert(strchr("[(", key->range[0]) && strchr("])", key->range[strlen(key->range) - 1]));
    ck_assert(app_scene_keys_allows(key, range.min) == !range.is_min_open);
    ck_assert(app_scene_keys_allows(key, range.max) == !range.is_max_open);
    ck_assert(!app_scene_keys_allows(key, NAN));
  }
}

START_TEST(ranges_of_the_table_are_well_formed) {
  check_ranges(&app_scene_keys_root);
}
END_TEST

START_TEST(the_examples_of_required_keys_make_a_scene) {
  char text[1024];
  size_t used = 0;
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(&app_scene_keys_root, i)); i++)
    if (key->required) text_append(text, sizeof text, &used, "%s: %s\n", key->name, key->required);
  FemSceneDef scene;
  ck_assert_ok(app_scene_read_text("s.yaml", text, used, &scene));
  fem_scene_destroy(&scene);
}
END_TEST

// The program.

static int run_program(const char *first, const char *second, const char *third) {
  const char *texts[] = {"tetlap", first, second, third};
  char *arguments[5] = {NULL};
  int count = 0;
  for (; count < 4 && texts[count]; count++) arguments[count] = strdup(texts[count]);
  ck_assert_ptr_nonnull(freopen("/dev/null", "w", stdout));
  ck_assert_ptr_nonnull(freopen("/dev/null", "w", stderr));
  char *kept[4];
  memcpy(kept, arguments, sizeof kept);
  int code = app_program_run(count, arguments);
  for (int i = 0; i < count; i++) free(kept[i]);
  return code;
}

START_TEST(exit_codes_say_who_is_to_blame) {
  ck_assert_int_eq(run_program(NULL, NULL, NULL), 64);
  ck_assert_int_eq(run_program("rnu", NULL, NULL), 64);
  ck_assert_int_eq(run_program("help", NULL, NULL), 0);
  ck_assert_int_eq(run_program("version", NULL, NULL), 0);
  ck_assert_int_eq(run_program("effects", NULL, NULL), 0);
  ck_assert_int_eq(run_program("schema", NULL, NULL), 0);
  ck_assert_int_eq(run_program("schema", "--markdown", NULL), 0);
  ck_assert_int_eq(run_program("check", "/nowhere.yaml", NULL), 74);
  ck_assert_int_eq(run_program("check", full_yaml, NULL), 74); // its meshes are not there
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/CMakeLists.txt", NULL), 65);
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/examples/01_drop.yaml", "--set=time.ende=3"), 64);
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/examples/01_drop.yaml", "--json"), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("scene");
  tcase_add_test(cases, a_scene_with_every_key_is_read);
  tcase_add_test(cases, json_means_the_same);
  tcase_add_test(cases, the_full_scene_has_every_key_of_the_table);
  tcase_add_test(cases, absent_keys_take_their_defaults);
  tcase_add_test(cases, an_empty_contact_section_turns_contact_on);
  tcase_add_test(cases, a_resolved_scene_is_the_same_scene);
  tcase_add_test(cases, a_resolved_scene_names_what_was_left_out);
  tcase_add_loop_test(cases, examples_are_read_and_written_back, 0, EXAMPLE_COUNT);
  tcase_add_loop_test(cases, a_wrong_scene_is_refused_with_its_place, 0, WRONG_COUNT);
  tcase_add_test(cases, numbers_are_read_as_people_write_them);
  tcase_add_test(cases, infinity_is_allowed_where_the_range_has_it);
  tcase_add_test(cases, a_table_may_be_written_flat);
  tcase_add_test(cases, a_missing_file_is_an_io_error);
  tcase_add_test(cases, a_huge_file_is_refused);
  tcase_add_test(cases, too_many_keys_or_values_are_refused);
  tcase_add_test(cases, a_truncated_scene_is_survived);
  tcase_add_test(cases, a_corrupted_scene_is_survived);
  tcase_add_test(cases, every_failed_allocation_is_reported);
  tcase_add_test(cases, overrides_replace_values);
  tcase_add_test(cases, an_override_turns_contact_off_and_on);
  tcase_add_loop_test(cases, a_wrong_override_is_refused_by_name, 0, WRONG_OVERRIDE_COUNT);
  tcase_add_test(cases, distances_count_slips_of_the_finger);
  tcase_add_test(cases, a_guess_is_near_or_none);
  tcase_add_test(cases, utf8_is_told_from_what_is_not);
  tcase_add_test(cases, the_manual_page_is_current);
  tcase_add_test(cases, the_schema_file_is_current);
  tcase_add_test(cases, ranges_of_the_table_are_well_formed);
  tcase_add_test(cases, the_examples_of_required_keys_make_a_scene);
  tcase_add_test(cases, exit_codes_say_who_is_to_blame);
  return suite_run("scene", cases, 60);
}
