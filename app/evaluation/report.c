// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/report.h"

#include <math.h>

static const char *const bin_names[APP_EVALUATION_BINS] = {"small", "medium", "large"};

// Table 4 of the paper; NaN where it says nothing.
static const struct {
  DatagenKind kind;
  double accuracy, mae;
} paper_kinds[] = {
    {DATAGEN_NONE, 0.9802, 1.67e-7},       {DATAGEN_VERTEX_FACE, 0.9907, 4.27e-9},
    {DATAGEN_EDGE_FACE, 0.9997, 4.72e-9},  {DATAGEN_FACE_FACE, 0.9992, 1.65e-9},
    {DATAGEN_VOLUMETRIC, 0.9907, 2.88e-3},
};
static const double paper_accuracy_mean = 0.9937, paper_mae = 2.88e-3;
static const double paper_bin_mae[APP_EVALUATION_BINS] = {1.47e-3, 2.80e-3, 4.44e-3};
static const double paper_bin_accuracy[APP_EVALUATION_BINS] = {0.88, 0.60, 0.41};

// A value and what the paper has for it, "–" where there is none.
static void print_pair(FILE *stream, const char *format, double value, double paper) {
  char text[2][32];
  const double numbers[2] = {value, paper};
  for (int i = 0; i < 2; i++)
    if (isnan(numbers[i]))
      snprintf(text[i], sizeof text[i], "-");
    else
      snprintf(text[i], sizeof text[i], format, numbers[i]);
  fprintf(stream, "  %12s %10s", text[0], text[1]);
}

static void print_row(FILE *stream, const char *name, const char *format, double value, double paper) {
  fprintf(stream, "  %-26s", name);
  print_pair(stream, format, value, paper);
  fputc('\n', stream);
}

static void print_kinds(FILE *stream, const AppEvaluation *evaluation) {
  fprintf(stream, "\n  %-16s %8s  %12s %10s  %12s %10s  %10s\n", "kind", "pairs", "status right", "paper",
          "mean |dV|", "paper", "exchanged");
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    const AppEvaluationKind *kind = &evaluation->kinds[k];
    if (!kind->count) continue;
    double accuracy = NAN, mae = NAN;
    for (size_t p = 0; p < sizeof paper_kinds / sizeof *paper_kinds; p++)
      if (paper_kinds[p].kind == (DatagenKind)k) accuracy = paper_kinds[p].accuracy, mae = paper_kinds[p].mae;
    fprintf(stream, "  %-16s %8lld", datagen_kind_info(k)->name, kind->count);
    print_pair(stream, "%.2f %%", 100 * kind->accuracy, 100 * accuracy);
    print_pair(stream, "%.3g", kind->volume_mae, mae);
    fprintf(stream, "  %8.2f %%\n", 100 * kind->accuracy_swapped);
  }
}

static void print_bins(FILE *stream, const AppEvaluation *evaluation) {
  fprintf(stream, "\n  %-16s %8s  %12s %10s  %12s %10s\n", "V", "share", "right bin", "paper", "mean |dV|",
          "paper");
  for (int b = 0; b < APP_EVALUATION_BINS; b++) {
    fprintf(stream, "  %-16s %6.1f %%", bin_names[b], 100 * evaluation->bin_share[b]);
    print_pair(stream, "%.1f %%", 100 * evaluation->bin_accuracy[b], 100 * paper_bin_accuracy[b]);
    print_pair(stream, "%.3g", evaluation->bin_mae[b], paper_bin_mae[b]);
    fputc('\n', stream);
  }
}

void app_evaluation_print(const AppEvaluation *evaluation, const char *model, const char *data,
                          FILE *stream) {
  fprintf(stream,
          "%s on %s\n%lld pairs, %lld share volume, %lld answered by a more careful model, %lld in part\n",
          model, data, evaluation->count, evaluation->inside, evaluation->fallbacks, evaluation->blended);
  print_kinds(stream, evaluation);
  if (evaluation->inside) print_bins(stream, evaluation);
  fprintf(stream, "\n  %-26s  %12s %10s\n", "", "", "paper");
  print_row(stream, "mean of the kinds' status", "%.2f %%", 100 * evaluation->accuracy_mean,
            100 * paper_accuracy_mean);
  print_row(stream, "the two exchanged", "%.2f %%", 100 * evaluation->accuracy_swapped_mean, NAN);
  print_row(stream, "mean |dV|", "%.3g", evaluation->mae, paper_mae);
  print_row(stream, "sum |dV| / sum V", "%.3g %%", 100 * evaluation->volume_error_sum, NAN);
  print_row(stream, "gradient, aggregate", "%.3g %%", 100 * evaluation->gradient_error, NAN);
  print_row(stream, "gradient, median", "%.3g %%", 100 * evaluation->gradient_error_median, NAN);
  print_row(stream, "gradient, 90 %", "%.3g %%", 100 * evaluation->gradient_error_p90, NAN);
  print_row(stream, "moments by the centroid", "%.3g %%", 100 * evaluation->moment_error, NAN);
  print_row(stream, "moments by V and centroid", "%.3g %%", 100 * evaluation->moment_error_own, NAN);
  print_row(stream, "force angle, median", "%.3g deg", evaluation->angle_median_deg, NAN);
  print_row(stream, "force angle, 90 %", "%.3g deg", evaluation->angle_p90_deg, NAN);
  print_row(stream, "ghost volume", "%.3g", evaluation->ghost_volume, NAN);
  print_row(stream, "ghost gradient", "%.3g", evaluation->ghost_gradient, NAN);
  print_row(stream, "defect, vertex order", "%.3g", evaluation->defect_vertex_order, NAN);
  print_row(stream, "defect, swap", "%.3g", evaluation->defect_swap, NAN);
  print_row(stream, "defect, rotation", "%.3g", evaluation->defect_rotation, NAN);
  if (evaluation->bounds.count) {
    const AppEvaluationBounds *bounds = &evaluation->bounds;
    print_row(stream, "error within its bound", "%.2f %%", 100 * bounds->coverage, NAN);
    print_row(stream, "bound / V, median", "%.3g %%", 100 * bounds->width_median, NAN);
    print_row(stream, "bound / V, 95 %", "%.3g %%", 100 * bounds->width_p95, NAN);
    print_row(stream, "error / V, median", "%.3g %%", 100 * bounds->error_median, NAN);
    print_row(stream, "error / V, 95 %", "%.3g %%", 100 * bounds->error_p95, NAN);
    print_row(stream, "handed on", "%.2f %%", 100 * evaluation->handed_on, NAN);
    print_row(stream, "handed on in part", "%.2f %%", 100 * evaluation->handed_on_in_part, NAN);
  }
  if (evaluation->has_status)
    print_row(stream, "calibration of status", "%.3g", evaluation->calibration_error, NAN);
  fputs(evaluation->has_status ? "\nstatus: the sign of the logit, right if the closed tetrahedra meet\n"
                               : "\nstatus: V > 0, right if the pair shares volume; a touch counts as none\n",
        stream);
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
  Record *accuracy = record_child(record, "accuracy"), *mae = record_child(record, "mae_by_kind");
  Record *swapped = record_child(record, "accuracy_swapped");
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    if (!evaluation->kinds[k].count) continue;
    record_number(accuracy, datagen_kind_info(k)->name, evaluation->kinds[k].accuracy);
    record_number(swapped, datagen_kind_info(k)->name, evaluation->kinds[k].accuracy_swapped);
    record_number(mae, datagen_kind_info(k)->name, evaluation->kinds[k].volume_mae);
  }
  record_number(record, "accuracy_mean", evaluation->accuracy_mean);
  record_number(record, "accuracy_swapped_mean", evaluation->accuracy_swapped_mean);
  record_number(record, "mae", evaluation->mae);
  record_bins(evaluation, record);
  record_number(record, "volume_error_sum", evaluation->volume_error_sum);
  record_number(record, "gradient_error", evaluation->gradient_error);
  record_number(record, "gradient_error_median", evaluation->gradient_error_median);
  record_number(record, "gradient_error_p90", evaluation->gradient_error_p90);
  record_number(record, "moment_error", evaluation->moment_error);
  record_number(record, "moment_error_own", evaluation->moment_error_own);
  record_number(record, "angle_median_deg", evaluation->angle_median_deg);
  record_number(record, "angle_p90_deg", evaluation->angle_p90_deg);
  record_number(record, "ghost_volume", evaluation->ghost_volume);
  record_number(record, "ghost_gradient", evaluation->ghost_gradient);
  record_number(record, "defect_vertex_order", evaluation->defect_vertex_order);
  record_number(record, "defect_swap", evaluation->defect_swap);
  record_number(record, "defect_rotation", evaluation->defect_rotation);
  record_bool(record, "has_status", evaluation->has_status);
  record_number(record, "calibration_error", evaluation->calibration_error);
  record_number(record, "bound_coverage", evaluation->bounds.coverage);
  record_number(record, "bound_width_median", evaluation->bounds.width_median);
  record_number(record, "bound_width_p95", evaluation->bounds.width_p95);
  record_number(record, "bound_error_median", evaluation->bounds.error_median);
  record_number(record, "bound_error_p95", evaluation->bounds.error_p95);
  record_number(record, "handed_on", evaluation->handed_on);
  record_number(record, "handed_on_in_part", evaluation->handed_on_in_part);
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
