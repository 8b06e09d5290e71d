// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/dataset/plot.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app/dataset/summary.h"
#include "app/plot/gnuplot.h"
#include "base/files/file.h"
#include "base/text.h"

enum { BINS_A_STEP = APP_DATASET_BINS_A_DECADE / 5 }; // five steps of the curves a decade

static const char *terminal_of(const char *picture) {
  if (text_ends_in(picture, ".svg")) return "svg size 1400,420 dynamic";
  if (text_ends_in(picture, ".pdf")) return "pdfcairo size 14in,4.2in";
  return "pngcairo size 1400,420";
}

static void write_counts(FILE *stream, const AppDatasetSummary *summary) {
  fputs("$counts << END\n", stream);
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    if (summary->kinds[k].count)
      fprintf(stream, "\"%s\" %lld\n", datagen_kind_info(k)->name, summary->kinds[k].count);
  fputs("END\n", stream);
}

// Share of the kind's pairs with V > 0 in each step, by unit of log10 V and by unit of V: V, both densities.
static void write_volumes(FILE *stream, int k, const AppDatasetKind *kind) {
  fprintf(stream, "$volumes%d << END\n", k);
  for (int bin = 0; bin < APP_DATASET_BINS; bin += BINS_A_STEP) {
    long long count = 0;
    for (int b = bin; b < bin + BINS_A_STEP; b++) count += kind->histogram[b];
    double low = pow(10, (double)bin / APP_DATASET_BINS_A_DECADE - APP_DATASET_DECADES);
    double width = (double)BINS_A_STEP / APP_DATASET_BINS_A_DECADE, high = low * pow(10, width);
    double share = (double)count / (double)kind->with_volume;
    if (count) fprintf(stream, "%.6g %.6g %.6g\n", sqrt(low * high), share / width, share / (high - low));
  }
  fputs("END\n", stream);
}

static void write_curves(FILE *stream, const AppDatasetSummary *summary, const char *columns) {
  const char *before = "plot ";
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    if (!summary->kinds[k].with_volume) continue;
    fprintf(stream, "%s$volumes%d using %s with histeps lw 2 title '%s'", before, k, columns,
            datagen_kind_info(k)->name);
    before = ", ";
  }
  fputc('\n', stream);
}

static bool has_volumes(const AppDatasetSummary *summary) {
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    if (summary->kinds[k].with_volume) return true;
  return false;
}

// Between labels of the axis of V, as a factor: about eight labels whatever the range.
static double label_step(const AppDatasetSummary *summary) {
  double low = INFINITY, high = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    const AppDatasetKind *kind = &summary->kinds[k];
    if (kind->with_volume) low = fmin(low, kind->volume_min), high = fmax(high, kind->volume_max);
  }
  return pow(10, fmax(1, ceil(log10(high / low) / 8)));
}

static void write_script(FILE *stream, const AppDatasetSummary *summary, const char *title,
                         const char *picture) {
  fputs("# gnuplot script; run it again with: gnuplot THIS_FILE\n", stream);
  write_counts(stream, summary);
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    if (summary->kinds[k].with_volume) write_volumes(stream, k, &summary->kinds[k]);
  fprintf(stream, "set terminal %s\n", terminal_of(picture));
  app_gnuplot_output(stream, picture);
  fprintf(stream, "set multiplot layout 1,%d title ", has_volumes(summary) ? 3 : 1);
  app_gnuplot_quote(stream, title);
  fputs(" noenhanced\nset style fill solid 0.5\nset boxwidth 0.8\nset grid y\nset xtics rotate by 35 right\n"
        "set ylabel 'pairs'\nset yrange [0:*]\nplot $counts using 0:2:xtic(1) with boxes notitle\n",
        stream);
  if (has_volumes(summary)) {
    fprintf(stream, "set xtics norotate %g\nset logscale x\nset format x '10^{%%T}'\nset xlabel 'V'\n",
            label_step(summary));
    fputs("set ylabel 'density of log_{10} V'\nset key above\n", stream);
    write_curves(stream, summary, "1:2");
    fputs("set ylabel 'density of V'\nset logscale y\nset format y '10^{%T}'\nset yrange [*:*]\n"
          "unset key\n",
          stream);
    write_curves(stream, summary, "1:3");
  }
  fputs("unset multiplot\n", stream);
}

Status app_dataset_plot(DatagenDataset *dataset, const char *title, const char *picture) {
  static AppDatasetSummary summary; // large; commands run once
  char script[4096 + 8];
  FileWriter writer;
  if (snprintf(script, sizeof script, "%s.gp", picture) >= (int)sizeof script)
    return status_fail(STATUS_USAGE, "the picture's name is too long");
  TRY(app_dataset_summarise(dataset, &summary));
  TRY(file_begin(&writer, script));
  write_script(writer.stream, &summary, title, picture);
  TRY(file_commit(&writer));
  return app_gnuplot_run(script, picture);
}
