// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/vtu.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/files/deflate.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/output/vtk/base64.h"
#include "fem/output/vtk/xml.h"

enum {
  BLOCK_BYTES = 32768, // uncompressed size of a block, VTK's own default
  BATCH_BLOCKS = 72,   // compressed at a time: whole tuples of 1, 3, 6 or 9 doubles
  BATCH_NUMBERS = BATCH_BLOCKS * BLOCK_BYTES / (int)sizeof(double),
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
  const void *source; // NULL: `fill` gives it
  size_t byte_count;
  FemVtuFill *fill;
  void *self;
} Piece;

// A batch of blocks on its way to the file: block k compressed into slots + k · slot_bytes. VTK's header is
// [number of blocks, size of a block, size of the last one if it is shorter, compressed size of each].
typedef struct Packing {
  unsigned char *slots;
  size_t slot_bytes;
  double *filled; // what `fill` has given                   (BATCH_NUMBERS at most)
  uint64_t *header;
  uint64_t block_count;
} Packing;

static bool create(Packing *packing, const Piece *piece) {
  packing->block_count = (piece->byte_count + BLOCK_BYTES - 1) / BLOCK_BYTES;
  packing->slot_bytes = deflate_bound(BLOCK_BYTES);
  // No more than the array has: fresh memory has to be cleared.
  const size_t blocks = packing->block_count < BATCH_BLOCKS ? (size_t)packing->block_count : BATCH_BLOCKS;
  const size_t filled = piece->source ? 0 : blocks * BLOCK_BYTES / sizeof(double);
  packing->slots = memory_zeroed(blocks, packing->slot_bytes);
  packing->filled = memory_zeroed(filled, sizeof *packing->filled);
  packing->header = memory_zeroed((size_t)packing->block_count + 3, sizeof *packing->header);
  return packing->slots && packing->filled && packing->header;
}

static void destroy(Packing *packing) {
  memory_free(packing->slots);
  memory_free(packing->filled);
  memory_free(packing->header);
}

// The bytes from block `first` on.
static const unsigned char *find_source(Packing *packing, const Piece *piece, size_t first) {
  size_t begin = first * BLOCK_BYTES, bytes = piece->byte_count - begin;
  if (piece->source) return (const unsigned char *)piece->source + begin;
  size_t numbers = bytes / sizeof(double) < BATCH_NUMBERS ? bytes / sizeof(double) : BATCH_NUMBERS;
  size_t components = (size_t)piece->components;
  piece->fill(piece->self, begin / sizeof(double) / components, numbers / components, packing->filled);
  return (const unsigned char *)packing->filled;
}

// Blocks `first` … of a batch; false if there is no memory. Fast, since doubles of a simulation hardly shrink
// further with more effort.
static bool compress_batch(Packing *packing, const Piece *piece, size_t first, int count) {
  const unsigned char *source = find_source(packing, piece, first);
  const size_t bytes = piece->byte_count - first * BLOCK_BYTES;
  bool ok = true;
#pragma omp parallel for schedule(static) reduction(&& : ok)
  for (int k = 0; k < count; k++) {
    const size_t begin = (size_t)k * BLOCK_BYTES, rest = bytes - begin;
    size_t length;
    ok = deflate_pack(packing->slots + (size_t)k * packing->slot_bytes, &length, source + begin,
                      rest < BLOCK_BYTES ? rest : BLOCK_BYTES, DEFLATE_FAST) &&
         ok;
    packing->header[3 + first + (size_t)k] = length;
  }
  return ok;
}

static void print_header(FILE *stream, const Packing *packing) {
  FemBase64 text = {.stream = stream};
  fem_base64_write(&text, packing->header, ((size_t)packing->block_count + 3) * sizeof *packing->header);
  fem_base64_end(&text);
}

// The header and the blocks, each a base64 text of its own; sizes are known once the blocks are written, so
// the header is written twice. That a file cannot be written is found when it is committed.
static bool print_packed(FILE *stream, Packing *packing, const Piece *piece) {
  uint64_t *header = packing->header;
  FemBase64 text = {.stream = stream};
  off_t begin = ftello(stream);
  print_header(stream, packing);
  header[0] = packing->block_count;
  header[1] = BLOCK_BYTES;
  header[2] = piece->byte_count % BLOCK_BYTES;
  for (size_t first = 0; first < packing->block_count; first += BATCH_BLOCKS) {
    size_t left = (size_t)packing->block_count - first;
    int count = left < BATCH_BLOCKS ? (int)left : BATCH_BLOCKS;
    if (!compress_batch(packing, piece, first, count)) return false;
    for (int k = 0; k < count; k++)
      fem_base64_write(&text, packing->slots + (size_t)k * packing->slot_bytes,
                       header[3 + first + (size_t)k]);
  }
  fem_base64_end(&text);
  if (fseeko(stream, begin, SEEK_SET) == 0) print_header(stream, packing);
  fseeko(stream, 0, SEEK_END);
  return true;
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
  bool ok = create(&packing, piece);
  if (ok) {
    print_opening(stream, piece);
    ok = print_packed(stream, &packing, piece);
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
    Piece piece = {.type = array->integers ? "Int32" : "Float64",
                   .name = array->name,
                   .components = array->components,
                   .byte_count = numbers * (array->integers ? sizeof(int) : sizeof(double)),
                   .fill = array->fill,
                   .self = array->self};
    piece.source = array->integers ? (const void *)array->integers : (const void *)array->reals;
    TRY(print_piece(stream, &piece));
  }
  fprintf(stream, "      </%s>\n", section);
  return STATUS_OK;
}

static Status print_points(FILE *stream, const FemVtuFrame *frame) {
  const Piece points = {.type = "Float64",
                        .name = "Points",
                        .components = 3,
                        .source = frame->positions,
                        .byte_count = (size_t)frame->vertex_count * 3 * sizeof(double)};
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
  const Piece pieces[] = {
      {"Int32", "connectivity", 1, frame->cells, count * corners * sizeof(int), NULL, NULL},
      {"Int64", "offsets", 1, ends, count * sizeof *ends, NULL, NULL},
      {"UInt8", "types", 1, types, count * sizeof *types, NULL, NULL}};
  fprintf(stream, "      <Cells>\n");
  for (int p = 0; !status && p < 3; p++) status = print_piece(stream, &pieces[p]);
  fprintf(stream, "      </Cells>\n");
  memory_free(ends);
  memory_free(types);
  return status;
}

static void print_field(FILE *stream, const char *name, double value) {
  fprintf(stream,
          "      <DataArray type=\"Float64\" Name=\"%s\" NumberOfTuples=\"1\" format=\"ascii\">"
          "%.17g</DataArray>\n",
          name, value);
}

// The time comes first: readers look for it there.
static void print_fields(FILE *stream, const FemVtuFrame *frame) {
  if (isnan(frame->time)) return;
  fprintf(stream, "    <FieldData>\n");
  print_field(stream, "TimeValue", frame->time);
  if (frame->history_time) print_field(stream, "history_time", *frame->history_time);
  fprintf(stream, "    </FieldData>\n");
}

static Status print_frame(FILE *stream, const FemVtuFrame *frame) {
  const bool is_little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  fprintf(stream,
          "<?xml version=\"1.0\"?>\n"
          "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\""
          " compressor=\"vtkZLibDataCompressor\">\n"
          "  <UnstructuredGrid>\n",
          is_little ? "LittleEndian" : "BigEndian");
  print_fields(stream, frame);
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
  return ranks_is_first() ? fem_vtu_write_own(path, frame) : STATUS_OK;
}

Status fem_vtu_write_own(const char *path, const FemVtuFrame *frame) {
  FileWriter writer;
  TRY(file_begin_own(&writer, path));
  Status status = print_frame(writer.stream, frame);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}
