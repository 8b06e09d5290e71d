// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/files/array.h"

#include <hdf5.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "datagen/files/hdf5.h"

enum { PAIR_SIZE = 24, MOST_RANK = 8, MOST_NAME = 256 };

struct DatagenArray {
  char *path; // owned
  hid_t file, dataset;
  int rank;
  hsize_t shape[MOST_RANK];
};

// The data sets of the root group: how many, and the last one's name.
typedef struct Members {
  int count;
  char name[MOST_NAME];
} Members;

static herr_t count_member(hid_t group, const char *name, const H5L_info_t *info, void *data) {
  (void)info;
  Members *members = data;
  hid_t object = H5Oopen(group, name, H5P_DEFAULT);
  if (object < 0) return 0; // a link that leads nowhere
  if (H5Iget_type(object) == H5I_DATASET && strlen(name) < MOST_NAME) {
    strcpy(members->name, name);
    members->count++;
  }
  H5Oclose(object);
  return 0;
}

static Status find_name(const DatagenArray *array, char name[MOST_NAME]) {
  static const char *const usual[] = {"coordinates", "pairs"};
  for (int u = 0; u < 2; u++)
    if (H5Lexists(array->file, usual[u], H5P_DEFAULT) > 0) {
      strcpy(name, usual[u]);
      return STATUS_OK;
    }
  Members members = {0};
  if (H5Literate(array->file, H5_INDEX_NAME, H5_ITER_INC, NULL, count_member, &members) < 0 ||
      members.count != 1)
    return status_fail(STATUS_INPUT, "%s: has no array 'coordinates' of shape (n, 24) or (n, 2, 4, 3)",
                       array->path);
  strcpy(name, members.name);
  return STATUS_OK;
}

// Numbers of a row: the product of all lengths but the first; 0: another one than a pair's.
static hsize_t row_size(const DatagenArray *array) {
  hsize_t size = 1;
  for (int d = 1; d < array->rank; d++) size = array->shape[d] <= PAIR_SIZE ? size * array->shape[d] : 0;
  return size == PAIR_SIZE ? size : 0;
}

static Status check_shape(DatagenArray *array, const char *name) {
  hid_t space = H5Dget_space(array->dataset), type = H5Dget_type(array->dataset);
  bool is_real = type >= 0 && H5Tget_class(type) == H5T_FLOAT;
  array->rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : 0;
  bool fits = array->rank >= 2 && array->rank <= MOST_RANK &&
              H5Sget_simple_extent_dims(space, array->shape, NULL) == array->rank;
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  if (fits && is_real && row_size(array)) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "%s: the array '%s' is not one of floating point numbers, 24 a row: (n, 24), (n, 2, 4, 3)", array->path,
      name);
}

static Status open_array(DatagenArray *array) {
  char name[MOST_NAME];
  array->file = H5Fopen(array->path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (array->file < 0) return status_fail(STATUS_IO, "%s: cannot be opened as HDF5", array->path);
  TRY(find_name(array, name));
  array->dataset = H5Dopen2(array->file, name, H5P_DEFAULT);
  if (array->dataset < 0) return status_fail(STATUS_INPUT, "%s: '%s' is no array", array->path, name);
  return check_shape(array, name);
}

Status datagen_array_open(DatagenArray **result, const char *path) {
  datagen_hdf5_begin();
  *result = NULL;
  DatagenArray *array = memory_zeroed(1, sizeof *array);
  if (!array) return status_no_memory("an array of pairs");
  array->file = array->dataset = -1;
  array->path = memory_copy(path, strlen(path) + 1, 1);
  Status status = array->path ? open_array(array) : status_no_memory("a file name");
  if (status)
    datagen_array_close(array);
  else
    *result = array;
  return status;
}

long long datagen_array_count(const DatagenArray *array) {
  return (long long)array->shape[0];
}

static bool transfer(const DatagenArray *array, hsize_t first, hsize_t count, double *coordinates) {
  hsize_t start[MOST_RANK] = {first}, size[MOST_RANK];
  memcpy(size, array->shape, sizeof size);
  size[0] = count;
  hid_t space = H5Dget_space(array->dataset), room = H5Screate_simple(array->rank, size, NULL);
  bool works = space >= 0 && room >= 0 &&
               H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) >= 0 &&
               H5Dread(array->dataset, H5T_NATIVE_DOUBLE, room, space, H5P_DEFAULT, coordinates) >= 0;
  if (room >= 0) H5Sclose(room);
  if (space >= 0) H5Sclose(space);
  return works;
}

Status datagen_array_read(DatagenArray *array, long long first, size_t count, double *coordinates) {
  if (count > 0 && !transfer(array, (hsize_t)first, count, coordinates))
    return status_fail(STATUS_INPUT, "%s: pairs %lld to %lld cannot be read; the file is damaged",
                       array->path, first, first + (long long)count - 1);
  for (size_t k = 0; k < PAIR_SIZE * count; k++)
    if (!isfinite(coordinates[k]))
      return status_fail(STATUS_INPUT,
                         "%s: pair %lld, number %zu (both from 0): %g; a finite number is expected",
                         array->path, first + (long long)(k / PAIR_SIZE), k % PAIR_SIZE, coordinates[k]);
  return STATUS_OK;
}

void datagen_array_close(DatagenArray *array) {
  if (!array) return;
  if (array->dataset >= 0) H5Dclose(array->dataset);
  if (array->file >= 0) H5Fclose(array->file);
  memory_free(array->path);
  memory_free(array);
}
