// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a checkpoint. HDF5 works in memory only; what reaches the disk goes through base/files/file.h.
#include <assert.h>
#include <errno.h>
#include <hdf5.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/run/checkpoint/numbers.h"

// HDF5 looks for its own beginning at 0, 512, 1024 …
enum { HEAD_SIZE = 512, FORMAT = 20, PATH_SIZE = 96 };
static const char MAGIC[] = "tetlap checkpoint";

// An effect's cost, one array.
enum { COST_COUNT = 7 };
static_assert(sizeof(FemEffectCost) == COST_COUNT * sizeof(double), "costs_of lists every number");

static hid_t memory_type(FemCheckpointType type) {
  return type == FEM_INTEGER ? H5T_NATIVE_INT : type == FEM_LONG ? H5T_NATIVE_LLONG : H5T_NATIVE_DOUBLE;
}

static hid_t file_type(FemCheckpointType type) {
  return type == FEM_INTEGER ? H5T_STD_I32LE : type == FEM_LONG ? H5T_STD_I64LE : H5T_IEEE_F64LE;
}

static void close_id(hid_t id) {
  if (id >= 0) H5Idec_ref(id);
}

static herr_t keep_description(unsigned level, const H5E_error2_t *error, void *text) {
  (void)level;
  if (error->desc) snprintf(text, 160, "%s", error->desc);
  return 0;
}

// HDF5 keeps a freed buffer for the next one of just that size, and texts have another size every time.
static void forget_buffers(void) {
  H5garbage_collect();
}

// A failure with the cause that HDF5 gives.
static Status fail_hdf5(Status code, const char *path, const char *what) {
  char reason[160] = "no reason given";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_description, reason); // down to the cause
  H5Eclear2(H5E_DEFAULT);
  return status_fail(code, "%s: %s: %s", path, what, reason);
}

// A file in memory; with an image, of that content. −1: it is none, or no memory.
static hid_t open_memory(const void *image, size_t size) {
  enum { GROWTH_SIZE = 65536 };
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); // HDF5 prints unless it is told not to
  hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE), file = -1;
  bool works = access >= 0 && creation >= 0 && H5Pset_fapl_core(access, GROWTH_SIZE, false) >= 0;
  if (works && image) works = H5Pset_file_image(access, (void *)image, size) >= 0;
  if (works && image) file = H5Fopen("checkpoint", H5F_ACC_RDONLY, access);
  if (works && !image) file = H5Fcreate("checkpoint", H5F_ACC_TRUNC, creation, access);
  close_id(access);
  close_id(creation);
  return file;
}

// Times of objects are left out: the same checkpoint makes the same file.
static hid_t create_dataset(hid_t file, const char *path, hid_t type, hid_t space) {
  hid_t links = H5Pcreate(H5P_LINK_CREATE), options = H5Pcreate(H5P_DATASET_CREATE), dataset = -1;
  if (links >= 0 && options >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0 &&
      H5Pset_obj_track_times(options, false) >= 0)
    dataset = H5Dcreate2(file, path, type, space, links, options, H5P_DEFAULT);
  close_id(links);
  close_id(options);
  return dataset;
}

static hid_t text_type(size_t size) {
  hid_t type = H5Tcopy(H5T_C_S1);
  if (type >= 0 && H5Tset_size(type, size) < 0) close_id(type), type = -1;
  return type;
}

static bool write_unit(hid_t dataset, const char *unit) {
  hid_t type = text_type(strlen(unit) + 1), space = H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(dataset, "unit", type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool works = attribute >= 0 && H5Awrite(attribute, type, unit) >= 0;
  close_id(attribute);
  close_id(space);
  close_id(type);
  return works;
}

// An array of that shape; rank 0: one number.
static bool write_values(hid_t file, const char *path, FemCheckpointType type, int rank, const hsize_t *shape,
                         const void *values, const char *unit) {
  hid_t space = rank ? H5Screate_simple(rank, shape, NULL) : H5Screate(H5S_SCALAR);
  hid_t dataset = create_dataset(file, path, file_type(type), space);
  bool works = dataset >= 0 && write_unit(dataset, unit) &&
               (H5Sget_simple_extent_npoints(space) == 0 ||
                H5Dwrite(dataset, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  close_id(dataset);
  close_id(space);
  return works;
}

static bool write_text(hid_t file, const char *path, const char *text) {
  hid_t type = text_type(strlen(text) + 1), space = H5Screate(H5S_SCALAR);
  hid_t dataset = create_dataset(file, path, type, space);
  bool works = dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0;
  close_id(dataset);
  close_id(space);
  close_id(type);
  return works;
}

static void costs_of(const FemEffectCost *cost, double values[COST_COUNT]) {
  const double all[COST_COUNT] = {cost->force_s,
                                  cost->jacobian_s,
                                  cost->prepare_s,
                                  (double)cost->force_calls,
                                  (double)cost->jacobian_calls,
                                  (double)cost->prepare_calls,
                                  (double)cost->bytes_max};
  memcpy(values, all, sizeof all);
}

// Seconds and counts.
static bool are_costs(const double values[COST_COUNT]) {
  for (int k = 0; k < COST_COUNT; k++)
    if (!(values[k] >= 0 && values[k] < 0x1p63)) return false;
  return true;
}

static FemEffectCost cost_of(const double values[COST_COUNT]) {
  return (FemEffectCost){.force_s = values[0],
                         .jacobian_s = values[1],
                         .prepare_s = values[2],
                         .force_calls = (long long)values[3],
                         .jacobian_calls = (long long)values[4],
                         .prepare_calls = (long long)values[5],
                         .bytes_max = (long long)values[6]};
}

static bool write_effects(hid_t file, const FemCheckpoint *checkpoint) {
  bool works = true;
  for (int i = 0; i < checkpoint->effect_count && works; i++) {
    const FemCheckpointEffect *effect = &checkpoint->effects[i];
    char path[PATH_SIZE];
    double costs[COST_COUNT];
    const hsize_t count = effect->count, cost_count = COST_COUNT;
    costs_of(&checkpoint->so_far.effects[i].cost, costs);
    snprintf(path, sizeof path, "effects/%02d/name", i);
    works = write_text(file, path, effect->name);
    snprintf(path, sizeof path, "effects/%02d/history", i);
    works = works && write_values(file, path, FEM_REAL, 1, &count, effect->values, "the effect's own");
    snprintf(path, sizeof path, "effects/%02d/cost", i);
    works = works && write_values(file, path, FEM_REAL, 1, &cost_count, costs,
                                  "s, s, s, 1, 1, 1: force, jacobian, prepare; calls of each");
  }
  return works;
}

static bool write_format(hid_t file) {
  const int format = FORMAT;
  hid_t space = H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(file, "format", H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT);
  bool works = attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_INT, &format) >= 0;
  close_id(attribute);
  close_id(space);
  return works;
}

static bool has_format(hid_t file) {
  int format = 0;
  hid_t attribute = H5Aopen(file, "format", H5P_DEFAULT);
  if (attribute < 0) return false;
  hid_t space = H5Aget_space(attribute), type = H5Aget_type(attribute);
  bool works = H5Sget_simple_extent_npoints(space) == 1 && H5Tget_class(type) == H5T_INTEGER &&
               H5Aread(attribute, H5T_NATIVE_INT, &format) >= 0;
  close_id(type);
  close_id(space);
  close_id(attribute);
  return works && format == FORMAT;
}

static bool write_contents(hid_t file, const FemCheckpoint *checkpoint, const char *counters) {
  const hsize_t shape[2] = {(hsize_t)checkpoint->vertex_count, 3};
  bool works = write_format(file) &&
               write_values(file, "displacement", FEM_REAL, 2, shape, checkpoint->displacement, "m") &&
               write_values(file, "velocity", FEM_REAL, 2, shape, checkpoint->velocity, "m/s") &&
               write_text(file, "origin", checkpoint->origin ? checkpoint->origin : "") &&
               write_text(file, "interfaces", checkpoint->interfaces) &&
               write_text(file, "counters", counters);
  const hsize_t ledger_count = checkpoint->ledger_count;
  works = works &&
          write_values(file, "ledger", FEM_REAL, 1, &ledger_count, checkpoint->ledger, "the ledger's own");
  const hsize_t rest_count = checkpoint->rest_count;
  works =
      works && write_values(file, "rest", FEM_REAL, 1, &rest_count, checkpoint->rest, "of bodies at rest");
  int count;
  const FemCheckpointNumber *numbers = fem_checkpoint_numbers(&count);
  for (int k = 0; k < count && works; k++)
    works = write_values(file, numbers[k].path, numbers[k].type, 0, NULL,
                         (const char *)checkpoint + numbers[k].offset, numbers[k].unit);
  return works && write_effects(file, checkpoint);
}

// The HDF5 file as bytes; owned by the caller.
static bool print_image(const FemCheckpoint *checkpoint, const char *counters, void **image, size_t *size) {
  hid_t file = open_memory(NULL, 0);
  bool works =
      file >= 0 && write_contents(file, checkpoint, counters) && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
  ssize_t bytes = works ? H5Fget_file_image(file, NULL, 0) : -1;
  *image = bytes > 0 ? memory_zeroed((size_t)bytes, 1) : NULL;
  works = *image && H5Fget_file_image(file, *image, (size_t)bytes) == bytes;
  *size = works ? (size_t)bytes : 0;
  close_id(file);
  return works;
}

static void print_head(const void *image, size_t size, char head[HEAD_SIZE]) {
  char digest[DIGEST_TEXT];
  digest_print(digest_bytes(DIGEST_START, image, size), digest);
  memset(head, ' ', HEAD_SIZE);
  int used = snprintf(head, HEAD_SIZE, "%s %d\nbytes %zu\ndigest %s\nHDF5 follows: h5dump reads this file\n",
                      MAGIC, FORMAT, size, digest);
  head[used] = ' ';
  head[HEAD_SIZE - 1] = '\n';
}

static Status write_image(const char *path, const void *image, size_t size) {
  char head[HEAD_SIZE];
  FileWriter writer;
  print_head(image, size, head);
  TRY(file_begin(&writer, path));
  fwrite(head, 1, HEAD_SIZE, writer.stream);
  fwrite(image, 1, size, writer.stream);
  return file_commit(&writer);
}

Status fem_checkpoint_write(const FemCheckpoint *checkpoint, const char *path) {
  void *image = NULL;
  size_t size;
  char *counters = record_text_of(checkpoint->so_far.counters);
  if (!counters) return status_no_memory("a checkpoint");
  Status status = STATUS_OK;
  if (!print_image(checkpoint, counters, &image, &size))
    status = fail_hdf5(STATUS_MEMORY, path, "out of memory: the checkpoint could not be put together");
  if (!status) status = write_image(path, image, size);
  memory_free(image);
  memory_free(counters);
  forget_buffers();
  return status;
}

static Status check_head(const char *path, const char *text, size_t size, int *format) {
  char digest[DIGEST_TEXT], found[DIGEST_TEXT] = "";
  size_t bytes = 0;
  if (size < sizeof MAGIC || memcmp(text, MAGIC, sizeof MAGIC - 1) != 0)
    return status_fail(STATUS_INPUT, "%s: is no checkpoint; `tetlap run` writes one named checkpoint.h5",
                       path);
  if (size <= HEAD_SIZE)
    return status_fail(STATUS_INPUT, "%s: is truncated: it ends after %zu bytes", path, size);
  if (sscanf(text + sizeof MAGIC - 1, " %d bytes %zu digest %16s", format, &bytes, found) != 3)
    return status_fail(STATUS_INPUT, "%s: is damaged: its first lines do not say size and digest", path);
  if (bytes != size - HEAD_SIZE)
    return status_fail(STATUS_INPUT, "%s: is truncated or damaged: it has %zu bytes, %zu were written", path,
                       size, bytes + HEAD_SIZE);
  digest_print(digest_bytes(DIGEST_START, text + HEAD_SIZE, bytes), digest);
  char head[HEAD_SIZE];
  print_head(text + HEAD_SIZE, bytes, head);
  if (strcmp(digest, found) != 0 || (*format == FORMAT && memcmp(head, text, HEAD_SIZE) != 0))
    return status_fail(STATUS_INPUT, "%s: is damaged: its content does not agree with its digest", path);
  return STATUS_OK;
}

static Status fail_lacking(const char *path, const char *what) {
  H5Eclear2(H5E_DEFAULT);
  return status_fail(STATUS_INPUT, "%s: is no whole checkpoint: it has no fitting '%s'", path, what);
}

// Whether the file holds all the values, of which there cannot be more than it has bytes.
static bool is_whole(hid_t file, hid_t dataset, hid_t type, hid_t space) {
  hsize_t bytes = 0, size = H5Tget_size(type);
  hssize_t count = H5Sget_simple_extent_npoints(space);
  return H5Fget_filesize(file, &bytes) >= 0 && size > 0 && count >= 0 && (hsize_t)count <= bytes / size &&
         H5Dget_storage_size(dataset) == size * (hsize_t)count;
}

// Opens what is there in that class and rank, stored whole in the file; −1 otherwise.
static hid_t open_dataset(hid_t file, const char *path, H5T_class_t class, int rank, hsize_t *shape) {
  hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
  if (dataset < 0) return -1;
  hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  bool fits = H5Tget_class(type) == class && H5Tis_variable_str(type) <= 0 &&
              H5Sget_simple_extent_ndims(space) == rank &&
              H5Sget_simple_extent_dims(space, shape, NULL) == rank;
  if (fits) fits = is_whole(file, dataset, type, space);
  close_id(type);
  close_id(space);
  if (fits) return dataset;
  close_id(dataset);
  return -1;
}

static bool read_number(hid_t file, const char *path, FemCheckpointType type, void *value) {
  hid_t dataset = open_dataset(file, path, type == FEM_REAL ? H5T_FLOAT : H5T_INTEGER, 0, NULL);
  bool works = dataset >= 0 && H5Dread(dataset, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0;
  close_id(dataset);
  return works;
}

// A new array in the shape that it has: one number of `shape` a rank. `name` is what the file lacks if not.
static Status read_array(hid_t file, const char *path, const char *name, int rank, hsize_t *shape,
                         double **values) {
  *values = NULL;
  hid_t dataset = open_dataset(file, name, H5T_FLOAT, rank, shape);
  if (dataset < 0) return fail_lacking(path, name);
  size_t count = shape[0] * (rank == 2 ? shape[1] : 1);
  *values = memory_zeroed(count, sizeof **values);
  bool works = *values && (count == 0 ||
                           H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) >= 0);
  close_id(dataset);
  if (!*values) return status_no_memory("a checkpoint");
  return works ? STATUS_OK : fail_lacking(path, name);
}

static Status read_text(hid_t file, const char *path, const char *name, char **text) {
  *text = NULL;
  hid_t dataset = open_dataset(file, name, H5T_STRING, 0, NULL);
  if (dataset < 0) return fail_lacking(path, name);
  hid_t type = H5Dget_type(dataset);
  size_t size = H5Tget_size(type);
  *text = memory_zeroed(size + 1, 1);
  bool works = *text && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *text) >= 0;
  close_id(type);
  close_id(dataset);
  if (!*text) return status_no_memory("a checkpoint");
  return works ? STATUS_OK : fail_lacking(path, name);
}

static Status read_effect(hid_t file, FemCheckpoint *checkpoint, int i, const char *path) {
  FemCheckpointEffect *effect = &checkpoint->effects[i];
  char place[PATH_SIZE], *name;
  hsize_t count = 0, cost_count = 0;
  double *costs;
  snprintf(place, sizeof place, "effects/%02d/history", i);
  checkpoint->effect_count = i + 1; // from here on it is destroyed
  TRY(read_array(file, path, place, 1, &count, &effect->values));
  effect->count = (size_t)count;
  snprintf(place, sizeof place, "effects/%02d/name", i);
  Status status = read_text(file, path, place, &name);
  if (!status) snprintf(effect->name, sizeof effect->name, "%s", name);
  memory_free(name);
  TRY(status);
  snprintf(place, sizeof place, "effects/%02d/cost", i);
  status = read_array(file, path, place, 1, &cost_count, &costs);
  if (!status && !(cost_count == COST_COUNT && are_costs(costs))) status = fail_lacking(path, place);
  if (!status) checkpoint->so_far.effects[i].cost = cost_of(costs);
  memory_free(costs);
  return status;
}

static Status read_effects(hid_t file, FemCheckpoint *checkpoint, const char *path) {
  if (H5Lexists(file, "effects", H5P_DEFAULT) <= 0) return STATUS_OK;
  for (int i = 0; i < FEM_MAX_EFFECTS; i++) {
    char name[PATH_SIZE];
    snprintf(name, sizeof name, "effects/%02d", i);
    if (H5Lexists(file, name, H5P_DEFAULT) <= 0) return STATUS_OK;
    TRY(read_effect(file, checkpoint, i, path));
  }
  return STATUS_OK;
}

static Status read_counters(hid_t file, FemCheckpoint *checkpoint, const char *path) {
  char *counters;
  Status status = read_text(file, path, "counters", &counters);
  if (!status) status = record_parse(&checkpoint->so_far.counters, counters, strlen(counters), path);
  memory_free(counters);
  return status;
}

static Status read_arrays(hid_t file, FemCheckpoint *checkpoint, const char *path) {
  hsize_t shape[2], again[2];
  TRY(read_array(file, path, "displacement", 2, shape, &checkpoint->displacement));
  if (shape[1] != 3) return fail_lacking(path, "displacement");
  TRY(read_array(file, path, "velocity", 2, again, &checkpoint->velocity));
  if (again[0] != shape[0] || again[1] != 3) return fail_lacking(path, "velocity");
  checkpoint->vertex_count = (int)shape[0];
  TRY(read_array(file, path, "ledger", 1, shape, &checkpoint->ledger));
  checkpoint->ledger_count = (size_t)shape[0];
  TRY(read_array(file, path, "rest", 1, shape, &checkpoint->rest));
  checkpoint->rest_count = (size_t)shape[0];
  TRY(read_text(file, path, "interfaces", &checkpoint->interfaces));
  return read_text(file, path, "origin", &checkpoint->origin);
}

static Status check_numbers(const FemCheckpoint *checkpoint, const char *path) {
  if (!(checkpoint->time >= 0) || !(checkpoint->step >= 0)) return fail_lacking(path, "time");
  if (checkpoint->next_frame < 0) return fail_lacking(path, "next_frame");
  if (checkpoint->history.size < 0) return fail_lacking(path, "history/size");
  return STATUS_OK;
}

static Status read_contents(hid_t file, FemCheckpoint *checkpoint, const char *path) {
  TRY(read_arrays(file, checkpoint, path));
  int count;
  const FemCheckpointNumber *numbers = fem_checkpoint_numbers(&count);
  for (int k = 0; k < count; k++)
    if (!read_number(file, numbers[k].path, numbers[k].type, (char *)checkpoint + numbers[k].offset))
      return fail_lacking(path, numbers[k].path);
  TRY(check_numbers(checkpoint, path));
  TRY(read_counters(file, checkpoint, path));
  return read_effects(file, checkpoint, path);
}

// Of another format: which program wrote it is in the origin, if that can be read.
static Status fail_format(hid_t file, const char *path, int format) {
  char *text = NULL;
  Record *origin = NULL;
  if (file >= 0 && read_text(file, path, "origin", &text) == STATUS_OK)
    (void)record_parse(&origin, text, strlen(text), path);
  const char *program = record_find_text(origin, "program");
  int length = program ? (int)strcspn(program, ";") : 0;
  status_fail(
      STATUS_INPUT,
      "%s: is of format %d, written by %.*s; this program reads format %d: resume it with the program that "
      "wrote it, or start again with `tetlap run`",
      path, format, program ? length : 99, program ? program : "another program", FORMAT);
  memory_free(text);
  record_destroy(origin);
  return STATUS_INPUT;
}

Status fem_checkpoint_read(FemCheckpoint *checkpoint, const char *path) {
  char *text;
  size_t size;
  int format = 0;
  *checkpoint = (FemCheckpoint){0};
  TRY(file_read(path, &text, &size));
  Status status = check_head(path, text, size, &format);
  hid_t file = status ? -1 : open_memory(text + HEAD_SIZE, size - HEAD_SIZE);
  if (!status && format != FORMAT) status = fail_format(file, path, format);
  if (!status && file < 0) status = fail_hdf5(STATUS_INPUT, path, "is damaged");
  if (!status && !has_format(file)) status = fail_lacking(path, "format");
  if (!status) status = read_contents(file, checkpoint, path);
  close_id(file);
  forget_buffers();
  memory_free(text);
  if (status) fem_checkpoint_destroy(checkpoint);
  return status;
}
