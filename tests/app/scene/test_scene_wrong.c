// SPDX-License-Identifier: GPL-3.0-or-later
// app/scene/read.h: every way in which a scene file or an override can be wrong, with the place and the words
// of the message; whatever stands in a file is survived.
#include "suite.h"

#include <string.h>

#include "app/scene/read.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/text.h"
#include "scene_text.h"

static const char *const full_yaml = TETLAP_SOURCE_DIR "/tests/data/scene/full.yaml";

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
    {TIME BODY "---\ntime: {end: 2}\n", "s.yaml:3:1: a second document ('---'); a file holds one scene"},
    {"? [a, b]\n: c\n", "s.yaml:1:3: a key must be a word"},
    {TIME "time: {end: 2}\n", "s.yaml:2:1: duplicate key 'time'; it is already at line 1, column 1"},
    {"time: {end: 1, end: 2}\n", "s.yaml:1:16: duplicate key 'end'; it is already at line 1, column 8"},
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
    {"stiffness: 3\n", "s.yaml:1:1: unknown key 'stiffness' in the scene; did you mean contact.stiffness? "
                       "The keys here are title, time"},
    {TIME "bodies:\n  - name: a\n    mesh: a.msh\n    material:\n      yong: 1e6\n",
     "s.yaml:6:7: unknown key 'yong' in bodies[0].material; did you mean 'young'?"},
    {BODY, "s.yaml:1:1: the scene needs 'time', for example time: {end: 0.5}"},
    {TIME, "s.yaml:1:1: the scene needs 'bodies', for example bodies: [{name"},
    {"time: {}\n", "s.yaml:1:7: time needs 'end', for example end: 0.5"},
    {"time:\n" BODY, "s.yaml:1:1: the scene needs 'time'"},
    {TIME "bodies: [{name: a, mesh: a.msh, material: {young: 1, poisson: 0}}]\n",
     "s.yaml:2:43: bodies[0].material needs 'density', for example density: 1000"},
    {TIME "bodies: []\n",
     "s.yaml:2:9: bodies: expected a list of mappings, found a list of 0; give at least one"},
    {TIME "bodies:\n  - {name: a, mesh: a.msh, material: {young: 1,000,000, poisson: 0}}\n",
     "s.yaml:3:48: a number, '000', where a key must be; numbers have no commas: write 1000000, 0.5"},
    {TIME BODY "contact: {friction: 0,5}\n", "s.yaml:3:23: a number, '5', where a key must be"},
    {TIME BODY "contact:\n", "s.yaml:3:1: there is no value after 'contact:'; write '{}' for the defaults"},
    {TIME BODY "effects: {gravity: }\n", "s.yaml:3:11: there is no value after 'gravity:'; write a value"},
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
     "s.yaml:3:11: unknown key 'friction' in effects; did you mean contact.friction? The keys here are"},
    {TIME BODY "contact: {friction: -1}\n",
     "s.yaml:3:21: contact.friction: expected a number in [0, inf), found the number -1"},
    {TIME BODY "contact: {friction: {coefficient: 0.4, static: 0.3}}\n",
     "s.yaml:3:48: contact.friction: static must not be below coefficient"},
    {TIME BODY "contact: {pairs: [{bodies: [a, a], friction: {static: 0.3}}]}\n",
     "s.yaml:3:46: contact.pairs[0].friction needs 'coefficient'"},
    {TIME BODY "contact: {friction: much}\n",
     "s.yaml:3:21: contact.friction: expected a mapping {key: value} or a number (its 'coefficient'), found"},
    {TIME BODY "contact: {potential: nodal, friction: 1}\n",
     "s.yaml:3:39: contact: friction builds on the potential field; remove 'potential' and 'stiffness'"},
    {TIME BODY "contact: {potential: nodal, viscosity: 1}\n",
     "s.yaml:3:40: contact: viscous contact builds on the potential field; remove 'potential' and "
     "'stiffness'"},
    {TIME BODY "contact: {potential: nodal, smooth: 1}\n",
     "s.yaml:3:37: contact: only the potential field works on smooth surfaces"},
    {TIME BODY "contact: {friction: {}}\n", "s.yaml:3:21: contact.friction needs 'coefficient'"},
    {TIME BODY "contact: {friction: {coefficient: 1, law: stick}}\n",
     "s.yaml:3:38: contact.friction.law: there is no such key any more; remove it and write the coefficient "
     "alone, "
     "as friction: 0.3"},
    {TIME BODY "contact: {friction: {coefficient: 1, slip_speed: 1}}\n",
     "s.yaml:3:38: contact.friction.slip_speed: there is no such key any more; remove it"},
    {TIME BODY "contact: {potential: pair}\n",
     "s.yaml:3:22: contact.potential: expected one of nodal, field, found the text 'pair', which there is no "
     "longer; remove 'potential' and 'stiffness': the default potential is 'field', whose stiffness is "
     "chosen from "
     "the bodies; if you set it, it is in Pa/m"},
    {TIME BODY "contact: {potential: linear}\n",
     "s.yaml:3:22: contact.potential: expected one of nodal, field, found the text "
     "'linear', which there is no longer; remove"},
    {TIME BODY "contact: {friction: 1}\ncontact: {}\n",
     "s.yaml:4:1: duplicate key 'contact'; it is already at line 3, column 1"},
    {TIME BODY "contact: {potential: nodel}\n", "s.yaml:3:22: contact.potential: expected one of nodal, "
                                                "field, found the text 'nodel'; "
                                                "did you mean 'nodal'?"},
    {TIME BODY "contact: {net: {ghosts: keep}}\n",
     "s.yaml:3:11: contact.net: there is no such key any more; write into contact.overlap, before the model, "
     "what it asks for: keep="},
    {TIME BODY "contact: {overlap: clop}\n", "s.yaml:3:20: contact.overlap: expected one of clip"},
    {TIME BODY "contact: {potential: true}\n",
     "s.yaml:3:22: contact.potential: expected one of nodal, field, found true"},
    {TIME BODY "contact: {hessian: gauss_newton}\n",
     "s.yaml:3:11: contact.hessian: there is no such key any more; remove it: the matrix has all"},
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
     "s.yaml:6:13: bodies[0].fixed[0] needs one of these keys: box halfspace radius normal group all"},
    {TIME BODY_WITH("fixed: [{all: true, group: top}]"),
     "s.yaml:6:25: 'all' and 'group' in bodies[0].fixed[0] contradict each other"},
    {TIME BODY_WITH("driven: [{all: true}]"), "s.yaml:6:14: bodies[0].driven[0] needs at least one of these "
                                              "keys: velocity amplitude table formula spin turn"},
    {TIME BODY_WITH("driven: [{all: true, velocity: [0, 0, 1], table: [[0, 0, 0, 0]]}]"),
     "s.yaml:6:26: 'velocity' in bodies[0].driven[0] contradicts 'table'; keep one of them"},
    {TIME BODY_WITH("driven: [{all: true, amplitude: [0, 0, 1]}]"),
     "s.yaml:6:26: 'amplitude' in bodies[0].driven[0] also needs 'frequency'"},
    {TIME BODY_WITH("driven: [{all: true, spin: 1}]"),
     "s.yaml:6:26: 'spin' in bodies[0].driven[0] also needs 'axis'"},
    {TIME BODY_WITH("driven: [{all: true, spin: 1, axis: [0, 0, 1], turn: {axis: [0, 0, 1], angle: t}}]"),
     "s.yaml:6:26: 'spin' in bodies[0].driven[0] contradicts 'turn'; keep one of them"},
    {TIME BODY_WITH("driven: [{all: true, turn: {axis: [0, 0, 1]}}]"),
     "s.yaml:6:32: bodies[0].driven[0].turn needs one of these keys: angle table"},
    {TIME "bodies: [{name: a, mesh: {file: a, box: {size: [1, 1, 1], cells: 1}}, " MATERIAL "}]\n",
     "s.yaml:2:36: 'file' and 'box' in bodies[0].mesh contradict each other"},
    {TIME "bodies: [{name: a, mesh: {}, " MATERIAL "}]\n",
     "s.yaml:2:26: bodies[0].mesh needs one of these keys: file box"},
    {TIME "bodies: [{name: a, mesh: {size: 1, box: {size: [1, 1, 1], cells: 1}}, " MATERIAL "}]\n",
     "s.yaml:2:27: 'size' in bodies[0].mesh also needs 'file'"},
    {TIME BODY "obstacles: [{name: g, cylinder: {centre: [0, 0, 0], axis: [0, 0, 1], radius: 1, length: 1, "
               "faces: 9}}]\n",
     "s.yaml:3:92: obstacles[0].cylinder.faces: there is no such key any more; remove it: a cylinder is "
     "exactly round"},
    {"bodies: [{name: b, mesh: m.msh, material: {young: 1, poisson: 0, density: 1}}]\ntime: {end: 1, static: "
     "true}\ncontact: {rest: {}}\n",
     "s.yaml:3:11: a static scene is at rest always; remove 'rest' or time.static"},
    {TIME BODY "obstacles: [{name: g}]\n",
     "s.yaml:3:13: obstacles[0] needs one of these keys: halfspace sphere box cylinder mesh"},
    {TIME BODY "obstacles: [{name: g, mesh: g.msh, velocity: [0, 0, 1]}]\n",
     "s.yaml:3:36: 'velocity' in obstacles[0] contradicts 'mesh'; keep one of them"},
    {TIME
     "bodies: [{name: a, mesh: a.msh, material: {law: neo_hookean_log, young: 1, poisson: -0.1, density: "
     "1}}]\n",
     "s.yaml:2:85: bodies[0].material: neo_hookean_log needs ν ≥ 0"},
    {TIME BODY_WITH("self_contact: true"), "s.yaml:6:5: 'self_contact' needs contact"},
    {TIME BODY "obstacles:\n  - name: a\n    mesh: g.msh\n",
     "s.yaml:4:11: the name 'a' is taken by another of the bodies"},
};
enum { WRONG_COUNT = sizeof wrong / sizeof *wrong };

START_TEST(a_wrong_scene_is_refused_with_its_place) {
  const Wrong *w = &wrong[_i];
  FemSceneDef scene;
  Status status = scene_text_read("s.yaml", w->text, strlen(w->text), &scene);
  ck_assert_msg(status == STATUS_INPUT, "%s\nstatus %d: %s", w->text, (int)status, status_message());
  ck_assert_msg(strncmp(status_message(), w->message, strlen(w->message)) == 0,
                "%s\nsaid:     %s\nexpected: %s", w->text, status_message(), w->message);
  ck_assert_ptr_null(scene.path);
  ck_assert_int_eq(scene.body_count, 0);
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
  ck_assert_int_eq(scene_text_read("s.yaml", text, size, &scene), STATUS_INPUT);
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
  ck_assert_int_eq(scene_text_read("s.yaml", text, used, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "s.yaml:1001:1: more than 1000 keys"));
  text[0] = '[';
  for (size_t i = 0; i <= SCENE_TREE_MAX_NODES; i++) memcpy(text + 1 + 2 * i, "1,", 2);
  ck_assert_int_eq(scene_text_read("s.yaml", text, 2 * SCENE_TREE_MAX_NODES + 2, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "more than 1000000 values"));
  memory_free(text);
}
END_TEST

// Whatever stands in a file, reading ends with a scene or with a message that names the file.
static void check_survives(const char *text, size_t size) {
  FemSceneDef scene;
  Status status = scene_text_read("s.yaml", text, size, &scene);
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

// Overrides.

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

int main(void) {
  TCase *cases = tcase_create("scene_wrong");
  tcase_add_loop_test(cases, a_wrong_scene_is_refused_with_its_place, 0, WRONG_COUNT);
  tcase_add_test(cases, a_missing_file_is_an_io_error);
  tcase_add_test(cases, a_huge_file_is_refused);
  tcase_add_test(cases, too_many_keys_or_values_are_refused);
  tcase_add_test(cases, a_truncated_scene_is_survived);
  tcase_add_test(cases, a_corrupted_scene_is_survived);
  tcase_add_loop_test(cases, a_wrong_override_is_refused_by_name, 0, WRONG_OVERRIDE_COUNT);
  return suite_run("scene_wrong", cases, 60);
}
