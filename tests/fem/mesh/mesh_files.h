// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of reading meshes share: files in a folder of their own, refusals with their words.
#pragma once

#include "suite.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fem/mesh/mesh.h"

#define DATA TETLAP_SOURCE_DIR "/tests/data/mesh/"
#define MESHES TETLAP_SOURCE_DIR "/meshes/"

// One tetrahedron, a vertex that nobody uses, and room for a second element.
#define MSH_NODES                                                                                            \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n11 0 0 0\n12 1 0 0\n13 0 1 0\n14 0 0 1\n15 0 0 -1\n16 "  \
  "5 5 5\n$EndNodes\n"
#define MSH_ELEMENTS(count, lines) "$Elements\n" #count "\n" lines "$EndElements\n"

// The same tetrahedron for TetGen.
#define NODES "# nodes\n4 3 1 0\n0 0 0 0 .5\n1 1 0 0 .5 # second\n\n2 0 1 0 .5\n3 0 0 1 .5\n"

// A facet of an STL file, and corners for it.
#define FACET(a, b, c)                                                                                       \
  "facet normal 0 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define O "0 0 0"
#define X "1 0 0"
#define Y "0 1 0"
#define Z "0 0 1"

static char directory[64];

// A file in the test's own directory, overwritten by the next of the same name; of the paths the last four
// last.
static inline char *scratch(const char *name) {
  static char paths[4][160];
  static int next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", directory, name);
  return path;
}

static inline char *put_bytes(const char *name, const void *bytes, size_t size) {
  char *path = scratch(name);
  FILE *stream = fopen(path, "wb");
  ck_assert_ptr_nonnull(stream);
  ck_assert_uint_eq(fwrite(bytes, 1, size, stream), size);
  fclose(stream);
  return path;
}

static inline char *put(const char *name, const char *text) {
  return put_bytes(name, text, strlen(text));
}

static inline void make_directory(void) {
  snprintf(directory, sizeof directory, "/tmp/tetlap_mesh_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static inline void remove_directory(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", directory);
  ck_assert_int_eq(system(command), 0);
}

// The file must be refused with a message that begins with its name and holds all the words given.
static inline void expect_refusal(Status code, const char *path, ...) {
  FemMesh mesh;
  Status status = fem_mesh_read(&mesh, path, NULL, NULL);
  ck_assert_msg(status == code, "%s: %d instead of %d: %s", path, (int)status, (int)code, status_message());
  ck_assert_msg(strncmp(status_message(), path, strlen(path)) == 0, "'%s' does not begin with the file",
                status_message());
  va_list words;
  va_start(words, path);
  for (const char *word; (word = va_arg(words, const char *));)
    ck_assert_msg(strstr(status_message(), word) != NULL, "'%s' lacks '%s'", status_message(), word);
  va_end(words);
  ck_assert_ptr_null(mesh.rest);
}

static inline const FemMeshGroup *group_of(const FemMesh *mesh, const char *name) {
  for (int g = 0; g < mesh->group_count; g++)
    if (strcmp(mesh->groups[g].name, name) == 0) return &mesh->groups[g];
  ck_abort_msg("there is no group '%s'", name);
  return NULL;
}

// All vertices of the group have that coordinate, and there are as many as the mesh has there.
static inline void expect_plane(const FemMesh *mesh, const char *name, int component, double value) {
  const FemMeshGroup *group = group_of(mesh, name);
  int count = 0;
  for (int v = 0; v < mesh->vertex_count; v++) count += fabs(mesh->rest[3 * v + component] - value) < 1e-12;
  ck_assert_int_gt(count, 3);
  ck_assert_int_eq(group->vertex_count, count);
  for (int k = 0; k < count; k++)
    ck_assert_near(mesh->rest[3 * group->vertices[k] + component], value, 1e-12);
}
