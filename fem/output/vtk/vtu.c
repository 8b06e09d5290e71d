// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/vtu.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/files/deflate.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/output/vtk/base64.h"
#include "fem/output/vtk/xml.h"

enum {
  BLOCK_BYTES = 32768, // uncompressed size of a block, VTK's own default
};

int fem_vtu_corner_count(FemVtuCell cell) {
  return cell == FEM_VTU_TETRAHEDRA ? 4 : 3;
}

int fem_vtu_type(FemVtuCell cell) {
  enum { VTK_TRIANGLE = 5, VTK_TETRA = 10 };
  return cell == FEM_VTU_TETRAHEDRA ? VTK_TETRA : VTK_TRIANGLE;
}

// One DataArray element.
typedef struct Piece {
  const char *type, *name;
  int components;
  const void *source;
  size_t byte_count;
} Piece;

// A piece on its way to the file: block k compressed into slots + k · slot_bytes, and VTK's header
// [number of blocks, size of a block, size of the last one if it is shorter, compressed size of each].
typedef struct Packing {
  unsigned char *slots;
  size_t slot_bytes;
  uint64_t *header;
  uint64_t block_count;
} Packing;

static bool create(Packing *packing, size_t byte_count) {
  packing->block_count = (byte_count + BLOCK_BYTES - 1) / BLOCK_BYTES;
  packing->slot_bytes = deflate_bound(BLOCK_BYTES);
  packing->slots = memory_zeroed((size_t)packing->block_count, packing->slot_bytes);
  packing->header = memory_zeroed((size_t)packing->block_count + 3, sizeof *packing->header);
  return packing->slots && packing->header;
}

static void destroy(Packing *packing) {
  memory_free(packing->slots);
  memory_free(packing->header);
}

// False if there is no memory. Fast, since doubles of a simulation hardly shrink further with more effort.
static bool compress_blocks(Packing *packing, const unsigned char *source, size_t byte_count) {
  uint64_t *header = packing->header;
  header[0] = packing->block_count;
  header[1] = BLOCK_BYTES;
  header[2] = byte_count % BLOCK_BYTES;
  bool ok = true;
#pragma omp parallel for schedule(static) reduction(&& : ok)
  for (int64_t k = 0; k < (int64_t)packing->block_count; k++) {
    const size_t begin = (size_t)k * BLOCK_BYTES, rest = byte_count - begin;
    size_t length;
    ok = deflate_pack(packing->slots + (size_t)k * packing->slot_bytes, &length, source + begin,
                      rest < BLOCK_BYTES ? rest : BLOCK_BYTES, DEFLATE_FAST) &&
         ok;
    header[3 + k] = length;
  }
  return ok;
}

// The header and the blocks, each a base64 text of its own.
static void print_packed(FILE *stream, const Packing *packing) {
  FemBase64 text = {.stream = stream};
  fem_base64_write(&text, packing->header, ((size_t)packing->block_count + 3) * sizeof *packing->header);
  fem_base64_end(&text);
  for (uint64_t k = 0; k < packing->block_count; k++)
    fem_base64_write(&text, packing->slots + k * packing->slot_bytes, packing->header[3 + k]);
  fem_base64_end(&text);
}

// The names under which ParaView lists the components; NULL for a single one.
static const char *component_name(int components, int component) {
  static const char *const vector[] = {"x", "y", "z"};
  static const char *const symmetric[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  static const char *const full[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  switch (components) {
  case 3:
    return vector[component];
  case 6:
    return symmetric[component];
  case 9:
    return full[component];
  default:
    return NULL;
  }
}

static void print_opening(FILE *stream, const Piece *piece) {
  fprintf(stream, "        <DataArray type=\"%s\" Name=\"", piece->type);
  fem_xml_print(stream, piece->name);
  fprintf(stream, "\" NumberOfComponents=\"%d\"", piece->components);
  for (int c = 0; c < piece->components && component_name(piece->components, c); c++)
    fprintf(stream, " ComponentName%d=\"%s\"", c, component_name(piece->components, c));
  fprintf(stream, " format=\"binary\">\n");
}

static Status print_piece(FILE *stream, const Piece *piece) {
  Packing packing;
  bool ok =
      create(&packing, piece->byte_count) && compress_blocks(&packing, piece->source, piece->byte_count);
  if (ok) {
    print_opening(stream, piece);
    print_packed(stream, &packing);
    fprintf(stream, "\n        </DataArray>\n");
  }
  destroy(&packing);
  return ok ? STATUS_OK : status_no_memory("the compressed arrays of a frame");
}

static Status print_arrays(FILE *stream, const FemVtuFrame *frame, bool is_cell) {
  const char *section = is_cell ? "CellData" : "PointData";
  const size_t tuples = (size_t)(is_cell ? frame->cell_count : frame->vertex_count);
  fprintf(stream, "      <%s>\n", section);
  for (int k = 0; k < frame->array_count; k++) {
    const FemVtuArray *array = &frame->arrays[k];
    if (array->is_cell != is_cell) continue;
    const size_t numbers = tuples * (size_t)array->components;
    const Piece reals = {"Float64", array->name, array->components, array->reals, numbers * sizeof(double)},
                integers = {"Int32", array->name, array->components, array->integers, numbers * sizeof(int)};
    TRY(print_piece(stream, array->reals ? &reals : &integers));
  }
  fprintf(stream, "      </%s>\n", section);
  return STATUS_OK;
}

static Status print_points(FILE *stream, const FemVtuFrame *frame) {
  const Piece points = {"Float64", "Points", 3, frame->positions,
                        (size_t)frame->vertex_count * 3 * sizeof(double)};
  fprintf(stream, "      <Points>\n");
  TRY(print_piece(stream, &points));
  fprintf(stream, "      </Points>\n");
  return STATUS_OK;
}

// Vertices of the cells, where each cell ends in that list, and the cells' types.
static Status print_cells(FILE *stream, const FemVtuFrame *frame) {
  const size_t count = (size_t)frame->cell_count, corners = (size_t)fem_vtu_corner_count(frame->cell);
  int64_t *ends = memory_zeroed(count, sizeof *ends);
  uint8_t *types = memory_zeroed(count, sizeof *types);
  Status status = ends && types ? STATUS_OK : status_no_memory("the cells of a frame");
  for (size_t i = 0; !status && i < count; i++) {
    ends[i] = (int64_t)(corners * (i + 1));
    types[i] = (uint8_t)fem_vtu_type(frame->cell);
  }
  const Piece pieces[] = {{"Int32", "connectivity", 1, frame->cells, count * corners * sizeof(int)},
                          {"Int64", "offsets", 1, ends, count * sizeof *ends},
                          {"UInt8", "types", 1, types, count * sizeof *types}};
  fprintf(stream, "      <Cells>\n");
  for (int p = 0; !status && p < 3; p++) status = print_piece(stream, &pieces[p]);
  fprintf(stream, "      </Cells>\n");
  memory_free(ends);
  memory_free(types);
  return status;
}

static Status print_frame(FILE *stream, const FemVtuFrame *frame) {
  const bool is_little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  fprintf(stream,
          "<?xml version=\"1.0\"?>\n"
          "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\""
          " compressor=\"vtkZLibDataCompressor\">\n"
          "  <UnstructuredGrid>\n",
          is_little ? "LittleEndian" : "BigEndian");
  if (!isnan(frame->time))
    fprintf(stream,
            "    <FieldData>\n"
            "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
            "%.17g</DataArray>\n"
            "    </FieldData>\n",
            frame->time);
  fprintf(stream, "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n", frame->vertex_count,
          frame->cell_count);
  TRY(print_arrays(stream, frame, false));
  TRY(print_arrays(stream, frame, true));
  TRY(print_points(stream, frame));
  TRY(print_cells(stream, frame));
  fprintf(stream, "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n");
  return STATUS_OK;
}

Status fem_vtu_write(const char *path, const FemVtuFrame *frame) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = print_frame(writer.stream, frame);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}
