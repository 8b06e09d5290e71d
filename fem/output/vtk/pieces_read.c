// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/pieces_read.h"

#include <math.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "fem/output/vtk/pieces.h"

enum { MAX_PIECES = 1 << 16, MAX_COUNT = 1 << 28 };

static Status refuse(const char *what) {
  return status_fail(STATUS_INPUT, "%s; expected a list of pieces that `tetlap run` wrote", what);
}

// The whole as it grows: pieces come in turn, so that two are never held.
typedef struct Whole {
  FemVtuContent *content;
  double vertices, cells;               // in it, by the largest number of any piece
  double piece_vertices, piece_cells;   // in the pieces, which is no less
  unsigned char *has_vertex, *has_cell; // a piece that has it has come
} Whole;

static const FemVtuField *find_numbers(const FemVtuContent *piece, const char *name, bool is_cell) {
  for (int k = 0; k < piece->field_count; k++) {
    const FemVtuField *field = &piece->fields[k];
    if (field->is_cell == is_cell && field->is_integer && field->components == 1 &&
        strcmp(field->name, name) == 0)
      return field;
  }
  return NULL;
}

static bool is_number(const FemVtuField *field) {
  return strcmp(field->name, field->is_cell ? FEM_VTU_ELEMENT : FEM_VTU_VERTEX) == 0;
}

// Fields of the whole as the first piece has them, but its numbers.
static Status lay_out(Whole *whole, const FemVtuContent *piece) {
  FemVtuContent *content = whole->content;
  size_t vertices = (size_t)content->vertex_count, cells = (size_t)content->cell_count;
  size_t corners = (size_t)fem_vtu_corner_count(piece->cell);
  content->time = piece->time, content->cell = piece->cell;
  content->positions = memory_zeroed(vertices, 3 * sizeof *content->positions);
  content->cells = memory_zeroed(cells, corners * sizeof *content->cells);
  whole->has_vertex = memory_zeroed(vertices, 1);
  whole->has_cell = memory_zeroed(cells, 1);
  if (!content->positions || !content->cells || !whole->has_vertex || !whole->has_cell)
    return status_no_memory("a frame");
  for (int k = 0; k < piece->field_count; k++) {
    if (is_number(&piece->fields[k])) continue;
    FemVtuField *field = &content->fields[content->field_count++];
    *field = piece->fields[k];
    field->values =
        memory_zeroed(field->is_cell ? cells : vertices, (size_t)field->components * sizeof(double));
    if (!field->values) return status_no_memory("an array of a frame");
  }
  return STATUS_OK;
}

static Status take_fields(Whole *whole, const FemVtuContent *piece, const double *vertices,
                          const double *cells) {
  FemVtuContent *content = whole->content;
  int taken = 0;
  for (int k = 0; k < piece->field_count; k++) {
    const FemVtuField *from = &piece->fields[k];
    if (is_number(from)) continue;
    FemVtuField *to = taken < content->field_count ? &content->fields[taken++] : NULL;
    if (!to || strcmp(to->name, from->name) != 0 || to->is_cell != from->is_cell ||
        to->components != from->components)
      return refuse("the pieces have not the same arrays");
    size_t size = (size_t)to->components;
    int count = from->is_cell ? piece->cell_count : piece->vertex_count;
    for (int i = 0; i < count; i++)
      memcpy(to->values + size * (size_t)(from->is_cell ? cells[i] : vertices[i]),
             from->values + size * (size_t)i, size * sizeof *to->values);
  }
  return taken == content->field_count ? STATUS_OK : refuse("the pieces have not the same arrays");
}

// Every number below `count`; those of cells once in all pieces.
static bool mark(const double *numbers, int count, int limit, bool is_once, unsigned char *has) {
  for (int i = 0; i < count; i++) {
    if (!(numbers[i] >= 0 && numbers[i] < limit)) return false;
    if (is_once && has[(int)numbers[i]]) return false;
    has[(int)numbers[i]] = 1;
  }
  return true;
}

static Status take_piece(Whole *whole, const FemVtuContent *piece) {
  FemVtuContent *content = whole->content;
  const FemVtuField *vertices = find_numbers(piece, FEM_VTU_VERTEX, false),
                    *cells = find_numbers(piece, FEM_VTU_ELEMENT, true);
  int corners = fem_vtu_corner_count(piece->cell);
  if (!content->positions) TRY(lay_out(whole, piece));
  if (!vertices || !cells || piece->cell != content->cell ||
      !mark(vertices->values, piece->vertex_count, content->vertex_count, false, whole->has_vertex) ||
      !mark(cells->values, piece->cell_count, content->cell_count, true, whole->has_cell))
    return refuse("the pieces are not of one frame");
  for (int i = 0; i < piece->vertex_count; i++)
    memcpy(content->positions + 3 * (size_t)vertices->values[i], piece->positions + 3 * (size_t)i,
           3 * sizeof(double));
  for (int i = 0; i < piece->cell_count; i++)
    for (int c = 0; c < corners; c++)
      content->cells[corners * (int)cells->values[i] + c] =
          (int)vertices->values[piece->cells[corners * i + c]];
  return take_fields(whole, piece, vertices->values, cells->values);
}

static double largest(const FemVtuField *numbers, int count) {
  double most = -1;
  for (int i = 0; numbers && i < count; i++) most = fmax(most, numbers->values[i]);
  return most;
}

typedef struct Sources {
  int count;
  char **paths; // (count)
} Sources;

static Status each_piece(const Sources *sources, Status (*take)(Whole *, const FemVtuContent *),
                         Whole *whole) {
  Status status = STATUS_OK;
  for (int k = 0; k < sources->count && !status; k++) {
    FemVtuContent piece;
    TRY(fem_vtu_read(sources->paths[k], &piece));
    status = take(whole, &piece);
    fem_vtu_read_destroy(&piece);
  }
  return status;
}

// How many vertices and cells there are follows from the numbers.
static Status count_piece(Whole *whole, const FemVtuContent *piece) {
  whole->vertices =
      fmax(whole->vertices, largest(find_numbers(piece, FEM_VTU_VERTEX, false), piece->vertex_count) + 1);
  whole->cells =
      fmax(whole->cells, largest(find_numbers(piece, FEM_VTU_ELEMENT, true), piece->cell_count) + 1);
  whole->piece_vertices += piece->vertex_count, whole->piece_cells += piece->cell_count;
  return STATUS_OK;
}

static bool are_all(const unsigned char *has, int count) {
  return count == 0 || !memchr(has, 0, (size_t)count);
}

static Status join(const Sources *sources, FemVtuContent *content) {
  Whole whole = {.content = content};
  TRY(each_piece(sources, count_piece, &whole));
  if (whole.vertices > fmin(whole.piece_vertices, MAX_COUNT) ||
      whole.cells > fmin(whole.piece_cells, MAX_COUNT))
    return refuse("vertices or elements are in none of the pieces");
  content->vertex_count = (int)whole.vertices, content->cell_count = (int)whole.cells;
  Status status = each_piece(sources, take_piece, &whole);
  if (!status &&
      (!are_all(whole.has_vertex, content->vertex_count) || !are_all(whole.has_cell, content->cell_count)))
    status = refuse("vertices or elements are in none of the pieces");
  memory_free(whole.has_vertex), memory_free(whole.has_cell);
  if (status) fem_vtu_read_destroy(content);
  return status;
}

static Status add_source(Sources *sources, const char *begin, const char *folder) {
  size_t length = strcspn(begin, "\"");
  char *name = memory_zeroed(length + 1, 1);
  if (!name) return status_no_memory("a file name");
  memcpy(name, begin, length);
  // A piece lies beside its list, and is none itself.
  bool is_beside = !strchr(name, '/') && text_ends_in(name, ".vtu");
  char *path = is_beside ? file_join(folder, name) : NULL;
  memory_free(name);
  if (!is_beside) return refuse("a piece is no .vtu file beside the list");
  if (!path) return status_no_memory("a file name");
  sources->paths[sources->count++] = path;
  return STATUS_OK;
}

static Status list_sources(const char *text, const char *folder, Sources *sources) {
  static const char TAG[] = "<Piece Source=\"";
  int count = 0;
  for (const char *tag = text; (tag = strstr(tag, TAG)); tag++) count++;
  if (!strstr(text, "type=\"PUnstructuredGrid\"") || count == 0 || count > MAX_PIECES)
    return refuse("is not a VTK file of pieces");
  sources->paths = memory_zeroed((size_t)count, sizeof *sources->paths);
  if (!sources->paths) return status_no_memory("the pieces of a frame");
  for (const char *tag = text; (tag = strstr(tag, TAG)); tag++)
    TRY(add_source(sources, tag + strlen(TAG), folder));
  return STATUS_OK;
}

static Status read_list(const char *path, FemVtuContent *content) {
  Sources sources = {0};
  char *text = NULL, *folder = file_directory_of(path);
  size_t size;
  *content = (FemVtuContent){0};
  Status status = folder ? file_read(path, &text, &size) : status_no_memory("a file name");
  bool is_read = status == STATUS_OK;
  if (!status) status = list_sources(text, folder, &sources);
  if (!status) status = join(&sources, content);
  for (int k = 0; k < sources.count; k++) memory_free(sources.paths[k]);
  memory_free(sources.paths);
  memory_free(text), memory_free(folder);
  return status && is_read ? status_prefix(status, "%s", path) : status;
}

Status fem_vtu_pieces_read(const char *path, FemVtuContent *content) {
  const char *ending = strrchr(path, '.');
  return ending && strcmp(ending, ".pvtu") == 0 ? read_list(path, content) : fem_vtu_read(path, content);
}
