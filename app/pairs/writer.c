// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pairs/writer.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>

#include "app/pairs/columns.h"
#include "app/pairs/npy.h"

// Fields in the order of OverlapFlag's bits.
static const char *const flag_names[] = {"disjoint", "flat", "fallback", "enclosed",
                                         "blended",  "net",  "beyond"};
enum { FLAG_COUNT = sizeof flag_names / sizeof *flag_names, MOST_TYPE = 256 };

Status app_pairs_writer_form(const char *path, AppPairsForm *form) {
  static const struct {
    const char *ending;
    AppPairsForm form;
  } endings[] = {{".csv", APP_PAIRS_FORM_CSV},
                 {".json", APP_PAIRS_FORM_JSON},
                 {".jsonl", APP_PAIRS_FORM_JSON},
                 {".npy", APP_PAIRS_FORM_NPY}};
  const char *dot = strrchr(path, '.');
  for (size_t e = 0; dot && e < sizeof endings / sizeof *endings; e++)
    if (strcasecmp(dot, endings[e].ending) == 0) {
      *form = endings[e].form;
      return STATUS_OK;
    }
  return status_fail(STATUS_USAGE, "-o %s: in which form? give a name that ends in .csv, .npy, or .json",
                     path);
}

static void write_csv_head(FILE *stream, const AppPairsWriter *writer) {
  fputs("volume", stream);
  for (int k = 0; writer->has_gradient && k < APP_PAIRS_SIZE; k++)
    fprintf(stream, ",dV/d%s", app_pairs_columns_name(k));
  fputs(",centroid_x,centroid_y,centroid_z", stream);
  fputs(",flags\n", stream);
}

static void write_npy_head(FILE *stream, const AppPairsWriter *writer) {
  const char order = app_pairs_npy_order();
  char type[MOST_TYPE], gradient[48] = "";
  if (writer->has_gradient) snprintf(gradient, sizeof gradient, ", ('gradient', '%cf8', (2, 4, 3))", order);
  snprintf(type, sizeof type, "[('volume', '%cf8')%s, ('centroid', '%cf8', (3,)), ('flags', '%cu4')]", order,
           gradient, order, order);
  app_pairs_npy_write_head(stream, type, writer->count);
}

Status app_pairs_writer_open(AppPairsWriter *writer, const char *path, AppPairsForm form, bool has_gradient) {
  *writer = (AppPairsWriter){.form = form, .has_gradient = has_gradient, .stream = stdout};
  if (path) {
    TRY(file_begin(&writer->file, path));
    writer->stream = writer->file.stream;
  } else if (form == APP_PAIRS_FORM_NPY)
    return status_fail(STATUS_USAGE, "a .npy file goes into a file; give -o FILE.npy");
  if (form == APP_PAIRS_FORM_CSV) write_csv_head(writer->stream, writer);
  if (form == APP_PAIRS_FORM_NPY) write_npy_head(writer->stream, writer);
  return STATUS_OK;
}

// Numbers with commas between, as many digits as tell every double from its neighbours.
static void write_numbers(FILE *stream, const double *values, int count) {
  for (int k = 0; k < count; k++) fprintf(stream, k ? ",%.17g" : "%.17g", values[k]);
}

static void write_flags(FILE *stream, unsigned flags, const char *between, const char *quote) {
  bool is_first = true;
  for (int f = 0; f < FLAG_COUNT; f++) {
    if (!(flags >> f & 1)) continue;
    fprintf(stream, "%s%s%s%s", is_first ? "" : between, quote, flag_names[f], quote);
    is_first = false;
  }
}

static void write_csv(FILE *stream, const AppPairsWriter *writer, const OverlapBatch *batch, int i) {
  fprintf(stream, "%.17g", batch->volume[i]);
  if (writer->has_gradient) {
    fputc(',', stream);
    write_numbers(stream, batch->gradient + APP_PAIRS_SIZE * (size_t)i, APP_PAIRS_SIZE);
  }
  fputc(',', stream);
  write_numbers(stream, batch->centroid + 3 * (size_t)i, 3);
  fputc(',', stream);
  write_flags(stream, batch->flags[i], " ", "");
  fputc('\n', stream);
}

static void write_json(FILE *stream, const AppPairsWriter *writer, const OverlapBatch *batch, int i) {
  fprintf(stream, "{\"volume\":%.17g", batch->volume[i]);
  if (writer->has_gradient) {
    fputs(",\"gradient\":[", stream);
    write_numbers(stream, batch->gradient + APP_PAIRS_SIZE * (size_t)i, APP_PAIRS_SIZE);
    fputc(']', stream);
  }
  fputs(",\"centroid\":[", stream);
  write_numbers(stream, batch->centroid + 3 * (size_t)i, 3);
  fputs("],\"flags\":[", stream);
  write_flags(stream, batch->flags[i], ",", "\"");
  fputs("]}\n", stream);
}

static void write_npy(FILE *stream, const AppPairsWriter *writer, const OverlapBatch *batch, int i) {
  uint32_t flags = batch->flags[i];
  fwrite(batch->volume + i, sizeof(double), 1, stream);
  if (writer->has_gradient)
    fwrite(batch->gradient + APP_PAIRS_SIZE * (size_t)i, sizeof(double), APP_PAIRS_SIZE, stream);
  fwrite(batch->centroid + 3 * (size_t)i, sizeof(double), 3, stream);
  fwrite(&flags, sizeof flags, 1, stream);
}

void app_pairs_writer_append(AppPairsWriter *writer, const OverlapBatch *batch) {
  static void (*const write[])(FILE *, const AppPairsWriter *, const OverlapBatch *, int) = {
      [APP_PAIRS_FORM_CSV] = write_csv, [APP_PAIRS_FORM_JSON] = write_json, [APP_PAIRS_FORM_NPY] = write_npy};
  for (int i = 0; i < batch->pair_count; i++) write[writer->form](writer->stream, writer, batch, i);
  writer->count += batch->pair_count;
}

Status app_pairs_writer_commit(AppPairsWriter *writer) {
  if (writer->form == APP_PAIRS_FORM_NPY) {
    rewind(writer->stream);
    write_npy_head(writer->stream, writer);
  }
  if (writer->file.stream) return file_commit(&writer->file);
  return fflush(stdout) == 0 && !ferror(stdout) ? STATUS_OK
                                                : status_fail(STATUS_IO, "standard output cannot be written");
}

void app_pairs_writer_abandon(AppPairsWriter *writer) {
  file_abandon(&writer->file);
}
