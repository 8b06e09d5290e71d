// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/vtu.h"

#include <stdint.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "fem/xml.h"

enum {
  BLOCK_BYTES = 32768,  // uncompressed size of a block, VTK's own default
  LEVEL = Z_BEST_SPEED, // doubles of a simulation hardly shrink further at higher levels
  VTK_TETRA = 10,       // cell type
  STRUCTURE_PIECES = 4, // positions, connectivity, offsets, types
};

// The appended section as it grows: all arrays compressed one after another.
typedef struct Appendix {
  unsigned char *bytes;
  size_t size, capacity;
} Appendix;

// One array on its way into the appendix: block k compressed into slots + k · slot_bytes, and VTK's header
// [number of blocks, size of a block, size of the last one if it is shorter, compressed size of each].
typedef struct Packing {
  unsigned char *slots;
  size_t slot_bytes;
  uint64_t *header;
  uint64_t block_count;
} Packing;

static bool create(Packing *packing, size_t byte_count) {
  packing->block_count = (byte_count + BLOCK_BYTES - 1) / BLOCK_BYTES;
  packing->slot_bytes = compressBound(BLOCK_BYTES);
  packing->slots = memory_zeroed((size_t)packing->block_count, packing->slot_bytes);
  packing->header = memory_zeroed((size_t)packing->block_count + 3, sizeof *packing->header);
  return packing->slots && packing->header;
}

// False if zlib found no memory, the only way in which it can fail here.
static bool compress_blocks(Packing *packing, const unsigned char *source, size_t byte_count) {
  uint64_t *header = packing->header;
  header[0] = packing->block_count;
  header[1] = BLOCK_BYTES;
  header[2] = byte_count % BLOCK_BYTES;
  int verdict = Z_OK;
#pragma omp parallel for schedule(static) reduction(min : verdict)
  for (int64_t k = 0; k < (int64_t)packing->block_count; k++) {
    const size_t begin = (size_t)k * BLOCK_BYTES, rest = byte_count - begin;
    uLongf length = (uLongf)packing->slot_bytes;
    int result = compress2(packing->slots + (size_t)k * packing->slot_bytes, &length, source + begin,
                           (uLong)(rest < BLOCK_BYTES ? rest : BLOCK_BYTES), LEVEL);
    header[3 + k] = length;
    if (result < verdict) verdict = result;
  }
  return verdict == Z_OK;
}

static bool reserve(Appendix *appendix, const Packing *packing) {
  size_t wanted = appendix->size + ((size_t)packing->block_count + 3) * sizeof *packing->header;
  for (uint64_t k = 0; k < packing->block_count; k++) wanted += packing->header[3 + k];
  return memory_reserve((void **)&appendix->bytes, &appendix->capacity, wanted, 1);
}

static void put(Appendix *appendix, const void *source, size_t size) {
  memcpy(appendix->bytes + appendix->size, source, size);
  appendix->size += size;
}

static void put_packed(Appendix *appendix, const Packing *packing) {
  put(appendix, packing->header, ((size_t)packing->block_count + 3) * sizeof *packing->header);
  for (uint64_t k = 0; k < packing->block_count; k++)
    put(appendix, packing->slots + k * packing->slot_bytes, packing->header[3 + k]);
}

static Status append(Appendix *appendix, const void *source, size_t byte_count) {
  Packing packing;
  bool ok = create(&packing, byte_count) && compress_blocks(&packing, source, byte_count) &&
            reserve(appendix, &packing);
  if (ok) put_packed(appendix, &packing);
  memory_free(packing.slots);
  memory_free(packing.header);
  return ok ? STATUS_OK : status_no_memory("the compressed arrays of a frame");
}

// The grid's structure: positions, connectivity, where each cell ends, the cells' types.
static Status append_structure(Appendix *appendix, const FemVtuFrame *frame, size_t *offsets) {
  const size_t count = (size_t)frame->tet_count;
  int64_t *ends = memory_zeroed(count, sizeof *ends);
  uint8_t *types = memory_zeroed(count, sizeof *types);
  Status status = ends && types ? STATUS_OK : status_no_memory("the cells of a frame");
  for (size_t i = 0; !status && i < count; i++) {
    ends[i] = 4 * ((int64_t)i + 1);
    types[i] = VTK_TETRA;
  }
  const struct {
    const void *source;
    size_t byte_count;
  } pieces[STRUCTURE_PIECES] = {
      {frame->positions, (size_t)frame->vertex_count * 3 * sizeof(double)},
      {frame->tets, count * 4 * sizeof(int)},
      {ends, count * sizeof *ends},
      {types, count * sizeof *types},
  };
  for (int p = 0; !status && p < STRUCTURE_PIECES; p++) {
    offsets[p] = appendix->size;
    status = append(appendix, pieces[p].source, pieces[p].byte_count);
  }
  memory_free(ends);
  memory_free(types);
  return status;
}

static Status append_arrays(Appendix *appendix, const FemVtuFrame *frame, size_t *offsets) {
  for (int k = 0; k < frame->array_count; k++) {
    const FemVtuArray *array = &frame->arrays[k];
    size_t tuples = (size_t)(array->is_cell ? frame->tet_count : frame->vertex_count);
    size_t numbers = tuples * (size_t)array->components;
    offsets[k] = appendix->size;
    if (array->reals)
      TRY(append(appendix, array->reals, numbers * sizeof(double)));
    else
      TRY(append(appendix, array->integers, numbers * sizeof(int)));
  }
  return STATUS_OK;
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

static void print_array(FILE *stream, const char *type, const char *name, int components, size_t offset) {
  fprintf(stream, "        <DataArray type=\"%s\" Name=\"", type);
  fem_xml_print(stream, name);
  fprintf(stream, "\" NumberOfComponents=\"%d\"", components);
  for (int c = 0; c < components && component_name(components, c); c++)
    fprintf(stream, " ComponentName%d=\"%s\"", c, component_name(components, c));
  fprintf(stream, " format=\"appended\" offset=\"%zu\"/>\n", offset);
}

static void print_arrays(FILE *stream, const FemVtuFrame *frame, bool is_cell, const size_t *offsets) {
  const char *section = is_cell ? "CellData" : "PointData";
  fprintf(stream, "      <%s>\n", section);
  for (int k = 0; k < frame->array_count; k++) {
    const FemVtuArray *array = &frame->arrays[k];
    if (array->is_cell == is_cell)
      print_array(stream, array->reals ? "Float64" : "Int32", array->name, array->components, offsets[k]);
  }
  fprintf(stream, "      </%s>\n", section);
}

static void print_head(FILE *stream, const FemVtuFrame *frame, const size_t *offsets) {
  const bool is_little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  fprintf(stream,
          "<?xml version=\"1.0\"?>\n"
          "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\""
          " compressor=\"vtkZLibDataCompressor\">\n"
          "  <UnstructuredGrid>\n"
          "    <FieldData>\n"
          "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
          "%.17g</DataArray>\n"
          "    </FieldData>\n"
          "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n",
          is_little ? "LittleEndian" : "BigEndian", frame->time, frame->vertex_count, frame->tet_count);
  print_arrays(stream, frame, false, offsets + STRUCTURE_PIECES);
  print_arrays(stream, frame, true, offsets + STRUCTURE_PIECES);
  fprintf(stream, "      <Points>\n");
  print_array(stream, "Float64", "Points", 3, offsets[0]);
  fprintf(stream, "      </Points>\n      <Cells>\n");
  print_array(stream, "Int32", "connectivity", 1, offsets[1]);
  print_array(stream, "Int64", "offsets", 1, offsets[2]);
  print_array(stream, "UInt8", "types", 1, offsets[3]);
  fprintf(stream,
          "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_");
}

static Status write_file(const char *path, const FemVtuFrame *frame, const Appendix *appendix,
                         const size_t *offsets) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  print_head(writer.stream, frame, offsets);
  fwrite(appendix->bytes, 1, appendix->size, writer.stream);
  fprintf(writer.stream, "\n  </AppendedData>\n</VTKFile>\n");
  return file_commit(&writer);
}

Status fem_vtu_write(const char *path, const FemVtuFrame *frame) {
  Appendix appendix = {0};
  size_t *offsets = memory_zeroed((size_t)(STRUCTURE_PIECES + frame->array_count), sizeof *offsets);
  Status status = offsets ? STATUS_OK : status_no_memory("the arrays of a frame");
  if (!status) status = append_structure(&appendix, frame, offsets);
  if (!status) status = append_arrays(&appendix, frame, offsets + STRUCTURE_PIECES);
  if (!status) status = write_file(path, frame, &appendix, offsets);
  memory_free(appendix.bytes);
  memory_free(offsets);
  return status;
}
