// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/tetgen.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

// TetGen's order of the nodes on edges: 23, 03, 01, 12, 13, 02, as numbers of fem_quadratic_edges; what
// TetGen 1.5 writes with -o2.
static const int edge_order[6] = {5, 2, 0, 3, 4, 1};

// A text file walked number by number; the line is kept for messages.
typedef struct Reader {
  const char *path; // borrowed
  char *text;
  char *at;
  int line; // of `at`, from 1
} Reader;

static Status fail(const Reader *reader, const char *expected) {
  int length = 0;
  while (reader->at[length] && !isspace((unsigned char)reader->at[length]) && length < 40) length++;
  if (length == 0)
    return status_fail(STATUS_INPUT,
                       "%s:%d: %s expected here, but the line or the file ends; is the file complete?",
                       reader->path, reader->line, expected);
  return status_fail(STATUS_INPUT, "%s:%d: %s expected, not '%.*s'", reader->path, reader->line, expected,
                     length, reader->at);
}

static void skip_blanks(Reader *reader) {
  while (*reader->at == ' ' || *reader->at == '\t' || *reader->at == '\r') reader->at++;
  if (*reader->at == '#') reader->at += strcspn(reader->at, "\n");
}

// To the next line that holds something, or the end.
static void next_line(Reader *reader) {
  reader->at += strcspn(reader->at, "\n");
  while (*reader->at == '\n') {
    reader->at++, reader->line++;
    skip_blanks(reader);
  }
}

// A value must end where a space, a comment or the line does.
static bool ends_word(const char *end, const char *begin) {
  return end != begin && (*end == 0 || *end == '#' || isspace((unsigned char)*end));
}

static Status read_integer(Reader *reader, const char *what, long long low, long long high,
                           long long *value) {
  skip_blanks(reader);
  char *end = reader->at;
  errno = 0;
  if (*end != '\n') *value = strtoll(reader->at, &end, 10);
  if (!ends_word(end, reader->at) || errno) return fail(reader, what);
  if (low == high && *value != low)
    return status_fail(STATUS_INPUT, "%s:%d: %s is %lld; it must be %lld here", reader->path, reader->line,
                       what, *value, low);
  if (*value < low || *value > high)
    return status_fail(STATUS_INPUT, "%s:%d: %s is %lld; it must lie in %lld … %lld", reader->path,
                       reader->line, what, *value, low, high);
  reader->at = end;
  return STATUS_OK;
}

static Status read_real(Reader *reader, const char *what, double *value) {
  skip_blanks(reader);
  char *end = reader->at;
  if (*end != '\n') *value = strtod(reader->at, &end);
  if (!ends_word(end, reader->at)) return fail(reader, what);
  reader->at = end;
  return STATUS_OK;
}

static Status open_reader(Reader *reader, const char *path) {
  *reader = (Reader){.path = path, .line = 1};
  size_t size;
  TRY(file_read(path, &reader->text, &size));
  reader->at = reader->text;
  skip_blanks(reader);
  if (*reader->at == '\n') next_line(reader);
  return STATUS_OK;
}

// A line of n numbers takes 2n characters at least, so a count beyond that is a lie, found before it is
// allocated for.
static Status check_room(const Reader *reader, const char *what, long long count, size_t number_count) {
  size_t rest = strlen(reader->at);
  if ((size_t)count <= rest / (2 * number_count) + 1) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "%s:%d: %lld %s are announced, but only %zu more characters follow; is it complete?",
                     reader->path, reader->line, count, what, rest);
}

// What the first line of a .node file says beyond the count.
typedef struct NodeHead {
  long long attribute_count;
  bool has_markers;
} NodeHead;

static Status read_node_head(Reader *reader, FemMeshSource *source, NodeHead *head) {
  long long count = 0, dimension = 3, marker_count = 0;
  TRY(read_integer(reader, "the number of nodes", 1, FEM_MESH_MAX_VERTICES, &count));
  TRY(read_integer(reader, "the dimension", 3, 3, &dimension));
  TRY(read_integer(reader, "the number of attributes", 0, 1000, &head->attribute_count));
  TRY(read_integer(reader, "the number of boundary markers", 0, 1, &marker_count));
  TRY(check_room(reader, "nodes", count, 4));
  head->has_markers = marker_count > 0;
  source->vertex_count = (int)count;
  source->positions = memory_zeroed((size_t)source->vertex_count, sizeof(double[3]));
  source->vertex_tags = memory_zeroed((size_t)source->vertex_count, sizeof *source->vertex_tags);
  if (!source->positions || !source->vertex_tags) return status_no_memory("the nodes of a mesh");
  return STATUS_OK;
}

static Status read_node(Reader *reader, FemMeshSource *source, const NodeHead *head, int v, int *marker) {
  long long number = 0, value = 0;
  double attribute;
  next_line(reader);
  // The first node's number decides whether the file counts from 0 or from 1.
  long long expected = v + source->vertex_tags[0];
  TRY(read_integer(reader, "the number of a node", v ? expected : 0, v ? expected : 1, &number));
  source->vertex_tags[v] = number;
  for (int c = 0; c < 3; c++)
    TRY(read_real(reader, "a coordinate", &source->positions[3 * (size_t)v + (size_t)c]));
  for (long long k = 0; k < head->attribute_count; k++) TRY(read_real(reader, "an attribute", &attribute));
  if (head->has_markers) TRY(read_integer(reader, "a boundary marker", INT_MIN, INT_MAX, &value));
  *marker = (int)value;
  return STATUS_OK;
}

// A vertex and its boundary marker.
typedef struct Mark {
  int marker, vertex;
} Mark;

static int compare_marks(const void *left, const void *right) {
  const Mark *a = left, *b = right;
  if (a->marker != b->marker) return a->marker < b->marker ? -1 : 1;
  return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

static Status fill_group(FemMeshGroup *group, const Mark *marks, int count) {
  char name[32];
  int length = snprintf(name, sizeof name, "marker_%d", marks->marker);
  group->name = memory_copy(name, (size_t)length + 1, 1);
  group->vertices = memory_zeroed((size_t)count, sizeof(int));
  if (!group->name || !group->vertices) return status_no_memory("the groups of a mesh");
  for (int k = 0; k < count; k++) group->vertices[k] = marks[k].vertex;
  group->vertex_count = count;
  return STATUS_OK;
}

// A group for each run of equal markers, 0 (none) left out.
static Status group_marks(FemMeshSource *source, Mark *marks) {
  int count = source->vertex_count, run_count = 0;
  qsort(marks, (size_t)count, sizeof *marks, compare_marks);
  for (int k = 0; k < count; k++) run_count += k == 0 || marks[k].marker != marks[k - 1].marker;
  source->groups = memory_zeroed((size_t)run_count, sizeof *source->groups);
  if (!source->groups) return status_no_memory("the groups of a mesh");
  for (int begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && marks[end].marker == marks[begin].marker;) end++;
    if (marks[begin].marker)
      TRY(fill_group(&source->groups[source->group_count++], marks + begin, end - begin));
  }
  return STATUS_OK;
}

static Status read_nodes(Reader *reader, FemMeshSource *source) {
  NodeHead head = {0};
  TRY(read_node_head(reader, source, &head));
  Mark *marks = memory_zeroed((size_t)source->vertex_count, sizeof *marks);
  if (!marks) return status_no_memory("the markers of a mesh");
  Status status = STATUS_OK;
  for (int v = 0; v < source->vertex_count && status == STATUS_OK; v++) {
    marks[v].vertex = v;
    status = read_node(reader, source, &head, v, &marks[v].marker);
  }
  if (status == STATUS_OK) status = group_marks(source, marks);
  memory_free(marks);
  return status;
}

// The first line of an .ele file, and room for what it announces.
static Status read_tet_head(Reader *reader, FemMeshSource *source, long long *attribute_count) {
  long long count = 0, node_count = 4;
  TRY(read_integer(reader, "the number of tetrahedra", 1, FEM_MESH_MAX_TETS, &count));
  TRY(read_integer(reader, "the number of nodes of a tetrahedron", 4, 10, &node_count));
  if (node_count != 4 && node_count != 10)
    return status_fail(STATUS_INPUT, "%s:%d: tetrahedra of %lld nodes; only those of 4 or 10 nodes are known",
                       reader->path, reader->line, node_count);
  TRY(read_integer(reader, "the number of attributes", 0, 1000, attribute_count));
  TRY(check_room(reader, "tetrahedra", count, (size_t)node_count + 1));
  source->tet_count = (int)count;
  source->tets = memory_zeroed((size_t)count, sizeof *source->tets);
  source->tet_tags = memory_zeroed((size_t)count, sizeof *source->tet_tags);
  if (node_count == 10) source->middles = memory_zeroed((size_t)count, sizeof *source->middles);
  bool is_ok = source->tets && source->tet_tags && (node_count == 4 || source->middles);
  return is_ok ? STATUS_OK : status_no_memory("the tetrahedra of a mesh");
}

static Status read_tets(Reader *reader, FemMeshSource *source) {
  long long attribute_count = 0, value = 0, base = source->vertex_tags[0];
  double attribute;
  TRY(read_tet_head(reader, source, &attribute_count));
  for (int t = 0; t < source->tet_count; t++) {
    next_line(reader);
    TRY(read_integer(reader, "the number of a tetrahedron", t + base, t + base, &source->tet_tags[t]));
    for (int k = 0; k < (source->middles ? 10 : 4); k++) {
      TRY(read_integer(reader, "the number of a node", base, base + source->vertex_count - 1, &value));
      int *node = k < 4 ? &source->tets[t][k] : &source->middles[t][edge_order[k - 4]];
      *node = (int)(value - base);
    }
    for (long long k = 0; k < attribute_count; k++) TRY(read_real(reader, "an attribute", &attribute));
  }
  return STATUS_OK;
}

static Status read_node_file(const char *path, FemMeshSource *source) {
  Reader reader;
  TRY(open_reader(&reader, path));
  Status status = read_nodes(&reader, source);
  memory_free(reader.text);
  return status;
}

static Status read_ele_file(const char *path, FemMeshSource *source) {
  Reader reader;
  TRY(open_reader(&reader, path));
  Status status = read_tets(&reader, source);
  memory_free(reader.text);
  return status;
}

// `path` with that ending, in capitals where its own is. NULL: no memory.
static char *with_ending(const char *path, const char *ending) {
  const char *dot = strrchr(path, '.');
  size_t stem = (size_t)(dot - path), size = stem + strlen(ending) + 1;
  char *name = memory_zeroed(size, 1);
  if (!name) return NULL;
  memcpy(name, path, stem);
  for (size_t k = 0; ending[k]; k++)
    name[stem + k] = (char)(isupper((unsigned char)dot[1]) ? toupper((unsigned char)ending[k]) : ending[k]);
  return name;
}

Status fem_mesh_tetgen_read(FemMeshSource *source, const char *path) {
  *source = (FemMeshSource){0};
  char *node_path = with_ending(path, ".node"), *ele_path = with_ending(path, ".ele");
  Status status = node_path && ele_path ? STATUS_OK : status_no_memory("a file name");
  if (status == STATUS_OK) status = read_node_file(node_path, source);
  if (status == STATUS_OK) status = read_ele_file(ele_path, source);
  memory_free(node_path), memory_free(ele_path);
  if (status != STATUS_OK) fem_mesh_source_destroy(source);
  return status;
}
