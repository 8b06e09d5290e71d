// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/pieces.h"

#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/output/vtk/xml.h"

enum { MAX_ARRAYS = 48, NAME_SIZE = 64 };

static void mark_used(const FemVtuPart *part, const int (*cells)[4], const FemShare *share, int vertex_count,
                      int *place) {
  for (int v = 0; v < vertex_count; v++) place[v] = fem_share_has(share, 1, &v);
  for (int k = 0; k < part->cell_count; k++)
    for (int v = 0; v < 4; v++) place[cells[part->elements[k]][v]] = 1;
}

// Vertices of others that only elements of others have are no part of it.
static Status list_vertices(FemVtuPart *part, const int (*cells)[4], int vertex_count, int *place) {
  for (int v = 0; v < vertex_count; v++) part->vertex_count += place[v];
  part->vertices = memory_zeroed((size_t)part->vertex_count, sizeof *part->vertices);
  part->cells = memory_zeroed((size_t)part->cell_count, 4 * sizeof *part->cells);
  if (!part->vertices || !part->cells) return status_no_memory("a piece of the frames");
  for (int v = 0, next = 0; v < vertex_count; v++) {
    if (!place[v]) continue;
    part->vertices[next] = v;
    place[v] = next++;
  }
  for (int k = 0; k < part->cell_count; k++)
    for (int v = 0; v < 4; v++) part->cells[4 * (size_t)k + (size_t)v] = place[cells[part->elements[k]][v]];
  return STATUS_OK;
}

static Status fill_part(FemVtuPart *part, int vertex_count, int cell_count, const int (*cells)[4],
                        const FemShare *share) {
  int own = 0;
  for (int e = 0; e < cell_count; e++) own += fem_share_has(share, 4, cells[e]);
  part->elements = memory_zeroed((size_t)own, sizeof *part->elements);
  int *place = memory_zeroed((size_t)vertex_count, sizeof *place);
  Status status = part->elements && place ? STATUS_OK : status_no_memory("a piece of the frames");
  for (int e = 0; e < cell_count && !status; e++)
    if (fem_share_has(share, 4, cells[e])) part->elements[part->cell_count++] = e;
  if (!status) {
    mark_used(part, cells, share, vertex_count, place);
    status = list_vertices(part, cells, vertex_count, place);
  }
  memory_free(place);
  return status;
}

Status fem_vtu_part_create(FemVtuPart *part, int vertex_count, int cell_count, const int (*cells)[4],
                           const FemShare *share) {
  *part = (FemVtuPart){0};
  Status status = fill_part(part, vertex_count, cell_count, cells, share);
  if (status) fem_vtu_part_destroy(part);
  return status;
}

void fem_vtu_part_destroy(FemVtuPart *part) {
  memory_free(part->vertices), memory_free(part->elements), memory_free(part->cells);
  *part = (FemVtuPart){0};
}

// Of an array of the whole, what a part has.
typedef struct Selection {
  const FemVtuArray *array;
  const int *tuples; // in the whole
} Selection;

static void fill_selected(void *self, size_t first, size_t count, double *values) {
  const Selection *selection = self;
  const FemVtuArray *array = selection->array;
  size_t components = (size_t)array->components;
  for (size_t k = 0; k < count; k++) {
    size_t tuple = (size_t)selection->tuples[first + k];
    if (array->fill)
      array->fill(array->self, tuple, 1, values + components * k);
    else
      memcpy(values + components * k, array->reals + components * tuple, components * sizeof *values);
  }
}

// The piece as a frame of its own, and what that borrows.
typedef struct Piece {
  FemVtuFrame frame;
  FemVtuArray arrays[MAX_ARRAYS + 2];
  Selection selections[MAX_ARRAYS];
  int *integers[MAX_ARRAYS];
  double *positions;
} Piece;

static Status select_integers(const FemVtuArray *array, const int *tuples, int count, int **selected) {
  size_t components = (size_t)array->components;
  *selected = memory_zeroed((size_t)count, components * sizeof **selected);
  if (!*selected) return status_no_memory("a piece of a frame");
  for (int k = 0; k < count; k++)
    memcpy(*selected + components * (size_t)k, array->integers + components * (size_t)tuples[k],
           components * sizeof **selected);
  return STATUS_OK;
}

static Status select_array(Piece *piece, int k, const FemVtuArray *array, const FemVtuPart *part) {
  FemVtuArray *own = &piece->arrays[piece->frame.array_count++];
  const int *tuples = array->is_cell ? part->elements : part->vertices;
  *own = (FemVtuArray){.name = array->name, .is_cell = array->is_cell, .components = array->components};
  if (array->integers) {
    TRY(select_integers(array, tuples, array->is_cell ? part->cell_count : part->vertex_count,
                        &piece->integers[k]));
    own->integers = piece->integers[k];
    return STATUS_OK;
  }
  piece->selections[k] = (Selection){.array = array, .tuples = tuples};
  own->fill = fill_selected, own->self = &piece->selections[k];
  return STATUS_OK;
}

static Status take_part(Piece *piece, const FemVtuFrame *frame, const FemVtuPart *part) {
  piece->positions = memory_zeroed((size_t)part->vertex_count, 3 * sizeof *piece->positions);
  if (!piece->positions) return status_no_memory("a piece of a frame");
  for (int k = 0; k < part->vertex_count; k++)
    memcpy(piece->positions + 3 * (size_t)k, frame->positions + 3 * (size_t)part->vertices[k],
           3 * sizeof(double));
  piece->frame = (FemVtuFrame){.time = frame->time,
                               .history_time = frame->history_time,
                               .vertex_count = part->vertex_count,
                               .positions = piece->positions,
                               .cell_count = part->cell_count,
                               .cells = part->cells,
                               .arrays = piece->arrays};
  for (int k = 0; k < frame->array_count; k++) TRY(select_array(piece, k, &frame->arrays[k], part));
  piece->arrays[piece->frame.array_count++] =
      (FemVtuArray){.name = FEM_VTU_VERTEX, .components = 1, .integers = part->vertices};
  piece->arrays[piece->frame.array_count++] =
      (FemVtuArray){.name = FEM_VTU_ELEMENT, .is_cell = true, .components = 1, .integers = part->elements};
  return STATUS_OK;
}

static Status write_piece(const char *directory, const char *name, const FemVtuFrame *frame,
                          const FemVtuPart *part) {
  char file[NAME_SIZE];
  snprintf(file, sizeof file, "%s_%d.vtu", name, ranks()->number);
  char *path = file_join(directory, file);
  Piece *piece = memory_zeroed(1, sizeof *piece);
  Status status = path && piece ? take_part(piece, frame, part) : status_no_memory("a piece of a frame");
  if (!status) status = fem_vtu_write_own(path, &piece->frame);
  for (int k = 0; piece && k < frame->array_count; k++) memory_free(piece->integers[k]);
  if (piece) memory_free(piece->positions);
  memory_free(piece);
  memory_free(path);
  return status;
}

static void print_array(FILE *stream, const FemVtuArray *array) {
  fprintf(stream, "      <PDataArray type=\"%s\" Name=\"", array->integers ? "Int32" : "Float64");
  fem_xml_print(stream, array->name);
  fprintf(stream, "\" NumberOfComponents=\"%d\"/>\n", array->components);
}

static void print_arrays(FILE *stream, const FemVtuFrame *frame, bool is_cell) {
  const FemVtuArray number = {
      .name = is_cell ? FEM_VTU_ELEMENT : FEM_VTU_VERTEX, .components = 1, .integers = (const int[]){0}};
  fprintf(stream, "    <%s>\n", is_cell ? "PCellData" : "PPointData");
  for (int k = 0; k < frame->array_count; k++)
    if (frame->arrays[k].is_cell == is_cell) print_array(stream, &frame->arrays[k]);
  print_array(stream, &number);
  fprintf(stream, "    </%s>\n", is_cell ? "PCellData" : "PPointData");
}

static void print_list(FILE *stream, const char *name, const FemVtuFrame *frame) {
  const bool is_little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  fprintf(stream,
          "<?xml version=\"1.0\"?>\n"
          "<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\""
          " compressor=\"vtkZLibDataCompressor\">\n"
          "  <PUnstructuredGrid GhostLevel=\"0\">\n",
          is_little ? "LittleEndian" : "BigEndian");
  print_arrays(stream, frame, false);
  print_arrays(stream, frame, true);
  fprintf(stream,
          "    <PPoints>\n      <PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n"
          "    </PPoints>\n");
  for (int rank = 0; rank < ranks()->count; rank++) {
    fprintf(stream, "    <Piece Source=\"");
    fem_xml_print(stream, name);
    fprintf(stream, "_%d.vtu\"/>\n", rank);
  }
  fprintf(stream, "  </PUnstructuredGrid>\n</VTKFile>\n");
}

static Status write_list(const char *directory, const char *name, const FemVtuFrame *frame) {
  char file[NAME_SIZE];
  FileWriter list;
  snprintf(file, sizeof file, "%s.pvtu", name);
  char *path = file_join(directory, file);
  Status status = path ? file_begin(&list, path) : status_no_memory("a file name");
  memory_free(path);
  TRY(status);
  print_list(list.stream, name, frame);
  return file_commit(&list);
}

Status fem_vtu_pieces_write(const char *directory, const char *name, const FemVtuFrame *frame,
                            const FemVtuPart *part) {
  TRY(ranks()->worst(write_piece(directory, name, frame, part)));
  return ranks()->worst(write_list(directory, name, frame));
}
