// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/vtu_read.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/deflate.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/output/vtk/base64.h"

enum { MAX_COMPONENTS = 9, MAX_COUNT = 1 << 28 };

// What an attribute may hold, longest names of ours included.
typedef char Value[FEM_VTU_MAX_NAME];

// One DataArray: its attributes and the text between its tags.
typedef struct Element {
  Value type, name, format;
  int components;
  const char *text, *end;
} Element;

static Status refuse(const char *what) {
  return status_fail(STATUS_INPUT, "%s; expected a frame that `tetlap run` wrote", what);
}

// Copies the value of an attribute of the tag that begins at `tag`; false if it has none or a longer one.
static bool find_attribute(const char *tag, const char *name, Value value) {
  const char *close = strchr(tag, '>');
  size_t length = strlen(name);
  for (const char *at = tag; close && (at = strstr(at, name)) && at < close; at += length) {
    if (at[-1] != ' ' || strncmp(at + length, "=\"", 2) != 0) continue;
    const char *begin = at + length + 2;
    size_t size = strcspn(begin, "\"");
    if (size >= sizeof(Value) || begin + size > close) return false;
    memcpy(value, begin, size);
    value[size] = 0;
    return true;
  }
  return false;
}

// A number of things, 0 … MAX_COUNT; −1 if it is none.
static int count_of(const char *tag, const char *name) {
  Value value;
  char *end;
  if (!find_attribute(tag, name, value)) return -1;
  long count = strtol(value, &end, 10);
  return *end || end == value || count < 0 || count > MAX_COUNT ? -1 : (int)count;
}

// The next DataArray before `limit`; NULL: there is none. A tag without what is needed has components −1.
static const char *next_element(const char *text, const char *limit, Element *element) {
  const char *tag = strstr(text, "<DataArray "), *close = tag ? strchr(tag, '>') : NULL;
  if (!close || close >= limit) return NULL;
  *element = (Element){.components = 1, .text = close + 1, .end = strchr(close, '<')};
  if (!element->end) element->end = close + 1 + strlen(close + 1);
  if (strstr(tag, "NumberOfComponents=") && strstr(tag, "NumberOfComponents=") < close)
    element->components = count_of(tag, "NumberOfComponents");
  if (!find_attribute(tag, "type", element->type) || !find_attribute(tag, "Name", element->name) ||
      !find_attribute(tag, "format", element->format))
    element->components = -1;
  while (element->text < element->end && strchr(" \n\r\t", *element->text)) element->text++;
  return element->end;
}

// Unpacks the blocks that follow VTK's header [number of blocks, size of a block, size of the last one if it
// is shorter, packed size of each].
static bool unpack_blocks(const uint64_t *header, const unsigned char *packed, unsigned char *bytes,
                          size_t byte_count) {
  const uint64_t block_count = header[0];
  size_t done = 0;
  for (uint64_t k = 0; k < block_count; k++) {
    size_t size = k + 1 == block_count && header[2] ? header[2] : header[1];
    if (size > byte_count - done || !deflate_unpack(bytes + done, size, packed, header[3 + k])) return false;
    packed += header[3 + k];
    done += size;
  }
  return done == byte_count;
}

// The element's bytes, which must be `byte_count`.
static Status read_bytes(const Element *element, void *bytes, size_t byte_count) {
  uint64_t counts[3] = {0};
  if (strcmp(element->format, "binary") != 0) return refuse("an array is not in the format 'binary'");
  if (!fem_base64_read(element->text, element->end, counts, sizeof counts) ||
      counts[0] > (size_t)(element->end - element->text) / sizeof *counts ||
      counts[1] > byte_count + (1 << 20))
    return refuse("an array has no header of zlib blocks");
  uint64_t *header = memory_zeroed((size_t)counts[0] + 3, sizeof *header);
  if (!header) return status_no_memory("the header of an array");
  const char *text = fem_base64_read(element->text, element->end, header, (counts[0] + 3) * sizeof *header);
  size_t packed_count = 0, room = (size_t)(element->end - element->text);
  bool ok = text != NULL;
  for (uint64_t k = 0; ok && k < counts[0]; k++) {
    ok = header[3 + k] <= room - packed_count;
    packed_count += ok ? (size_t)header[3 + k] : 0;
  }
  unsigned char *packed = memory_zeroed(packed_count, 1);
  if (packed)
    ok = ok && fem_base64_read(text, element->end, packed, packed_count) &&
         unpack_blocks(header, packed, bytes, byte_count);
  Status status = !packed ? status_no_memory("the bytes of an array")
                  : ok    ? STATUS_OK
                          : refuse("an array is damaged or of another size");
  memory_free(packed);
  memory_free(header);
  return status;
}

static Status read_reals(const Element *element, double **values, size_t count) {
  *values = memory_zeroed(count, sizeof **values);
  if (!*values) return status_no_memory("an array of a frame");
  return read_bytes(element, *values, count * sizeof **values);
}

static Status read_integers(const Element *element, int **values, size_t count) {
  if (strcmp(element->type, "Int32") != 0) return refuse("an array of integers is not of the type Int32");
  *values = memory_zeroed(count, sizeof **values);
  if (!*values) return status_no_memory("an array of a frame");
  return read_bytes(element, *values, count * sizeof **values);
}

static Status read_field(const Element *element, bool is_cell, FemVtuContent *content) {
  if (content->field_count == FEM_VTU_MAX_FIELDS) return refuse("there are too many arrays");
  if (element->components < 1 || element->components > MAX_COMPONENTS)
    return refuse("an array lacks its type, name, format or number of components");
  FemVtuField *field = &content->fields[content->field_count++];
  *field = (FemVtuField){.is_cell = is_cell, .components = element->components};
  strcpy(field->name, element->name);
  size_t count = (size_t)(is_cell ? content->cell_count : content->vertex_count) * (size_t)field->components;
  if (strcmp(element->type, "Float64") == 0) return read_reals(element, &field->values, count);
  int *integers = NULL;
  Status status = read_integers(element, &integers, count);
  field->is_integer = true;
  field->values = status ? NULL : memory_zeroed(count, sizeof *field->values);
  if (!status && !field->values) status = status_no_memory("an array of a frame");
  for (size_t i = 0; !status && i < count; i++) field->values[i] = integers[i];
  memory_free(integers);
  return status;
}

// The arrays between <NAME> and </NAME>; `text` follows behind.
static Status find_section(const char **text, const char *name, const char **limit) {
  char open[32], shut[32];
  snprintf(open, sizeof open, "<%s>", name);
  snprintf(shut, sizeof shut, "</%s>", name);
  *text = strstr(*text, open);
  *limit = *text ? strstr(*text, shut) : NULL;
  return *limit ? STATUS_OK : refuse("a section is missing");
}

static Status read_fields(const char *text, const char *name, bool is_cell, FemVtuContent *content) {
  const char *limit;
  TRY(find_section(&text, name, &limit));
  for (Element element; (text = next_element(text, limit, &element));)
    TRY(read_field(&element, is_cell, content));
  return STATUS_OK;
}

static Status read_points(const char *text, FemVtuContent *content) {
  const char *limit;
  Element element;
  TRY(find_section(&text, "Points", &limit));
  if (!next_element(text, limit, &element) || element.components != 3 || strcmp(element.type, "Float64") != 0)
    return refuse("the points are not three numbers each");
  return read_reals(&element, &content->positions, 3 * (size_t)content->vertex_count);
}

// The kind of the cells, which is the same for all.
static Status read_types(const Element *element, FemVtuContent *content) {
  const size_t count = (size_t)content->cell_count;
  if (strcmp(element->type, "UInt8") != 0) return refuse("the cells' types are not of the type UInt8");
  uint8_t *types = memory_zeroed(count, sizeof *types);
  if (!types) return status_no_memory("the cells of a frame");
  Status status = read_bytes(element, types, count);
  if (!status && count > 0 && types[0] == fem_vtu_type(FEM_VTU_TRIANGLES)) content->cell = FEM_VTU_TRIANGLES;
  for (size_t i = 0; !status && i < count; i++)
    if (types[i] != fem_vtu_type(content->cell))
      status = refuse("the cells are neither all tetrahedra nor all triangles");
  memory_free(types);
  return status;
}

static Status read_cells(const char *text, FemVtuContent *content) {
  const char *limit;
  Element connectivity, offsets, types;
  TRY(find_section(&text, "Cells", &limit));
  if (!(text = next_element(text, limit, &connectivity)) || strcmp(connectivity.name, "connectivity") != 0 ||
      !(text = next_element(text, limit, &offsets)) || strcmp(offsets.name, "offsets") != 0 ||
      !next_element(text, limit, &types) || strcmp(types.name, "types") != 0)
    return refuse("the cells lack connectivity, offsets or types");
  TRY(read_types(&types, content));
  const size_t count = (size_t)content->cell_count * (size_t)fem_vtu_corner_count(content->cell);
  TRY(read_integers(&connectivity, &content->cells, count));
  for (size_t i = 0; i < count; i++)
    if (content->cells[i] < 0 || content->cells[i] >= content->vertex_count)
      return refuse("a cell names a vertex that is not there");
  return STATUS_OK;
}

// zlib makes no byte out of less than a 1032nd (zlib's technical notes); what a file announces beyond is not
// true and not allocated.
static bool can_hold(const char *text, int count, size_t bytes) {
  enum { MOST_PACKED = 1032 };
  return (size_t)count <= MOST_PACKED * strlen(text) / bytes;
}

static Status read_header(const char *text, FemVtuContent *content) {
  const char *file = strstr(text, "<VTKFile "), *piece = strstr(text, "<Piece "),
             *time = strstr(text, "Name=\"TimeValue\"");
  Value value;
  const char *order = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? "LittleEndian" : "BigEndian";
  if (!file || !find_attribute(file, "type", value) || strcmp(value, "UnstructuredGrid") != 0)
    return refuse("is not a VTK file of an unstructured grid");
  if (!find_attribute(file, "byte_order", value) || strcmp(value, order) != 0)
    return refuse("has another order of bytes than this machine");
  if (!find_attribute(file, "compressor", value) || strcmp(value, "vtkZLibDataCompressor") != 0 ||
      !find_attribute(file, "header_type", value) || strcmp(value, "UInt64") != 0)
    return refuse("is not compressed by zlib with headers of UInt64");
  content->vertex_count = piece ? count_of(piece, "NumberOfPoints") : -1;
  content->cell_count = piece ? count_of(piece, "NumberOfCells") : -1;
  if (content->vertex_count < 0 || content->cell_count < 0)
    return refuse("has no counts of points and cells");
  if (!can_hold(text, content->vertex_count, sizeof(double[3])) ||
      !can_hold(text, content->cell_count, sizeof(int[3])))
    return refuse("announces more points and cells than a file of its size can hold");
  content->time = time && (time = strchr(time, '>')) ? strtod(time + 1, NULL) : NAN;
  return STATUS_OK;
}

static Status read_content(const char *text, FemVtuContent *content) {
  TRY(read_header(text, content));
  TRY(read_fields(text, "PointData", false, content));
  TRY(read_fields(text, "CellData", true, content));
  TRY(read_points(text, content));
  return read_cells(text, content);
}

Status fem_vtu_read(const char *path, FemVtuContent *content) {
  char *text;
  size_t size;
  *content = (FemVtuContent){0};
  TRY(file_read(path, &text, &size));
  Status status = read_content(text, content);
  memory_free(text);
  if (!status) return STATUS_OK;
  fem_vtu_read_destroy(content);
  return status_prefix(status, "%s", path);
}

void fem_vtu_read_destroy(FemVtuContent *content) {
  for (int k = 0; k < content->field_count; k++) memory_free(content->fields[k].values);
  memory_free(content->positions);
  memory_free(content->cells);
  *content = (FemVtuContent){0};
}
