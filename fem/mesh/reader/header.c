// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/header.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"

enum { VTK_TETRAHEDRON = 10, VTK_QUADRATIC_TETRAHEDRON = 24 };

Status fem_mesh_header_format(const char *path, FemMeshFormat *format) {
  static const struct {
    const char *ending;
    FemMeshFormat format;
  } endings[] = {
      {".msh", FEM_MESH_FORMAT_MSH},    {".mesh", FEM_MESH_FORMAT_MEDIT}, {".vtk", FEM_MESH_FORMAT_VTK},
      {".stl", FEM_MESH_FORMAT_STL},    {".geo", FEM_MESH_FORMAT_GEO},    {".node", FEM_MESH_FORMAT_TETGEN},
      {".ele", FEM_MESH_FORMAT_TETGEN},
  };
  static const char foreign[] =
      ".vtu .inp .xdmf .xmf .bdf .nas .fem .exo .e .med .unv .cgns .h5m "
      ".ugrid .su2 .xml .avs .key .k .dat .cdb";
  const char *name = strrchr(path, '/'), *dot = strrchr(name ? name : path, '.');
  for (size_t k = 0; dot && k < sizeof endings / sizeof *endings; k++)
    if (strcasecmp(dot, endings[k].ending) == 0) {
      *format = endings[k].format;
      return STATUS_OK;
    }
  if (dot && text_lists(foreign, dot))
    return status_fail(
        STATUS_INPUT,
        "%s: %s files are not read; `meshio convert %s mesh.msh` (python3-meshio) makes a gmsh "
        "mesh of it, or let the program that wrote it export .msh",
        path, dot, path);
  return status_fail(STATUS_INPUT,
                     "%s: the ending %s is not known; give a .msh (gmsh), .mesh (MEDIT, ascii), .vtk "
                     "(legacy), .node or .ele "
                     "(TetGen), or a surface to be meshed: .stl, .geo",
                     path, dot ? dot : "is missing and so the format");
}

static bool begins_with(const char *text, const char *word) {
  return strncasecmp(text, word, strlen(word)) == 0;
}

static const char *skip_space(const char *at) {
  while (isspace((unsigned char)*at)) at++;
  return at;
}

static Status check_msh(const char *text) {
  if (begins_with(skip_space(text), "$")) return STATUS_OK;
  return status_fail(STATUS_INPUT, "does not begin with $MeshFormat and so is no gmsh mesh; export it again");
}

// The kinds of volume elements that MEDIT knows and we do not.
static Status refuse_medit_kind(const char *word, size_t length, long long count) {
  static const char *const kinds[] = {"Hexahedra",    "Prisms",      "Pentahedra", "Pyramids",
                                      "TetrahedraP3", "HexahedraQ2", "PrismsP2",   "PyramidsP2"};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    if (count > 0 && length == strlen(kinds[k]) && strncasecmp(word, kinds[k], length) == 0)
      return status_fail(STATUS_INPUT,
                         "has %lld %s; only tetrahedra of 4 or 10 nodes are known: mesh it anew with those",
                         count, kinds[k]);
  return STATUS_OK;
}

static const char *skip_word(const char *at) {
  while (*at && !isspace((unsigned char)*at)) at++;
  return at;
}

// How many numbers follow until something else does; `*end` is left there.
static long long count_numbers(const char *at, const char **end) {
  for (long long count = 0;; count++) {
    at = skip_space(at);
    char *after;
    (void)strtod(at, &after);
    if (after == at || (*after && !isspace((unsigned char)*after))) {
      *end = at;
      return count;
    }
    at = after;
  }
}

// A MEDIT word, its count, and so many items of `size` numbers. gmsh makes up what is missing at the end.
typedef struct MeditWord {
  const char *name;
  int size;
  bool are_tets;
} MeditWord;

static Status check_medit_items(const MeditWord *word, long long count, long long number_count) {
  if (count >= 0 && number_count % word->size == 0 && number_count / word->size == count) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "announces %lld %s, but %lld numbers follow instead of %d for each; is it complete?",
                     count, word->name, number_count, word->size);
}

// MEDIT: words, each followed by a count and so many lines (Frey 2001, "MEDIT: an interactive mesh
// visualization software", INRIA RT-0253).
static Status check_medit(const char *text, long long *tet_count) {
  static const MeditWord words[] = {
      {"Vertices", 4, false}, {"Tetrahedra", 5, true}, {"TetrahedraP2", 11, true}};
  const char *at = skip_space(text);
  if (!begins_with(at, "MeshVersionFormatted"))
    return status_fail(STATUS_INPUT,
                       "does not begin with MeshVersionFormatted and so is no ascii MEDIT mesh; export it "
                       "again as .mesh or .msh");
  *tet_count = 0;
  while (*(at = skip_space(at))) {
    const char *word = at;
    at = *word == '#' ? word + strcspn(word, "\n") : skip_word(word);
    if (!isalpha((unsigned char)*word)) continue;
    size_t length = (size_t)(at - word);
    char *after;
    long long count = strtoll(at, &after, 10);
    TRY(refuse_medit_kind(word, length, count));
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
      if (length == strlen(words[k].name) && begins_with(word, words[k].name)) {
        TRY(check_medit_items(&words[k], count, count_numbers(after, &at)));
        if (words[k].are_tets) *tet_count += count;
      }
  }
  return STATUS_OK;
}

// The line of a VTK file that begins with `word`, also within a binary file; NULL: none.
static const char *find_line(const char *text, size_t size, const char *word) {
  size_t length = strlen(word);
  for (const char *at = text, *end = text + size; at && at < end; at = memchr(at, '\n', (size_t)(end - at))) {
    if (*at == '\n') at++;
    if ((size_t)(end - at) > length && memcmp(at, word, length) == 0 && isspace((unsigned char)at[length]))
      return at + length;
    if (at == end) break;
  }
  return NULL;
}

// The type of cell k of an ascii or binary (big-endian int) list.
static long vtk_type(const char **at, const char *end, bool is_binary) {
  if (!is_binary) {
    char *next;
    long type = strtol(*at, &next, 10);
    if (next == *at) return -1;
    *at = next;
    return type;
  }
  if (end - *at < 4) return -1;
  const unsigned char *b = (const unsigned char *)*at;
  *at += 4;
  return (long)b[0] << 24 | (long)b[1] << 16 | (long)b[2] << 8 | (long)b[3];
}

static const char *vtk_type_name(long type) {
  switch (type) {
  case 11:
    return "voxel";
  case 12:
    return "hexahedron";
  case 13:
    return "wedge";
  case 14:
    return "pyramid";
  case 25:
    return "quadratic hexahedron";
  case 26:
    return "quadratic wedge";
  case 27:
    return "quadratic pyramid";
  default:
    return "volume cell";
  }
}

static Status count_vtk_types(const char *at, const char *end, bool is_binary, long long *tet_count) {
  char *list;
  long long count = strtoll(at, &list, 10);
  at = list + strcspn(list, "\n");
  if (*at == '\n') at++;
  for (long long k = 0; k < count; k++) {
    long type = vtk_type(&at, end, is_binary);
    if (type < 0)
      return status_fail(STATUS_INPUT,
                         "ends after %lld of the %lld cell types that it announces; is it complete?", k,
                         count);
    bool is_tet = type == VTK_TETRAHEDRON || type == VTK_QUADRATIC_TETRAHEDRON;
    *tet_count += is_tet;
    // The others are points, lines and faces, which may mark the boundary.
    bool is_volume = (type >= 11 && type <= 16) || (type >= 24 && type <= 27) || type == 29 ||
                     (type >= 31 && type <= 33) || type == 37 || type >= 41;
    if (is_volume && !is_tet)
      return status_fail(
          STATUS_INPUT,
          "cell %lld is a %s (VTK type %ld); only tetrahedra (types 10 and 24) are known: mesh "
          "it anew with those",
          k, vtk_type_name(type), type);
  }
  return STATUS_OK;
}

// An item of `bytes` at least: what a count beyond the file's size says is not true, and gmsh would allocate
// it.
static Status check_announced(const char *what, long long count, size_t bytes, size_t size) {
  if (count >= 0 && (unsigned long long)count <= size / bytes) return STATUS_OK;
  return status_fail(STATUS_INPUT, "announces %lld %s in a file of %zu bytes; is it complete?", count, what,
                     size);
}

// Legacy VTK (Kitware, "VTK File Formats"), up to version 4.2.
static Status check_vtk(const char *text, size_t size, long long *tet_count) {
  if (!begins_with(text, "# vtk DataFile Version"))
    return status_fail(STATUS_INPUT,
                       "does not begin with '# vtk DataFile Version' and so is no legacy VTK file");
  if (strtod(text + strlen("# vtk DataFile Version"), NULL) >= 5)
    return status_fail(
        STATUS_INPUT,
        "is of VTK version 5, which meshio and ParaView write; `meshio convert FILE.vtk mesh.msh` "
        "(python3-meshio) makes a gmsh mesh of it, or save it as version 4.2 or lower");
  if (!find_line(text, size, "DATASET UNSTRUCTURED_GRID"))
    return status_fail(STATUS_INPUT, "is no 'DATASET UNSTRUCTURED_GRID'; save its tetrahedra as one");
  *tet_count = 0;
  const char *points = find_line(text, size, "POINTS"), *cells = find_line(text, size, "CELLS");
  if (points) TRY(check_announced("points", strtoll(points, NULL, 10), 6, size));
  if (cells) TRY(check_announced("cells", strtoll(cells, NULL, 10), 4, size));
  const char *types = find_line(text, size, "CELL_TYPES");
  if (!types) return status_fail(STATUS_INPUT, "has no CELL_TYPES; is it complete?");
  return count_vtk_types(types, text + size, find_line(text, size, "BINARY") != NULL, tet_count);
}

static Status check_text(const char *text, size_t size, FemMeshFormat format, long long *tet_count) {
  if (*skip_space(text) == 0 && format != FEM_MESH_FORMAT_STL)
    return status_fail(STATUS_INPUT, "is empty; export it again");
  switch (format) {
  case FEM_MESH_FORMAT_MSH:
    return check_msh(text);
  case FEM_MESH_FORMAT_MEDIT:
    return check_medit(text, tet_count);
  case FEM_MESH_FORMAT_VTK:
    return check_vtk(text, size, tet_count);
  case FEM_MESH_FORMAT_STL:
    return size ? STATUS_OK : status_fail(STATUS_INPUT, "is empty; export it again");
  case FEM_MESH_FORMAT_GEO:
  case FEM_MESH_FORMAT_TETGEN:
    break;
  }
  return STATUS_OK;
}

Status fem_mesh_header_check(const char *path, FemMeshFormat format, FemMeshHeader *header) {
  char *text;
  size_t size;
  *header = (FemMeshHeader){.tet_count = -1};
  TRY(file_read(path, &text, &size));
  header->size = size;
  Status status = check_text(text, size, format, &header->tet_count);
  memory_free(text);
  return status == STATUS_OK ? STATUS_OK : status_prefix(status, "%s", path);
}
