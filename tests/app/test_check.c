// SPDX-License-Identifier: GPL-3.0-or-later
// What `tetlap check` says of sizes and pressures.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "folder.h"
#include "suite.h"

// What it says of a scene of tests/scenes; the caller's (free).
static char *check_scene(const char *name, const char *sets) {
  char command[1024], *text = NULL;
  size_t size = 0;
  snprintf(command, sizeof command, "%s check %s/tests/scenes/%s.yaml %s 2>&1", TETLAP_PROGRAM,
           TETLAP_SOURCE_DIR, name, sets);
  FILE *pipe = popen(command, "r"), *all = open_memstream(&text, &size);
  for (int c; (c = fgetc(pipe)) != EOF;) fputc(c, all);
  fclose(all);
  ck_assert_int_eq(pclose(pipe), 0);
  return text;
}

static void ck_says(const char *name, const char *sets, const char *words, bool says) {
  char *text = check_scene(name, sets);
  ck_assert_msg((strstr(text, words) != NULL) == says, "%s %s: %s: %s", name, sets,
                says ? "does not say" : "says", words);
  free(text);
}

START_TEST(every_body_has_its_box) {
  ck_says("patch", "", "0.1 × 0.1 × 0.05 m, from (0, 0, 0.05)\n", true);
  ck_says("patch", "--json", "\"box_max\": [", true);
}
END_TEST

// 1 MPa is E of the blocks; 1 kPa strains them by 0.1 %.
START_TEST(a_pressure_near_E_is_told_with_who_is_crushed) {
  const char *const words = "'lower' and 'upper' may press each other with up to 1e+06 Pa, 1 of the Young's";
  ck_says("patch", "", "crushed", false);
  ck_says("patch", "--set 'bodies.upper.loads[0].traction=[0, 0, -4e5]'", "crushed", false);
  ck_says("patch", "--set 'bodies.upper.loads[0].traction=[0, 0, -1e6]'", words, true);
}
END_TEST

// m g H = E V/2 of a block that falls from H: p = E where it stores that evenly.
START_TEST(a_blow_that_a_body_cannot_store_is_told) {
  const char *const fast = "--set 'bodies.block.velocity=[0, 0, -31.6]' --set effects.gravity=null";
  ck_says("drop", "", "crushed", false);
  ck_says("drop", fast, "with up to 1e+06 Pa, 1 of the Young's modulus of 'block'", true);
}
END_TEST

// A ball of R = 2.5 cm and .064 kg, E = 1 MPa, against a wall: by Hertz .52 of E in the middle at 9 m/s, .43
// at 7 m/s, where the energy evenly stored would be .28 and .22.
START_TEST(a_curved_body_presses_harder_than_a_flat_one) {
  const char *const fast = "--set 'bodies.left.velocity=[9, 0, 0]' --set 'bodies.right.velocity=[-9, 0, 0]'";
  const char *const slow = "--set 'bodies.left.velocity=[7, 0, 0]' --set 'bodies.right.velocity=[-7, 0, 0]'";
  ck_says("impact_balls", slow, "crushed", false);
  ck_says("impact_balls", fast, "crushed", true);
}
END_TEST

START_TEST(an_overlap_model_without_scale_is_told) {
  static const char *const words[] = {"tpn-published", "both=tpn-published",
                                      "fade:.1=tpn-published=" TETLAP_SOURCE_DIR
                                      "/net/weights/tpn-published.safetensors",
                                      "tpn-scene=" TETLAP_SOURCE_DIR "/net/weights/tpn-scene.safetensors"};
  for (int i = 0; i < 4; i++) {
    char sets[512];
    snprintf(sets, sizeof sets, "--set contact.overlap=%s", words[i]);
    ck_says("patch", sets, "does not scale with the size of the pair", i < 3);
  }
}
END_TEST

START_TEST(a_mesh_in_mm_among_metres_is_told) {
  ck_says("patch", "", "in mm", false);
  ck_says("patch", "--set bodies.upper.place.scale=1000",
          "'upper' is 1000 times as large as 'lower'; if the mesh of one is in mm, it needs place: {scale: "
          "0.001}",
          true);
}
END_TEST

// Nothing else is there to compare with; in tonnes and mm a density is far below 1.
START_TEST(a_scene_in_mm_is_told) {
  const char *const huge = "--set bodies.lower.place.scale=1000 --set bodies.upper.place.scale=1000";
  char tonnes[512];
  snprintf(tonnes, sizeof tonnes,
           "%s --set bodies.lower.material.density=1e-9 --set bodies.upper.material.density=1e-9", huge);
  ck_says("patch", huge,
          " m long, and lengths are in m; if its mesh is in mm, it needs place: {scale: 0.001}", true);
  ck_says("patch", tonnes, "in mm", false);
}
END_TEST

// Blocks of 5 cm: of 11 points 1 cm apart, and of 21, those from z = 0 to 5 cm are in the lower one.
START_TEST(lines_are_told_with_how_many_points_they_have) {
  const char *const lines =
      "--set 'bodies.lower.lines=[{name: up, from: [0.05, 0.05, 0], to: [0.05, 0.05, 0.1], "
      "points: 11}, {name: past, from: [0.02, 0.02, 0], to: [0.02, 0.02, 0.2], points: 21}]'";
  char json[512];
  snprintf(json, sizeof json, "%s --json", lines);
  ck_says("patch", "", "line '", false);
  ck_says("patch", lines, "line 'up': 6 of 11 points in the body\n", true);
  ck_says("patch", lines, "line 'past': 6 of 21 points in the body\n", true);
  ck_says("patch", lines, "note: line 'past' has 6 of its 21 points in the body", true);
  ck_says("patch", lines, "note: line 'up'", false);
  ck_says("patch", json, "\"points_in_body\": 6", true);
}
END_TEST

// Two tetrahedra on one face, each with vertices of its own.
START_TEST(a_mesh_that_is_open_is_told) {
  static const char mesh[] = "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n"
                             "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
                             "Tetrahedra\n2\n1 2 3 4 0\n5 6 7 8 0\nEnd\n";
  char path[96], sets[256];
  FileWriter writer;
  folder_make();
  snprintf(path, sizeof path, "%s/seam.mesh", folder);
  ck_assert_ok(file_begin(&writer, path));
  fputs(mesh, writer.stream);
  ck_assert_ok(file_commit(&writer));
  snprintf(sets, sizeof sets, "--set bodies.block.mesh=%s", path);
  ck_says("drop", "", "exactly on another", false);
  ck_says("drop", sets, "note: 'block' has 3 vertices that lie exactly on another", true);
  folder_remove();
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("check");
  tcase_add_test(cases, every_body_has_its_box);
  tcase_add_test(cases, a_pressure_near_E_is_told_with_who_is_crushed);
  tcase_add_test(cases, a_blow_that_a_body_cannot_store_is_told);
  tcase_add_test(cases, a_curved_body_presses_harder_than_a_flat_one);
  tcase_add_test(cases, an_overlap_model_without_scale_is_told);
  tcase_add_test(cases, a_mesh_in_mm_among_metres_is_told);
  tcase_add_test(cases, a_scene_in_mm_is_told);
  tcase_add_test(cases, lines_are_told_with_how_many_points_they_have);
  tcase_add_test(cases, a_mesh_that_is_open_is_told);
  return suite_run("check", cases, 30);
}
