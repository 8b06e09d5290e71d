// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pairs/reader.h"

#include <errno.h>
#include <string.h>

#include "base/memory.h"

static const char hdf5_magic[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};

static Status open_stream(AppPairsReader *reader, const char *path) {
  bool is_input = strcmp(path, "-") == 0;
  reader->name = is_input ? "standard input" : path;
  reader->stream = is_input ? stdin : fopen(path, "rb");
  reader->is_owned = !is_input;
  if (!reader->stream) return status_fail(STATUS_IO, "%s: cannot be opened: %s", path, strerror(errno));
  return STATUS_OK;
}

// The first byte decides: no text begins with either magic's.
static Status find_format(AppPairsReader *reader) {
  int first = getc(reader->stream);
  if (ferror(reader->stream) && errno == EINTR) return status_fail(STATUS_INTERRUPTED, "interrupted");
  if (ferror(reader->stream))
    return status_fail(STATUS_IO, "%s: cannot be read: %s", reader->name, strerror(errno));
  if (first != EOF) ungetc(first, reader->stream);
  reader->format = first == (unsigned char)hdf5_magic[0]            ? APP_PAIRS_DATASET
                   : first == (unsigned char)app_pairs_npy_magic[0] ? APP_PAIRS_NPY
                                                                    : APP_PAIRS_CSV;
  return STATUS_OK;
}

static Status open_csv(AppPairsReader *reader, bool takes_labels) {
  AppPairsCsv *csv = &reader->csv;
  TRY(app_pairs_csv_open(csv, reader->stream, reader->name));
  reader->column_count = csv->field_count;
  Status status =
      csv->has_header
          ? app_pairs_columns_by_name(&reader->columns, csv->fields, csv->field_count, takes_labels)
          : app_pairs_columns_by_place(&reader->columns, csv->field_count, takes_labels);
  return status ? status_prefix(status, "%s:%lld", reader->name, csv->line_number) : STATUS_OK;
}

static Status open_npy(AppPairsReader *reader, bool takes_labels) {
  TRY(app_pairs_npy_open(&reader->npy, reader->stream, reader->name));
  reader->column_count = reader->npy.row_size;
  Status status = app_pairs_columns_by_place(&reader->columns, reader->column_count, takes_labels);
  return status ? status_prefix(status, "%s", reader->name) : STATUS_OK;
}

// A data set of pairs has labels; of any other file the coordinates are read.
static Status open_hdf5(AppPairsReader *reader, const char *path) {
  if (!reader->is_owned)
    return status_fail(STATUS_INPUT, "standard input: is HDF5, which must be a file; give its name");
  fclose(reader->stream);
  reader->stream = NULL;
  if (datagen_dataset_open(&reader->dataset, path) != STATUS_OK) {
    reader->format = APP_PAIRS_ARRAY;
    return datagen_array_open(&reader->array, path);
  }
  reader->has_status = reader->has_volume = true;
  reader->has_gradient = datagen_dataset_info(reader->dataset)->has_gradient;
  return STATUS_OK;
}

static Status make_block(AppPairsBlock *block) {
  block->coordinates = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double[APP_PAIRS_SIZE]));
  block->gradient = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double[APP_PAIRS_SIZE]));
  block->volume = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double));
  block->status = memory_zeroed(APP_PAIRS_BLOCK, 1);
  block->places = memory_zeroed(APP_PAIRS_BLOCK, sizeof *block->places);
  bool is_whole = block->coordinates && block->gradient && block->volume && block->status && block->places;
  return is_whole ? STATUS_OK : status_no_memory("a block of pairs");
}

Status app_pairs_reader_open(AppPairsReader *reader, const char *path, bool takes_labels) {
  *reader = (AppPairsReader){0};
  TRY(open_stream(reader, path));
  TRY(make_block(&reader->block));
  TRY(find_format(reader));
  if (reader->format == APP_PAIRS_DATASET) return open_hdf5(reader, path);
  TRY(reader->format == APP_PAIRS_NPY ? open_npy(reader, takes_labels) : open_csv(reader, takes_labels));
  reader->has_status = reader->columns.status >= 0;
  reader->has_volume = reader->columns.volume >= 0;
  reader->has_gradient = reader->columns.gradient[0] >= 0;
  return STATUS_OK;
}

static Status read_row(AppPairsReader *reader, double *row, long long *place, bool *is_end) {
  if (reader->format == APP_PAIRS_CSV) {
    TRY(app_pairs_csv_read(&reader->csv, reader->column_count, row, is_end));
    *place = reader->csv.line_number;
    return STATUS_OK;
  }
  *place = reader->npy.next;
  *is_end = reader->npy.next == reader->npy.row_count;
  return *is_end ? STATUS_OK : app_pairs_npy_read(&reader->npy, row);
}

static Status keep_row(AppPairsReader *reader, const double *row, int i, long long place) {
  const AppPairsColumns *columns = &reader->columns;
  AppPairsBlock *block = &reader->block;
  for (int k = 0; k < APP_PAIRS_SIZE; k++) {
    block->coordinates[APP_PAIRS_SIZE * i + k] = row[columns->coordinates[k]];
    if (reader->has_gradient) block->gradient[APP_PAIRS_SIZE * i + k] = row[columns->gradient[k]];
  }
  if (reader->has_volume) block->volume[i] = row[columns->volume];
  block->places[i] = place;
  if (!reader->has_status) return STATUS_OK;
  double status = row[columns->status];
  if (status != 0 && status != 1)
    return status_fail(STATUS_INPUT, "%s: %s %lld: the status is %g; it is 0 (disjoint) or 1 (they meet)",
                       reader->name, app_pairs_reader_place_word(reader), place, status);
  block->status[i] = status == 1;
  return STATUS_OK;
}

static Status read_rows(AppPairsReader *reader) {
  double row[APP_PAIRS_MAX_COLUMNS];
  int count = 0;
  for (; count < APP_PAIRS_BLOCK; count++) {
    bool is_end;
    long long place;
    TRY(read_row(reader, row, &place, &is_end));
    if (is_end) break;
    TRY(keep_row(reader, row, count, place));
  }
  reader->block.count = count;
  return STATUS_OK;
}

static Status read_dataset(AppPairsReader *reader) {
  AppPairsBlock *block = &reader->block;
  long long left = datagen_dataset_info(reader->dataset)->count - reader->done;
  block->count = (int)(left < APP_PAIRS_BLOCK ? left : APP_PAIRS_BLOCK);
  for (int i = 0; i < block->count; i++) block->places[i] = reader->done + i;
  DatagenPairs pairs = {.coordinates = block->coordinates,
                        .status = block->status,
                        .volume = block->volume,
                        .gradient = reader->has_gradient ? block->gradient : NULL};
  return block->count ? datagen_dataset_read(reader->dataset, reader->done, (size_t)block->count, &pairs)
                      : STATUS_OK;
}

static Status read_array(AppPairsReader *reader) {
  AppPairsBlock *block = &reader->block;
  long long left = datagen_array_count(reader->array) - reader->done;
  int count = (int)(left < APP_PAIRS_BLOCK ? left : APP_PAIRS_BLOCK);
  for (int i = 0; i < count; i++) block->places[i] = reader->done + i;
  TRY(datagen_array_read(reader->array, reader->done, (size_t)count, block->coordinates));
  block->count = count;
  return STATUS_OK;
}

Status app_pairs_reader_next(AppPairsReader *reader) {
  reader->block.count = 0;
  TRY(reader->dataset ? read_dataset(reader) : reader->array ? read_array(reader) : read_rows(reader));
  reader->done += reader->block.count;
  if (reader->done == 0)
    return status_fail(STATUS_INPUT, "%s: holds no pairs; a row for each is expected", reader->name);
  return STATUS_OK;
}

const char *app_pairs_reader_place_word(const AppPairsReader *reader) {
  static const char *const words[] = {[APP_PAIRS_CSV] = "line",
                                      [APP_PAIRS_NPY] = "row",
                                      [APP_PAIRS_DATASET] = "pair",
                                      [APP_PAIRS_ARRAY] = "pair"};
  return words[reader->format];
}

void app_pairs_reader_close(AppPairsReader *reader) {
  AppPairsBlock *block = &reader->block;
  memory_free(block->coordinates), memory_free(block->gradient), memory_free(block->volume);
  memory_free(block->status), memory_free(block->places);
  app_pairs_csv_close(&reader->csv);
  datagen_dataset_close(reader->dataset);
  datagen_array_close(reader->array);
  if (reader->stream && reader->is_owned) fclose(reader->stream);
  *reader = (AppPairsReader){0};
}
