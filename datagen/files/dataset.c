// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/files/dataset.h"

#include <hdf5.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "datagen/files/hdf5.h"

static const char *const FORMAT = "tetlap pairs";
static const char *const UNITS =
    "coordinates and centroid in edges of the unit cube, volume in its cube, gradient in its square";
static const long long FORMAT_VERSION = 1;

typedef enum Column { COORDINATES, STATUS, KIND, VOLUME, GRADIENT, CENTROID, COLUMN_COUNT } Column;

typedef struct ColumnLayout {
  const char *name;
  int rank;
  hsize_t row[3]; // size of one pair's entry
  bool is_real;   // float64, else uint8
} ColumnLayout;

static const ColumnLayout layouts[COLUMN_COUNT] = {
    [COORDINATES] = {"coordinates", 4, {2, 4, 3}, true},
    [STATUS] = {"status", 1, {0}, false},
    [KIND] = {"kind", 1, {0}, false},
    [VOLUME] = {"volume", 1, {0}, true},
    [GRADIENT] = {"gradient", 4, {2, 4, 3}, true},
    [CENTROID] = {"centroid", 2, {3}, true},
};

static void *column_of(const DatagenPairs *pairs, int column) {
  switch ((Column)column) {
  case COORDINATES:
    return pairs->coordinates;
  case STATUS:
    return pairs->status;
  case KIND:
    return pairs->kind;
  case VOLUME:
    return pairs->volume;
  case GRADIENT:
    return pairs->gradient;
  case CENTROID:
    return pairs->centroid;
  case COLUMN_COUNT:
    break;
  }
  return NULL;
}

static hid_t memory_type(int column) {
  return layouts[column].is_real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT8;
}

static void shape_of(int column, hsize_t count, hsize_t shape[4]) {
  shape[0] = count;
  for (int d = 1; d < layouts[column].rank; d++) shape[d] = layouts[column].row[d - 1];
}

// Moves rows between an array and the file; whether it worked.
static bool transfer(hid_t dataset, int column, hsize_t first, hsize_t count, void *array, bool is_write) {
  hsize_t start[4] = {first, 0, 0, 0}, shape[4];
  shape_of(column, count, shape);
  hid_t in_file = H5Dget_space(dataset), in_memory = H5Screate_simple(layouts[column].rank, shape, NULL);
  bool works = in_file >= 0 && in_memory >= 0 &&
               H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, NULL, shape, NULL) >= 0;
  if (works && is_write)
    works = H5Dwrite(dataset, memory_type(column), in_memory, in_file, H5P_DEFAULT, array) >= 0;
  else if (works)
    works = H5Dread(dataset, memory_type(column), in_memory, in_file, H5P_DEFAULT, array) >= 0;
  if (in_memory >= 0) H5Sclose(in_memory);
  if (in_file >= 0) H5Sclose(in_file);
  return works;
}

typedef enum FieldType { FIELD_INTEGER, FIELD_SEED, FIELD_REAL, FIELD_TEXT, FIELD_COUNTS } FieldType;

typedef struct Field {
  const char *name;
  FieldType type;
  size_t offset; // in DatagenInfo
  size_t size;   // of the text with its end
} Field;

// What a file says of itself, beside its format: written and read by this table.
static const Field fields[] = {
    {"generator_version", FIELD_INTEGER, offsetof(DatagenInfo, generator_version), 0},
    {"program", FIELD_TEXT, offsetof(DatagenInfo, program), DATAGEN_PROGRAM_TEXT},
    {"seed", FIELD_SEED, offsetof(DatagenInfo, seed), 0},
    {"law", FIELD_TEXT, offsetof(DatagenInfo, law), DATAGEN_NAME_TEXT},
    {"mix", FIELD_TEXT, offsetof(DatagenInfo, mix), DATAGEN_MIX_TEXT},
    {"volume_law", FIELD_TEXT, offsetof(DatagenInfo, volume_law), DATAGEN_VOLUME_TEXT},
    {"swap_share", FIELD_REAL, offsetof(DatagenInfo, swap_share), 0},
    {"label", FIELD_TEXT, offsetof(DatagenInfo, label), DATAGEN_NAME_TEXT},
    {"total", FIELD_INTEGER, offsetof(DatagenInfo, total), 0},
    {"first", FIELD_INTEGER, offsetof(DatagenInfo, first), 0},
    {"planned", FIELD_INTEGER, offsetof(DatagenInfo, planned), 0},
    {"kind_counts", FIELD_COUNTS, offsetof(DatagenInfo, kind_counts), 0},
    {"attempts", FIELD_COUNTS, offsetof(DatagenInfo, attempts), 0},
};
enum { FIELD_COUNT = sizeof fields / sizeof *fields };

static bool write_attribute(hid_t file, const char *name, hid_t type, hsize_t count, const void *value) {
  hid_t space = count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool works = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
  if (attribute >= 0) works = H5Aclose(attribute) >= 0 && works;
  if (space >= 0) H5Sclose(space);
  return works;
}

static bool write_text(hid_t file, const char *name, const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1);
  bool works =
      type >= 0 && H5Tset_size(type, strlen(text) + 1) >= 0 && write_attribute(file, name, type, 0, text);
  if (type >= 0) H5Tclose(type);
  return works;
}

static bool write_field(hid_t file, const Field *field, const DatagenInfo *info) {
  const void *value = (const char *)info + field->offset;
  switch (field->type) {
  case FIELD_INTEGER:
    return write_attribute(file, field->name, H5T_NATIVE_LLONG, 0, value);
  case FIELD_SEED:
    return write_attribute(file, field->name, H5T_NATIVE_UINT64, 0, value);
  case FIELD_REAL:
    return write_attribute(file, field->name, H5T_NATIVE_DOUBLE, 0, value);
  case FIELD_COUNTS:
    return write_attribute(file, field->name, H5T_NATIVE_LLONG, DATAGEN_KIND_COUNT, value);
  case FIELD_TEXT:
    return write_text(file, field->name, value);
  }
  return false;
}

static bool write_fields(hid_t file, const DatagenInfo *info) {
  char kinds[DATAGEN_MIX_TEXT] = "";
  size_t used = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    text_append(kinds, sizeof kinds, &used, "%s%s", k ? " " : "", datagen_kind_info(k)->name);
  bool works = write_text(file, "format", FORMAT) && write_text(file, "kinds", kinds) &&
               write_text(file, "units", UNITS) &&
               write_attribute(file, "format_version", H5T_NATIVE_LLONG, 0, &FORMAT_VERSION);
  for (int f = 0; f < FIELD_COUNT && works; f++) works = write_field(file, &fields[f], info);
  return works;
}

struct DatagenWriter {
  FileWriter place; // the temporary name and the final one
  hid_t file, datasets[COLUMN_COUNT];
  DatagenInfo info;
};

DatagenInfo datagen_dataset_info_of_plan(const DatagenPlan *plan, const char *program, long long first,
                                         long long planned) {
  DatagenInfo info;
  memset(&info, 0, sizeof info);
  info.generator_version = DATAGEN_GENERATOR_VERSION;
  snprintf(info.program, sizeof info.program, "%s", program);
  info.seed = plan->seed;
  snprintf(info.law, sizeof info.law, "%s", plan->law.name);
  datagen_law_print_mix(plan->law.mix, info.mix, sizeof info.mix);
  datagen_volume_law_print(&plan->law.volume, info.volume_law, sizeof info.volume_law);
  info.swap_share = plan->law.swap_share;
  snprintf(info.label, sizeof info.label, "%s", datagen_plan_label_name(plan->label));
  info.total = plan->count;
  info.first = first;
  info.planned = planned;
  info.has_gradient = plan->wants_gradient;
  info.has_centroid = true;
  return info;
}

static bool is_wanted(const DatagenInfo *info, int column) {
  return column == GRADIENT ? info->has_gradient : column == CENTROID ? info->has_centroid : true;
}

// x − x is 0 for finite x, else NaN; the sum has no branch.
static bool are_finite(const double *values, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += values[i] - values[i];
  return sum == 0;
}

// What is impossible about pair i, of the arrays that are there; NULL: nothing.
static const char *find_fault(const DatagenPairs *pairs, size_t i) {
  if (pairs->coordinates && !are_finite(pairs->coordinates + 24 * i, 24)) return "a coordinate is not finite";
  if (pairs->gradient && !are_finite(pairs->gradient + 24 * i, 24)) return "a derivative is not finite";
  if (pairs->centroid && !are_finite(pairs->centroid + 3 * i, 3)) return "its centroid is not finite";
  if (pairs->status && pairs->status[i] > 1) return "its status is neither 0 nor 1";
  if (pairs->kind && !datagen_kind_info(pairs->kind[i])) return "its kind has no name";
  if (pairs->volume && !(pairs->volume[i] >= 0 && isfinite(pairs->volume[i])))
    return "its volume is negative or not finite";
  if (pairs->volume && pairs->status && pairs->volume[i] > 0 && !pairs->status[i])
    return "it has a volume, and its status says disjoint";
  return NULL;
}

static Status check_pairs(const char *path, long long first, size_t count, const DatagenPairs *pairs) {
  for (size_t i = 0; i < count; i++) {
    const char *fault = find_fault(pairs, i);
    if (fault) return status_fail(STATUS_INPUT, "%s: pair %lld: %s", path, first + (long long)i, fault);
  }
  return STATUS_OK;
}

// Times are left out: the same pairs make the same file.
static hid_t create_file(const char *path) {
  hid_t options = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_obj_track_times(options, false);
  hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, options, H5P_DEFAULT);
  if (options >= 0) H5Pclose(options);
  return file;
}

// Rows of a chunk: a file that is known to stay small has no room for more.
static hsize_t chunk_rows(const DatagenInfo *info) {
  bool is_small = info->planned > 0 && info->planned < DATAGEN_DATASET_CHUNK;
  return is_small ? (hsize_t)info->planned : DATAGEN_DATASET_CHUNK;
}

static hid_t create_column(hid_t file, int column, hsize_t rows) {
  hsize_t now[4], later[4], chunk[4];
  shape_of(column, 0, now);
  shape_of(column, H5S_UNLIMITED, later);
  shape_of(column, rows, chunk);
  const int rank = layouts[column].rank;
  hid_t space = H5Screate_simple(rank, now, later), options = H5Pcreate(H5P_DATASET_CREATE), dataset = -1;
  hid_t type = layouts[column].is_real ? H5T_IEEE_F64LE : H5T_STD_U8LE;
  if (space >= 0 && options >= 0 && H5Pset_chunk(options, rank, chunk) >= 0 &&
      H5Pset_fletcher32(options) >= 0 && H5Pset_obj_track_times(options, false) >= 0)
    dataset = H5Dcreate2(file, layouts[column].name, type, space, H5P_DEFAULT, options, H5P_DEFAULT);
  if (options >= 0) H5Pclose(options);
  if (space >= 0) H5Sclose(space);
  return dataset;
}

static Status create_contents(DatagenWriter *writer) {
  const char *path = writer->place.path;
  writer->file = create_file(writer->place.temporary);
  if (writer->file < 0) return datagen_hdf5_fail(STATUS_IO, path, "cannot be written");
  for (int c = 0; c < COLUMN_COUNT; c++) {
    if (!is_wanted(&writer->info, c)) continue;
    writer->datasets[c] = create_column(writer->file, c, chunk_rows(&writer->info));
    if (writer->datasets[c] < 0) return datagen_hdf5_fail(STATUS_IO, path, "cannot be written");
  }
  return STATUS_OK;
}

Status datagen_dataset_writer_begin(DatagenWriter **result, const char *path, const DatagenInfo *info) {
  datagen_hdf5_begin();
  *result = NULL;
  DatagenWriter *writer = memory_zeroed(1, sizeof *writer);
  if (!writer) return status_no_memory("a data set");
  writer->file = -1;
  for (int c = 0; c < COLUMN_COUNT; c++) writer->datasets[c] = -1;
  writer->info = *info;
  writer->info.count = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) writer->info.kind_counts[k] = writer->info.attempts[k] = 0;
  Status status = file_begin(&writer->place, path);
  if (!status) status = create_contents(writer);
  if (status)
    datagen_dataset_writer_abandon(writer);
  else
    *result = writer;
  return status;
}

Status datagen_dataset_writer_append(DatagenWriter *writer, const DatagenPairs *pairs, size_t count,
                                     const long long *attempts) {
  DatagenInfo *info = &writer->info;
  const hsize_t first = (hsize_t)info->count;
  bool works = true;
  datagen_hdf5_begin();
  TRY(check_pairs(writer->place.path, info->count, count, pairs));
  for (int c = 0; c < COLUMN_COUNT && works; c++) {
    if (!is_wanted(info, c)) continue;
    hsize_t shape[4];
    shape_of(c, first + count, shape);
    works = H5Dset_extent(writer->datasets[c], shape) >= 0 &&
            transfer(writer->datasets[c], c, first, count, column_of(pairs, c), true);
  }
  if (!works || H5Fflush(writer->file, H5F_SCOPE_LOCAL) < 0)
    return datagen_hdf5_fail(STATUS_IO, writer->place.path, "writing failed");
  info->count += (long long)count;
  for (size_t i = 0; i < count; i++) info->kind_counts[pairs->kind[i]]++;
  for (int k = 0; k < DATAGEN_KIND_COUNT && attempts; k++) info->attempts[k] += attempts[k];
  return STATUS_OK;
}

long long datagen_dataset_writer_count(const DatagenWriter *writer) {
  return writer->info.count;
}

// Closes all that is open; whether everything reached the file.
static bool close_contents(DatagenWriter *writer) {
  bool works = true;
  for (int c = 0; c < COLUMN_COUNT; c++) {
    if (writer->datasets[c] >= 0) works = H5Dclose(writer->datasets[c]) >= 0 && works;
    writer->datasets[c] = -1;
  }
  if (writer->file >= 0) works = H5Fclose(writer->file) >= 0 && works;
  writer->file = -1;
  return works;
}

Status datagen_dataset_writer_commit(DatagenWriter *writer) {
  DatagenInfo *info = &writer->info;
  datagen_hdf5_begin();
  if (!info->planned) info->planned = info->total = info->count;
  bool works = write_fields(writer->file, info);
  works = close_contents(writer) && works;
  Status status = works ? STATUS_OK : datagen_hdf5_fail(STATUS_IO, writer->place.path, "writing failed");
  if (!status) status = file_commit(&writer->place);
  datagen_dataset_writer_abandon(writer);
  return status;
}

void datagen_dataset_writer_abandon(DatagenWriter *writer) {
  if (!writer) return;
  close_contents(writer);
  file_abandon(&writer->place);
  memory_free(writer);
}

struct DatagenDataset {
  char *path; // owned
  hid_t file, datasets[COLUMN_COUNT];
  DatagenInfo info;
};

static Status fail_foreign(const char *path, const char *what) {
  return status_fail(STATUS_INPUT,
                     "%s is not a data set of pairs: %s; `tetlap datagen` makes one, `tetlap dataset import` "
                     "one of your own pairs",
                     path, what);
}

// Opens an attribute of the expected class; −1 with a message in `what` (160 characters) otherwise.
static hid_t open_attribute(hid_t file, const char *name, H5T_class_t class, char *what) {
  if (H5Aexists(file, name) <= 0) {
    snprintf(what, 160, "it has no attribute '%s'", name);
    return -1;
  }
  hid_t attribute = H5Aopen(file, name, H5P_DEFAULT), type = attribute < 0 ? -1 : H5Aget_type(attribute);
  bool fits = type >= 0 && H5Tget_class(type) == class && H5Tis_variable_str(type) <= 0;
  if (type >= 0) H5Tclose(type);
  if (fits) return attribute;
  if (attribute >= 0) H5Aclose(attribute);
  snprintf(what, 160, "its attribute '%s' is of another type", name);
  return -1;
}

static bool read_text(hid_t file, const char *name, char *text, size_t size, char *what) {
  hid_t attribute = open_attribute(file, name, H5T_STRING, what);
  if (attribute < 0) return false;
  hid_t type = H5Aget_type(attribute);
  bool fits = H5Tget_size(type) <= size && H5Aget_storage_size(attribute) <= size;
  bool works = fits && H5Aread(attribute, type, text) >= 0;
  if (works) text[size - 1] = 0;
  H5Tclose(type);
  H5Aclose(attribute);
  if (!works) snprintf(what, 160, "its attribute '%s' cannot be read or is too long", name);
  return works;
}

// Up to `most` numbers; those that the file lacks stay as they are.
static bool read_numbers(hid_t file, const char *name, H5T_class_t class, hid_t type, int most, void *values,
                         char *what) {
  hid_t attribute = open_attribute(file, name, class, what);
  if (attribute < 0) return false;
  hid_t space = H5Aget_space(attribute);
  hssize_t count = H5Sget_simple_extent_npoints(space);
  bool works = count >= 1 && count <= most && H5Aread(attribute, type, values) >= 0;
  H5Sclose(space);
  H5Aclose(attribute);
  if (!works)
    snprintf(what, 160, "its attribute '%s' has %lld numbers, not 1 to %d", name, (long long)count, most);
  return works;
}

static bool read_field(hid_t file, const Field *field, DatagenInfo *info, char *what) {
  void *value = (char *)info + field->offset;
  switch (field->type) {
  case FIELD_INTEGER:
    return read_numbers(file, field->name, H5T_INTEGER, H5T_NATIVE_LLONG, 1, value, what);
  case FIELD_SEED:
    return read_numbers(file, field->name, H5T_INTEGER, H5T_NATIVE_UINT64, 1, value, what);
  case FIELD_REAL:
    return read_numbers(file, field->name, H5T_FLOAT, H5T_NATIVE_DOUBLE, 1, value, what);
  case FIELD_COUNTS:
    return read_numbers(file, field->name, H5T_INTEGER, H5T_NATIVE_LLONG, DATAGEN_KIND_COUNT, value, what);
  case FIELD_TEXT:
    return read_text(file, field->name, value, field->size, what);
  }
  return false;
}

static Status read_info(DatagenDataset *dataset) {
  char what[160] = "", format[32] = "";
  long long version = 0;
  if (!read_text(dataset->file, "format", format, sizeof format, what))
    return fail_foreign(dataset->path, what);
  if (strcmp(format, FORMAT) != 0) return fail_foreign(dataset->path, "its attribute 'format' names another");
  if (!read_numbers(dataset->file, "format_version", H5T_INTEGER, H5T_NATIVE_LLONG, 1, &version, what))
    return fail_foreign(dataset->path, what);
  if (version != FORMAT_VERSION)
    return status_fail(STATUS_INPUT, "%s: has version %lld of the format, this program reads version %lld",
                       dataset->path, version, FORMAT_VERSION);
  for (int f = 0; f < FIELD_COUNT; f++)
    if (!read_field(dataset->file, &fields[f], &dataset->info, what))
      return fail_foreign(dataset->path, what);
  return STATUS_OK;
}

// Whether the array is there in the shape and type that it must have; its number of pairs.
static bool check_column(hid_t dataset, int column, long long *count) {
  hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
  hsize_t shape[4] = {0}, wanted[4];
  const int rank = layouts[column].rank;
  bool fits = space >= 0 && type >= 0 && H5Sget_simple_extent_ndims(space) == rank &&
              H5Sget_simple_extent_dims(space, shape, NULL) == rank;
  shape_of(column, shape[0], wanted);
  for (int d = 1; d < rank && fits; d++) fits = shape[d] == wanted[d];
  if (fits && layouts[column].is_real) fits = H5Tget_class(type) == H5T_FLOAT && H5Tget_size(type) == 8;
  if (fits && !layouts[column].is_real) fits = H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) == 1;
  *count = (long long)shape[0];
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  return fits;
}

// The bytes that `count` pairs take at least.
static double bytes_of(int column, long long count) {
  double size = layouts[column].is_real ? 8 : 1;
  for (int d = 1; d < layouts[column].rank; d++) size *= (double)layouts[column].row[d - 1];
  return size * (double)count;
}

static Status open_column(DatagenDataset *dataset, int column) {
  const char *name = layouts[column].name, *path = dataset->path;
  if (H5Lexists(dataset->file, name, H5P_DEFAULT) <= 0) {
    if (column == GRADIENT || column == CENTROID) return STATUS_OK;
    return status_fail(STATUS_INPUT, "%s: has no array '%s'", path, name);
  }
  dataset->datasets[column] = H5Dopen2(dataset->file, name, H5P_DEFAULT);
  if (dataset->datasets[column] < 0)
    return datagen_hdf5_fail(STATUS_INPUT, path, "an array cannot be opened");
  long long count;
  if (!check_column(dataset->datasets[column], column, &count))
    return status_fail(STATUS_INPUT, "%s: array '%s' should be %s of shape (n%s)", path, name,
                       layouts[column].is_real ? "float64" : "8-bit integers",
                       layouts[column].rank == 4   ? ", 2, 4, 3"
                       : layouts[column].rank == 2 ? ", 3"
                                                   : "");
  if (column == COORDINATES) dataset->info.count = count;
  if (count != dataset->info.count)
    return status_fail(STATUS_INPUT, "%s: array '%s' has %lld pairs, 'coordinates' has %lld", path, name,
                       count, dataset->info.count);
  if ((double)H5Dget_storage_size(dataset->datasets[column]) < bytes_of(column, count))
    return status_fail(STATUS_INPUT, "%s: array '%s' claims %lld pairs, but not all of them are in the file",
                       path, name, count);
  if (column == GRADIENT) dataset->info.has_gradient = true;
  if (column == CENTROID) dataset->info.has_centroid = true;
  return STATUS_OK;
}

static Status check_counts(const DatagenDataset *dataset) {
  const DatagenInfo *info = &dataset->info;
  long long left = info->count;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    if (info->kind_counts[k] < 0 || info->kind_counts[k] > left)
      return status_fail(STATUS_INPUT, "%s: holds %lld pairs, but counts %lld of a kind", dataset->path,
                         info->count, info->kind_counts[k]);
    left -= info->kind_counts[k];
  }
  if (left > 0)
    return status_fail(STATUS_INPUT, "%s: holds %lld pairs, but its counts of kinds sum to %lld",
                       dataset->path, info->count, info->count - left);
  // as differences: a sum might be more than fits
  if (info->first < 0 || info->planned < info->count || info->total < info->planned ||
      info->total - info->planned < info->first)
    return status_fail(STATUS_INPUT, "%s: claims %lld pairs from %lld on of %lld, and holds %lld",
                       dataset->path, info->planned, info->first, info->total, info->count);
  return STATUS_OK;
}

static Status open_contents(DatagenDataset *dataset) {
  FILE *stream = fopen(dataset->path, "rb");
  if (!stream) {
    char *text;
    size_t size;
    return file_read(dataset->path, &text, &size); // says why
  }
  fclose(stream);
  if (H5Fis_hdf5(dataset->path) <= 0) {
    H5Eclear2(H5E_DEFAULT);
    return fail_foreign(dataset->path, "it is not an HDF5 file");
  }
  dataset->file = H5Fopen(dataset->path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (dataset->file < 0) return datagen_hdf5_fail(STATUS_INPUT, dataset->path, "is damaged");
  TRY(read_info(dataset));
  for (int c = 0; c < COLUMN_COUNT; c++) TRY(open_column(dataset, c));
  return check_counts(dataset);
}

Status datagen_dataset_open(DatagenDataset **result, const char *path) {
  datagen_hdf5_begin();
  *result = NULL;
  DatagenDataset *dataset = memory_zeroed(1, sizeof *dataset);
  if (!dataset) return status_no_memory("a data set");
  dataset->file = -1;
  for (int c = 0; c < COLUMN_COUNT; c++) dataset->datasets[c] = -1;
  dataset->path = memory_copy(path, strlen(path) + 1, 1);
  Status status = dataset->path ? open_contents(dataset) : status_no_memory("a file name");
  if (status)
    datagen_dataset_close(dataset);
  else
    *result = dataset;
  return status;
}

const DatagenInfo *datagen_dataset_info(const DatagenDataset *dataset) {
  return &dataset->info;
}

Status datagen_dataset_read(DatagenDataset *dataset, long long first, size_t count,
                            const DatagenPairs *pairs) {
  const DatagenInfo *info = &dataset->info;
  datagen_hdf5_begin();
  if (first < 0 || first > info->count || (long long)count > info->count - first)
    return status_fail(STATUS_INPUT, "%s: pairs %lld to %lld were requested, it has %lld", dataset->path,
                       first, first + (long long)count - 1, info->count);
  if (pairs->gradient && !info->has_gradient)
    return status_fail(STATUS_INPUT, "%s: has no gradients; make it with `tetlap datagen --gradient exact`",
                       dataset->path);
  for (int c = 0; c < COLUMN_COUNT && count > 0; c++) {
    void *array = column_of(pairs, c);
    if (c == CENTROID && !info->has_centroid) continue;
    if (array && !transfer(dataset->datasets[c], c, (hsize_t)first, count, array, false)) {
      char what[80];
      snprintf(what, sizeof what, "array '%s' is damaged", layouts[c].name);
      return datagen_hdf5_fail(STATUS_INPUT, dataset->path, what);
    }
  }
  return check_pairs(dataset->path, first, count, pairs);
}

void datagen_dataset_close(DatagenDataset *dataset) {
  if (!dataset) return;
  for (int c = 0; c < COLUMN_COUNT; c++)
    if (dataset->datasets[c] >= 0) H5Dclose(dataset->datasets[c]);
  if (dataset->file >= 0) H5Fclose(dataset->file);
  memory_free(dataset->path);
  memory_free(dataset);
}
