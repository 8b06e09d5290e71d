// SPDX-License-Identifier: GPL-3.0-or-later
// Which elements have passed through a body: on blocks that are moved by hand, in any unit of length.
#include "blocks.h"
#include "evaluated.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/passage/passage.h"
#include "contact/shape/convex.h"
#include "contact/surface/middle.h"
#include "overlap/models.h"

typedef struct Scene {
  Blocks blocks;
  double *rest, *still;
  ContactShape shape;
  int shape_count;
  double margin; // 0: the default
  bool looks_again;
  OverlapModel model;
  ContactSystem *system;
  ContactPassage passage;
  int passed, most_turned;
} Scene;

static void start(Scene *scene) {
  scene->rest = blocks_copy(&scene->blocks);
  scene->still = calloc(3 * (size_t)scene->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(scene->still);
  ck_assert_ok(overlap_models_create(&scene->model, "clip"));
  ContactSystemDef def = blocks_def(&scene->blocks, scene->rest, &scene->model);
  def.potential = CONTACT_POTENTIAL_FIELD;
  def.margin = scene->margin;
  def.shapes = &scene->shape, def.shape_count = scene->shape_count;
  ck_assert_ok(contact_system_create(&scene->system, &def));
}

static void destroy(Scene *scene) {
  contact_passage_destroy(&scene->passage);
  contact_system_destroy(scene->system);
  overlap_model_destroy(&scene->model);
  blocks_destroy(&scene->blocks);
  free(scene->rest), free(scene->still);
}

// The present positions are the next accepted state.
static void look(Scene *scene) {
  ck_assert_ok(contact_system_update(scene->system, 0, scene->blocks.x, scene->still, 0.01));
  ck_assert_ok(
      contact_passage_look(&scene->passage, scene->system, evaluated_at(scene->system, 0, scene->blocks.x)));
  scene->passed += scene->passage.passed.elements;
  contact_passage_accept(&scene->passage);
  scene->most_turned = (int)fmax(scene->most_turned, contact_passage_turned(&scene->passage).elements);
}

// The caller's.
static double *save(const ContactPassage *passage, size_t *size) {
  *size = sizeof(double) * CONTACT_PASSAGE_KEPT * (size_t)passage->now.count;
  double *values = malloc(*size + 1);
  ck_assert_ptr_nonnull(values);
  contact_passage_save(passage, values);
  return values;
}

// A second look at a state finds what the first one found.
static void look_again(Scene *scene) {
  size_t size, size_again;
  double *values = save(&scene->passage, &size);
  look(scene);
  double *values_again = save(&scene->passage, &size_again);
  ck_assert_uint_eq(size_again, size);
  ck_assert_int_eq(memcmp(values, values_again, size), 0);
  free(values), free(values_again);
}

static void accept(Scene *scene) {
  look(scene);
  if (scene->looks_again) look_again(scene);
}

// The last block moves on, in so many steps.
static void move(Scene *scene, int steps, const double way[3]) {
  const double by[3] = {way[0] / steps, way[1] / steps, way[2] / steps};
  for (int i = 0; i < steps; i++) {
    blocks_shift(&scene->blocks, scene->blocks.x, scene->blocks.body_count - 1, by);
    accept(scene);
  }
}

// A plate, one cell thick, and a block above it.
static void start_plate_and_block(Scene *scene, double unit) {
  *scene = (Scene){.shape_count = 0};
  blocks_add(&scene->blocks,
             &(BlockDef){.cell = {unit, unit, 0.3 * unit}, .cells = {4, 4, 1}, .jitter = 0.1});
  blocks_add(&scene->blocks, &(BlockDef){.corner = {1.61 * unit, 1.57 * unit, 0.5 * unit},
                                         .cell = {0.4 * unit, 0.4 * unit, 0.4 * unit},
                                         .cells = {2, 2, 2},
                                         .jitter = 0.1});
  start(scene);
}

static const double UNITS[] = {1, 1e-3, 1e3};

START_TEST(what_crosses_a_plate_has_passed_in_any_unit) {
  int passed[3];
  for (int u = 0; u < 3; u++) {
    Scene scene;
    start_plate_and_block(&scene, UNITS[u]);
    move(&scene, 40, (const double[]){0, 0, -2 * UNITS[u]});
    passed[u] = scene.passed;
    destroy(&scene);
  }
  ck_assert_int_gt(passed[0], 0);
  ck_assert_int_eq(passed[1], passed[0]);
  ck_assert_int_eq(passed[2], passed[0]);
}
END_TEST

START_TEST(what_enters_by_a_third_and_comes_back_has_not) {
  for (int u = 0; u < 3; u++) {
    Scene scene;
    start_plate_and_block(&scene, UNITS[u]);
    move(&scene, 15, (const double[]){0, 0, -0.3 * UNITS[u]});
    move(&scene, 15, (const double[]){0, 0, 0.3 * UNITS[u]});
    ck_assert_int_eq(scene.passed, 0);
    ck_assert_int_eq(scene.most_turned, 0);
    destroy(&scene);
  }
}
END_TEST

START_TEST(what_touches_lightly_is_not_followed) {
  const double depths[] = {0.003, 0.06};
  for (int k = 0; k < 2; k++) {
    Scene scene = {.shape_count = 0};
    blocks_add(&scene.blocks, &(BlockDef){.cell = {0.5, 0.5, 0.5}, .cells = {4, 4, 4}});
    blocks_add(&scene.blocks,
               &(BlockDef){.corner = {0.21, 0.17, 2.01}, .cell = {0.5, 0.5, 0.5}, .cells = {3, 3, 3}});
    start(&scene);
    move(&scene, 1, (const double[]){0, 0, -0.01 - depths[k]});
    ck_assert_int_gt(evaluated_at(scene.system, 0, scene.blocks.x)->pair_count, 0);
    ck_assert_int_eq(scene.passage.now.count > 0, k == 1);
    destroy(&scene);
  }
}
END_TEST

// In through the upper side of a plate to the lower one, near which it stays for a while, in steps that leave
// the middle out.
static void cross_in_jumps(Scene *scene, double margin, int layers) {
  blocks_add(&scene->blocks, &(BlockDef){.cell = {0.25, 0.25, 0.3 / layers}, .cells = {8, 8, layers}});
  blocks_add(&scene->blocks,
             &(BlockDef){.corner = {0.81, 0.77, 0.31}, .cell = {0.4, 0.4, 0.4}, .cells = {1, 1, 1}});
  scene->margin = margin;
  start(scene);
  move(scene, 2, (const double[]){0, 0, -0.11});
  move(scene, 1, (const double[]){0, 0, -0.59});
  move(scene, 2, (const double[]){0.02, 0, 0});
  ck_assert_int_gt(scene->passage.now.count, 0);
}

START_TEST(what_has_been_deep_inside_turns_however_long_it_stays_near_the_other_side) {
  for (int k = 0; k < 2; k++) {
    Scene scene = {.shape_count = 0};
    cross_in_jumps(&scene, 0.5, 2);
    ck_assert_int_gt(contact_passage_turned(&scene.passage).elements, 0);
    if (k == 1) move(&scene, 1, (const double[]){0, 0, 0.09}); // deep again
    move(&scene, 1, (const double[]){0, 0, -0.2});
    ck_assert_int_gt(scene.passed, 0);
    destroy(&scene);
  }
}
END_TEST

// A plate as thin as a step is long, in one step: from a light touch to near the other side.
START_TEST(what_jumps_through_a_thin_plate_from_a_light_touch_has_passed) {
  Scene scene = {.shape_count = 0};
  blocks_add(&scene.blocks, &(BlockDef){.cell = {0.5, 0.5, 0.2}, .cells = {4, 4, 1}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {0.81, 0.77, 0.21}, .cell = {0.4, 0.4, 0.1}, .cells = {1, 1, 1}});
  start(&scene);
  ck_assert_double_gt(contact_system_layout(scene.system)->margin, 0.15);
  move(&scene, 1, (const double[]){0, 0, -0.013});
  move(&scene, 1, (const double[]){0, 0, -0.15});
  ck_assert_int_gt(contact_passage_turned(&scene.passage).elements, 0);
  move(&scene, 2, (const double[]){0, 0, -0.2});
  ck_assert_int_gt(scene.passed, 0);
  destroy(&scene);
}
END_TEST

// From where the lists were made, which hold for .2, a light touch is .055 back and the middle of the box .16
// ahead.
START_TEST(what_turns_back_to_a_light_touch_and_jumps_beyond_the_middle_is_turned) {
  ContactConvex box;
  contact_convex_make_box(&box, (const double[]){1, 1, 0.22});
  Scene scene = {.shape = {.kind = CONTACT_SHAPE_CONVEX,
                           .convex = &box,
                           .point = {0, 0, -0.22},
                           .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                 .shape_count = 1,
                 .margin = 0.2};
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-0.021, -0.019, 0.01}, .cell = {0.02, 0.02, 0.01}, .cells = {2, 2, 2}});
  start(&scene);
  move(&scene, 1, (const double[]){0, 0, -0.07});
  move(&scene, 1, (const double[]){0, 0, 0.055});
  ck_assert_int_gt(scene.passage.now.count, 0);
  ck_assert_int_eq(scene.most_turned, 0);
  move(&scene, 1, (const double[]){0, 0, -0.25});
  ck_assert_int_gt(contact_passage_turned(&scene.passage).elements, 0);
  destroy(&scene);
}
END_TEST

// The middle of the plate, .15 away, is out of its reach: the element has come round an edge.
START_TEST(what_a_step_cannot_carry_to_the_other_side_is_not_turned) {
  Scene scene = {.shape_count = 0};
  cross_in_jumps(&scene, 0.06, 1);
  ck_assert_int_eq(scene.most_turned, 0);
  move(&scene, 1, (const double[]){0, 0, -0.2});
  ck_assert_int_eq(scene.passed, 0);
  destroy(&scene);
}
END_TEST

// Two plates of one body with another plate in the gap between them, which is too narrow by a fifth.
static void start_plate_between(Scene *scene) {
  *scene = (Scene){.shape_count = 0};
  Blocks *blocks = &scene->blocks;
  blocks_add(blocks, &(BlockDef){.cell = {1, 1, 0.3}, .cells = {4, 4, 1}});
  blocks_add(blocks, &(BlockDef){.corner = {0, 0, 0.54}, .cell = {1, 1, 0.3}, .cells = {4, 4, 1}});
  blocks->bodies[0].vertex_end = blocks->vertex_count;
  blocks->bodies[0].tet_end = blocks->tet_count;
  blocks->body_count = 1;
  blocks_add(blocks, &(BlockDef){.corner = {0.71, 0.63, 0.27}, .cell = {0.8, 0.8, 0.3}, .cells = {3, 3, 1}});
  start(scene);
}

// Pressed from both sides, now more by one and now by the other.
START_TEST(what_lies_between_two_layers_has_not_passed_either) {
  Scene scene;
  start_plate_between(&scene);
  for (int i = 0; i < 3; i++) {
    move(&scene, 4, (const double[]){0, 0, 0.02});
    move(&scene, 8, (const double[]){0.1, 0, -0.04});
    move(&scene, 4, (const double[]){0, 0.1, 0.02});
  }
  ck_assert_int_gt(scene.passage.now.count, 2 * 54 - 36);
  ck_assert_int_eq(scene.passed, 0);
  ck_assert_int_eq(scene.most_turned, 0);
  move(&scene, 30, (const double[]){0, 0, 0.7}); // now it does pass, one of them
  ck_assert_int_gt(scene.passed, 0);
  destroy(&scene);
}
END_TEST

START_TEST(a_second_look_at_a_state_changes_nothing) {
  Scene scene = {.looks_again = true};
  blocks_add(&scene.blocks, &(BlockDef){.cell = {0.5, 0.5, 0.5}, .cells = {4, 4, 4}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {0.81, 0.77, 2.01}, .cell = {0.2, 0.2, 0.2}, .cells = {1, 1, 1}});
  start(&scene);
  move(&scene, 1, (const double[]){0, 0, -0.26}); // deep
  ck_assert_int_gt(scene.passage.now.count, 0);
  move(&scene, 1, (const double[]){0, 0, 0.245}); // and out again, to a light touch
  destroy(&scene);
  scene = (Scene){.looks_again = true};
  cross_in_jumps(&scene, 0.5, 2);
  destroy(&scene);
  start_plate_and_block(&scene, 1);
  scene.looks_again = true;
  move(&scene, 40, (const double[]){0, 0, -2});
  ck_assert_int_gt(scene.passed, 0);
  destroy(&scene);
  start_plate_between(&scene);
  scene.looks_again = true;
  move(&scene, 20, (const double[]){0.1, 0, 0.5});
  ck_assert_int_gt(scene.most_turned, 0);
  destroy(&scene);
}
END_TEST

// An element that is deep inside, h there, and that has a direction.
static ContactPassageEntry find_deep(const Scene *scene) {
  const ContactPassageList *now = &scene->passage.now;
  for (int i = 0; i < now->count; i++)
    if (now->entries[i].is_deep && vec3_length(vec3_at(now->entries[i].direction)) > 0)
      return now->entries[i];
  ck_abort_msg("no element is deep inside");
}

// In place of what was accepted.
static void load(Scene *scene, int count, const ContactPassageEntry *entries) {
  contact_passage_destroy(&scene->passage);
  scene->passage.now = (ContactPassageList){.entries = (ContactPassageEntry *)entries, .count = count};
  size_t size;
  double *values = save(&scene->passage, &size);
  scene->passage.now = (ContactPassageList){0};
  ck_assert_ok(contact_passage_load(&scene->passage, count, values));
  free(values);
}

// One came in from beyond and is at its deepest; the other does not know whence, or is at the surface.
START_TEST(where_parts_become_one_what_may_turn_is_not_forgotten) {
  Scene scene;
  start_plate_and_block(&scene, 1);
  move(&scene, 1, (const double[]){0, 0, -0.3});
  ContactPassageEntry near = find_deep(&scene), far = near, unknown = near;
  near.is_deep = false;
  vec3_store(far.direction, vec3_scale(-1, vec3_at(near.direction)));
  vec3_store(unknown.direction, (Vec3){0, 0, 0});
  const ContactPassageEntry lists[][2] = {{far, unknown}, {unknown, far}, {far, near}, {near, far}};
  for (int k = 0; k < 4; k++) {
    load(&scene, 2, lists[k]);
    accept(&scene);
    ck_assert_int_eq(contact_passage_turned(&scene.passage).elements, 1);
  }
  destroy(&scene);
}
END_TEST

START_TEST(an_element_counts_once_in_however_many_parts) {
  Scene scene;
  start_plate_and_block(&scene, 1);
  move(&scene, 1, (const double[]){0, 0, -0.3});
  ContactPassageEntry one = find_deep(&scene), next = one;
  one.is_turned = next.is_turned = true;
  next.tet++;
  load(&scene, 3, (const ContactPassageEntry[]){one, one, next});
  for (int i = 0; i < 3; i++) scene.passage.now.entries[i].covered = scene.passage.now.entries[i].reach = 1;
  ck_assert_int_eq(contact_passage_turned(&scene.passage).elements, 2);
  ck_assert_int_eq(contact_passage_inside(&scene.passage).elements, 2);
  move(&scene, 1, (const double[]){0, 0, 10});
  ck_assert_int_eq(scene.passed, 2);
  ck_assert_int_eq(scene.passage.now.count, 0);
  destroy(&scene);
}
END_TEST

// Past edges of less and of more than a right angle, in steps that meet no edge, and only then inwards.
START_TEST(what_goes_round_a_rim_has_not_passed) {
  const double depths[] = {0.01, 0.06}; // on top; the second is deep inside
  for (int k = 0; k < 2; k++) {
    Scene scene = {.shape_count = 0};
    blocks_add(&scene.blocks, &(BlockDef){.cell = {0.25, 0.25, 0.15}, .cells = {4, 4, 2}});
    for (int v = 0; v < scene.blocks.vertex_count; v++) {
      double *x = scene.blocks.x + 3 * v;
      x[0] = 0.5 + (x[0] - 0.5) * (1 + 0.5 * (x[2] - 0.15));
    }
    blocks_add(&scene.blocks,
               &(BlockDef){.corner = {0.95, 0.4, 0.31}, .cell = {0.2, 0.2, 0.2}, .cells = {1, 1, 1}});
    start(&scene);
    const double ways[][3] = {{0, 0, -0.01 - depths[k]}, {0.06, 0, -0.24 + depths[k]}, {-0.15, 0, -0.25}};
    for (int w = 0; w < 3; w++) {
      move(&scene, 1, ways[w]);
      ck_assert_int_gt(scene.passage.now.count, 0);
      if (w == 0) ck_assert_int_eq(scene.passage.now.entries[0].is_deep, k == 1);
    }
    move(&scene, 5, (const double[]){-0.3, 0, 0.1});
    ck_assert_int_eq(scene.most_turned, 0);
    move(&scene, 5, (const double[]){0, 0, -0.3});
    ck_assert_int_eq(scene.passed, 0);
    destroy(&scene);
  }
}
END_TEST

// Beyond the cells that it has met, in a step of 1.2: as long as contact's lists of 1.5 allow, not of 0.5.
START_TEST(what_slides_far_in_a_step_is_still_known) {
  for (int k = 0; k < 2; k++) {
    Scene scene = {.margin = k == 0 ? 1.5 : 0.5};
    blocks_add(&scene.blocks, &(BlockDef){.cell = {0.15, 0.15, 0.15}, .cells = {20, 8, 2}});
    blocks_add(&scene.blocks,
               &(BlockDef){.corner = {0.21, 0.27, 0.31}, .cell = {0.4, 0.4, 0.4}, .cells = {1, 1, 1}});
    start(&scene);
    move(&scene, 4, (const double[]){0, 0, -0.05});
    ck_assert_int_gt(scene.passage.now.count, 0);
    move(&scene, 1, (const double[]){1.2, 0, -0.5});
    ck_assert_int_gt(scene.passage.now.count, 0);
    ck_assert(k == 0 ? scene.most_turned > 0 : scene.most_turned == 0);
    destroy(&scene);
  }
}
END_TEST

// Turns the last block from where it rests by that angle about each axis, so that its lowest vertex comes to
// lie at `to`.
static void place(Scene *scene, double angle, const double to[3]) {
  const ContactBody *body = &scene->blocks.bodies[scene->blocks.body_count - 1];
  int lowest = body->vertex_begin;
  for (int v = body->vertex_begin; v < body->vertex_end; v++) {
    double *x = scene->blocks.x + 3 * v;
    memcpy(x, scene->rest + 3 * v, 3 * sizeof *x);
    for (int axis = 0; axis < 3; axis++) {
      double *a = &x[(axis + 1) % 3], *b = &x[(axis + 2) % 3], c = cos(angle), s = sin(angle), old = *a;
      *a = c * old - s * *b, *b = s * old + c * *b;
    }
    if (x[2] < scene->blocks.x[3 * lowest + 2]) lowest = v;
  }
  double by[3];
  vec3_store(by, vec3_sub(vec3_at(to), vec3_at(scene->blocks.x + 3 * lowest)));
  blocks_shift(&scene->blocks, scene->blocks.x, scene->blocks.body_count - 1, by);
}

// From 1e-14 of its size on a block dips into a ball with a corner, or a face: what they share has a volume
// then, but no direction and no depth that are more than rounding.
START_TEST(what_touches_by_rounding_has_no_direction) {
  Scene scene = {.shape = {.kind = CONTACT_SHAPE_BALL, .point = {0, 0, -2}, .radius = 2}, .shape_count = 1};
  blocks_add(&scene.blocks, &(BlockDef){.cell = {0.4, 0.4, 0.4}, .cells = {2, 2, 2}, .jitter = 0.1});
  start(&scene);
  int touching = 0;
  for (int i = 0; i < 400; i++) {
    place(&scene, 0.3 * (i % 9), (const double[]){0.1, 0, sqrt(4 - 0.01) - 2 - pow(10, -14 + 0.02 * i)});
    accept(&scene);
    for (int k = 0; k < scene.passage.now.count; k++) {
      const ContactPassageEntry *entry = &scene.passage.now.entries[k];
      if (!(entry->covered < 1e-9)) continue;
      touching++;
      ck_assert_double_eq(entry->reach, 0);
      ck_assert_double_eq(vec3_length(vec3_at(entry->direction)), 0);
    }
    contact_passage_destroy(&scene.passage);
  }
  ck_assert_int_gt(touching, 50);
  destroy(&scene);
}
END_TEST

// Depths of the middle below a plate of thickness t, a cube of four cells a side, and a wedge that is ten
// times as thick at one end as at the other.
static void middles_of(const Scene *scene, double *least, double *most) {
  const ContactLayout *layout = contact_system_layout(scene->system);
  double *middles;
  ck_assert_ok(contact_middle_find(&layout->mesh, layout->def.tets, layout->rest, &middles));
  *least = INFINITY, *most = 0;
  for (int cell = 0; cell < layout->mesh.cell_count; cell++)
    *least = fmin(*least, middles[cell]), *most = fmax(*most, middles[cell]);
  memory_free(middles);
}

START_TEST(the_middle_is_half_of_the_thickness_at_that_place) {
  double least, most;
  for (int layers = 1; layers <= 4; layers += 3) {
    Scene plate = {.shape_count = 0};
    blocks_add(&plate.blocks, &(BlockDef){.cell = {1, 1, 0.4 / layers}, .cells = {6, 6, layers}});
    start(&plate);
    middles_of(&plate, &least, &most);
    ck_assert_double_ge(least, 0.5 * 0.2);
    ck_assert_double_le(most, 2 * 0.2);
    destroy(&plate);
  }
  Scene cube = {.shape_count = 0};
  blocks_add(&cube.blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {4, 4, 4}});
  start(&cube);
  middles_of(&cube, &least, &most);
  ck_assert_double_ge(least, 1); // the diagonals of cells lead to the middle from some of the corners only
  ck_assert_near(most, 2, 1e-9);
  destroy(&cube);
}
END_TEST

START_TEST(the_middle_of_a_wedge_is_near_at_its_thin_end) {
  Scene wedge = {.shape_count = 0};
  double least, most;
  blocks_add(&wedge.blocks, &(BlockDef){.cell = {0.25, 0.25, 0.1}, .cells = {40, 8, 10}});
  for (int v = 0; v < wedge.blocks.vertex_count; v++) {
    double *x = wedge.blocks.x + 3 * v;
    x[2] = (x[2] - 0.5) * (0.1 + 0.09 * x[0]);
  }
  start(&wedge);
  middles_of(&wedge, &least, &most);
  ck_assert_double_lt(least, 0.1);
  ck_assert_near(most, 0.5, 0.05);
  destroy(&wedge);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("contact passage");
  tcase_add_test(cases, what_crosses_a_plate_has_passed_in_any_unit);
  tcase_add_test(cases, what_touches_lightly_is_not_followed);
  tcase_add_test(cases, what_enters_by_a_third_and_comes_back_has_not);
  tcase_add_test(cases, what_lies_between_two_layers_has_not_passed_either);
  tcase_add_test(cases, what_has_been_deep_inside_turns_however_long_it_stays_near_the_other_side);
  tcase_add_test(cases, what_jumps_through_a_thin_plate_from_a_light_touch_has_passed);
  tcase_add_test(cases, what_turns_back_to_a_light_touch_and_jumps_beyond_the_middle_is_turned);
  tcase_add_test(cases, what_a_step_cannot_carry_to_the_other_side_is_not_turned);
  tcase_add_test(cases, a_second_look_at_a_state_changes_nothing);
  tcase_add_test(cases, where_parts_become_one_what_may_turn_is_not_forgotten);
  tcase_add_test(cases, an_element_counts_once_in_however_many_parts);
  tcase_add_test(cases, what_goes_round_a_rim_has_not_passed);
  tcase_add_test(cases, what_slides_far_in_a_step_is_still_known);
  tcase_add_test(cases, what_touches_by_rounding_has_no_direction);
  tcase_add_test(cases, the_middle_is_half_of_the_thickness_at_that_place);
  tcase_add_test(cases, the_middle_of_a_wedge_is_near_at_its_thin_end);
  return suite_run("contact passage", cases, 60);
}
