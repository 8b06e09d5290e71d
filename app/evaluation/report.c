// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/report.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "app/table/table.h"

static const char *const bin_names[APP_EVALUATION_BINS] = {"small", "medium", "large"};

// Table 4 of the paper.
static const struct {
  DatagenKind kind;
  double accuracy, mae;
} paper_kinds[] = {
    {DATAGEN_NONE, 0.9802, 1.67e-7},       {DATAGEN_VERTEX_FACE, 0.9907, 4.27e-9},
    {DATAGEN_EDGE_FACE, 0.9997, 4.72e-9},  {DATAGEN_FACE_FACE, 0.9992, 1.65e-9},
    {DATAGEN_VOLUMETRIC, 0.9907, 2.88e-3},
};
static const double paper_bin_mae[APP_EVALUATION_BINS] = {1.47e-3, 2.80e-3, 4.44e-3};
static const double paper_bin_accuracy[APP_EVALUATION_BINS] = {0.88, 0.60, 0.41};

// The figures of an evaluation: their keys in JSON; what is printed of them, in `unit`, and what the paper
// has (NaN: nothing).
static const struct Figure {
  const char *key;
  size_t offset;
  const char *label, *unit;
  double paper; // in the unit
} figures[] = {
#define FIGURE(field, label, unit, paper)                                                                    \
  { #field, offsetof(AppEvaluation, field), label, unit, paper }
#define BOUND(key, field, label)                                                                             \
  { key, offsetof(AppEvaluation, bounds.field), label, "%", NAN }
    FIGURE(accuracy_mean, "mean of the kinds' status", "%", 99.37),
    FIGURE(accuracy_swapped_mean, "the two exchanged", "%", NAN),
    FIGURE(mae, "mean |dV|", "", 2.88e-3),
    FIGURE(volume_error_sum, "sum |dV| / sum V", "%", NAN),
    FIGURE(gradient_error, "gradient, aggregate", "%", NAN),
    FIGURE(gradient_error_median, "gradient, median", "%", NAN),
    FIGURE(gradient_error_p90, "gradient, 90 %", "%", NAN),
    FIGURE(moment_error, "moments by the centroid", "%", NAN),
    FIGURE(moment_error_own, "moments by V and centroid", "%", NAN),
    FIGURE(angle_median_deg, "force angle, median", "deg", NAN),
    FIGURE(angle_p90_deg, "force angle, 90 %", "deg", NAN),
    FIGURE(ghost_volume, "ghost volume", "", NAN),
    FIGURE(ghost_gradient, "ghost gradient", "", NAN),
    FIGURE(defect_vertex_order, "defect, vertex order", "", NAN),
    FIGURE(defect_swap, "defect, swap", "", NAN),
    FIGURE(defect_rotation, "defect, rotation", "", NAN),
    FIGURE(calibration_error, "calibration of status", "", NAN),
    BOUND("bound_coverage", coverage, "error within its bound"),
    BOUND("bound_width_median", width_median, "bound / V, median"),
    BOUND("bound_width_p95", width_p95, "bound / V, 95 %"),
    BOUND("bound_error_median", error_median, "error / V, median"),
    BOUND("bound_error_p95", error_p95, "error / V, 95 %"),
    FIGURE(handed_on, "handed on", "%", NAN),
    FIGURE(handed_on_in_part, "handed on in part", "%", NAN),
};
enum { FIGURE_COUNT = sizeof figures / sizeof *figures };

static double figure_of(const AppEvaluation *evaluation, const struct Figure *figure) {
  return *(const double *)((const char *)evaluation + figure->offset);
}

// A row of the three tables.
typedef struct Row {
  const char *name, *unit;
  double count, right, paper_right, mae, paper_mae, swapped; // shares in %
  double value, paper;
} Row;

#define TEXT(field, head)                                                                                    \
  { #field, APP_TABLE_TEXT, offsetof(Row, field), head, NULL }
#define NUMBER(field, head)                                                                                  \
  { #field, APP_TABLE_NUMBER, offsetof(Row, field), head, NULL }
static const AppTableColumn kind_columns[] = {
    TEXT(name, "kind"),
    {"count", APP_TABLE_COUNT, offsetof(Row, count), "pairs", NULL},
    NUMBER(right, "status right %"),
    NUMBER(paper_right, "paper"),
    NUMBER(mae, "mean |dV|"),
    NUMBER(paper_mae, "paper"),
    NUMBER(swapped, "exchanged %"),
};
static const AppTableColumn bin_columns[] = {
    TEXT(name, "V"),
    NUMBER(count, "share %"),
    NUMBER(right, "right bin %"),
    NUMBER(paper_right, "paper"),
    NUMBER(mae, "mean |dV|"),
    NUMBER(paper_mae, "paper"),
};
static const AppTableColumn figure_columns[] = {
    TEXT(name, ""),
    NUMBER(value, ""),
    TEXT(unit, ""),
    NUMBER(paper, "paper"),
};

enum { MAX_COLUMNS = 8 };

static Status print_rows(const AppTableColumn *columns, int column_count, const Row *rows, int count,
                         bool is_paper, FILE *stream) {
  AppTableColumn shown[MAX_COLUMNS];
  int shown_count = 0;
  for (int k = 0; k < column_count; k++)
    if (is_paper || strcmp(columns[k].head, "paper") != 0) shown[shown_count++] = columns[k];
  const AppTablePart part = {shown, shown_count, rows, sizeof *rows};
  fputc('\n', stream);
  return app_table_print(&(AppTable){&part, 1, count}, APP_TABLE_PLAIN, stream);
}

static Status print_kinds(const AppEvaluation *evaluation, bool is_paper, FILE *stream) {
  Row rows[DATAGEN_KIND_COUNT];
  int count = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    const AppEvaluationKind *kind = &evaluation->kinds[k];
    if (!kind->count) continue;
    Row *row = &rows[count++];
    *row = (Row){.name = datagen_kind_info(k)->name,
                 .count = (double)kind->count,
                 .right = 100 * kind->accuracy,
                 .paper_right = NAN,
                 .mae = kind->volume_mae,
                 .paper_mae = NAN,
                 .swapped = 100 * kind->accuracy_swapped};
    for (size_t p = 0; p < sizeof paper_kinds / sizeof *paper_kinds; p++)
      if (paper_kinds[p].kind == (DatagenKind)k)
        row->paper_right = 100 * paper_kinds[p].accuracy, row->paper_mae = paper_kinds[p].mae;
  }
  return print_rows(kind_columns, sizeof kind_columns / sizeof *kind_columns, rows, count, is_paper, stream);
}

static Status print_bins(const AppEvaluation *evaluation, bool is_paper, FILE *stream) {
  Row rows[APP_EVALUATION_BINS];
  for (int b = 0; b < APP_EVALUATION_BINS; b++)
    rows[b] = (Row){.name = bin_names[b],
                    .count = 100 * evaluation->bin_share[b],
                    .right = 100 * evaluation->bin_accuracy[b],
                    .paper_right = 100 * paper_bin_accuracy[b],
                    .mae = evaluation->bin_mae[b],
                    .paper_mae = paper_bin_mae[b]};
  return print_rows(bin_columns, sizeof bin_columns / sizeof *bin_columns, rows, APP_EVALUATION_BINS,
                    is_paper, stream);
}

// What the model does not give is left out.
static Status print_figures(const AppEvaluation *evaluation, bool is_paper, FILE *stream) {
  Row rows[FIGURE_COUNT];
  int count = 0;
  for (int f = 0; f < FIGURE_COUNT; f++) {
    double value = figure_of(evaluation, &figures[f]);
    if (!isfinite(value)) continue;
    rows[count++] = (Row){.name = figures[f].label,
                          .unit = figures[f].unit,
                          .value = figures[f].unit[0] == '%' ? 100 * value : value,
                          .paper = figures[f].paper};
  }
  return print_rows(figure_columns, sizeof figure_columns / sizeof *figure_columns, rows, count, is_paper,
                    stream);
}

Status app_evaluation_print(const AppEvaluation *evaluation, const char *model, const char *data,
                            bool is_paper, FILE *stream) {
  fprintf(stream,
          "%s on %s\n%lld pairs, %lld share volume, %lld answered by a more careful model, %lld in part\n",
          model, data, evaluation->count, evaluation->inside, evaluation->fallbacks, evaluation->blended);
  if (evaluation->unsound)
    fprintf(stream, "%lld volumes are unsound: below 0, and count as 0, or above the smaller tetrahedron\n",
            evaluation->unsound);
  TRY(print_kinds(evaluation, is_paper, stream));
  if (evaluation->inside) TRY(print_bins(evaluation, is_paper, stream));
  TRY(print_figures(evaluation, is_paper, stream));
  fputs(evaluation->has_status ? "\nstatus: the sign of the logit, right if the closed tetrahedra meet\n"
                               : "\nstatus: V > 0, right if the pair shares volume; a touch counts as none\n",
        stream);
  if (is_paper)
    fputs(
        "paper: Table 4 of TetrahedronPairNet, on its authors' pairs; those of --law paper-test are alike\n",
        stream);
  return STATUS_OK;
}

static void record_bins(const AppEvaluation *evaluation, Record *record) {
  char key[64];
  for (int b = 0; b < APP_EVALUATION_BINS; b++) {
    snprintf(key, sizeof key, "mae_%s", bin_names[b]);
    record_number(record, key, evaluation->bin_mae[b]);
    snprintf(key, sizeof key, "bin_accuracy_%s", bin_names[b]);
    record_number(record, key, evaluation->bin_accuracy[b]);
    snprintf(key, sizeof key, "bin_share_%s", bin_names[b]);
    record_number(record, key, evaluation->bin_share[b]);
  }
}

void app_evaluation_record(const AppEvaluation *evaluation, Record *record) {
  record_integer(record, "count", evaluation->count);
  record_integer(record, "count_with_volume", evaluation->inside);
  record_integer(record, "fallbacks", evaluation->fallbacks);
  record_integer(record, "blended", evaluation->blended);
  record_integer(record, "unsound_pairs", evaluation->unsound);
  record_bool(record, "has_status", evaluation->has_status);
  Record *accuracy = record_child(record, "accuracy"), *mae = record_child(record, "mae_by_kind");
  Record *swapped = record_child(record, "accuracy_swapped");
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    if (!evaluation->kinds[k].count) continue;
    record_number(accuracy, datagen_kind_info(k)->name, evaluation->kinds[k].accuracy);
    record_number(swapped, datagen_kind_info(k)->name, evaluation->kinds[k].accuracy_swapped);
    record_number(mae, datagen_kind_info(k)->name, evaluation->kinds[k].volume_mae);
  }
  for (int f = 0; f < FIGURE_COUNT; f++)
    record_number(record, figures[f].key, figure_of(evaluation, &figures[f]));
  record_bins(evaluation, record);
}

void app_evaluation_print_paths(const AppEvaluationPaths *paths, const char *model, FILE *stream) {
  fprintf(stream,
          "%s along %d paths (%d more were drawn that flatten a tetrahedron or touch nothing)\n"
          "  largest jump of V          %.3g of the path's largest V\n"
          "  largest jump of the gradient %.3g of the path's largest\n"
          "  paths with a jump above %.0e or %.0e: %d\n",
          model, paths->count, paths->replaced, paths->volume_jump, paths->gradient_jump,
          app_evaluation_volume_jump, app_evaluation_gradient_jump, paths->jumping);
}

void app_evaluation_record_paths(const AppEvaluationPaths *paths, Record *record) {
  record_integer(record, "count", paths->count);
  record_integer(record, "replaced", paths->replaced);
  record_integer(record, "jumping", paths->jumping);
  record_number(record, "volume_jump", paths->volume_jump);
  record_number(record, "gradient_jump", paths->gradient_jump);
}
