// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run_result.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/memory.h"
#include "base/text.h"

void fem_run_result_destroy(FemRunResult *result) {
  if (result->counters) record_destroy(result->counters);
  for (int i = 0; i < result->interface_count; i++) memory_free(result->interface_names[i]);
  memory_free(result->interface_names);
  memory_free(result->frame_times);
  memory_free(result->trajectory);
  memory_free(result->interface_forces);
  *result = (FemRunResult){0};
}

// Appends "; text" to what was told.
static void tell(char *text, size_t size, size_t *used, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static void tell(char *text, size_t size, size_t *used, const char *format, ...) {
  char piece[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(piece, sizeof piece, format, arguments);
  va_end(arguments);
  text_append(text, size, used, "%s%s", *used > 0 ? "; " : "", piece);
}

void fem_run_tell_trouble(const FemRunResult *result, const FemModel *model, char *text, size_t size) {
  const FemTrouble *trouble = &result->trouble;
  size_t used = 0;
  text[0] = 0;
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    char piece[256];
    if (trouble->of[k].steps == 0) continue;
    fem_trouble_tell(trouble, model, (FemTroubleKind)k, piece, sizeof piece);
    tell(text, size, &used, "%s", piece);
  }
  if (trouble->sliver_count > 0)
    tell(text, size, &used, "slivers: %d elements, the worst %d", trouble->sliver_count,
         trouble->worst_sliver);
  if (result->pairs.enclosed > 0) tell(text, size, &used, "enclosed pairs: %lld", result->pairs.enclosed);
  if (result->pairs.beyond > 0)
    tell(text, size, &used, "pairs beyond the network's training: %lld", result->pairs.beyond);
  if (result->pairs.fallbacks > 0)
    tell(text, size, &used, "pairs answered by a more careful model: %lld", result->pairs.fallbacks);
  if (result->energy_retries > 0)
    tell(text, size, &used, "steps taken back for their energy: %lld", result->energy_retries);
  if (result->solver.failed_factorisations > 0)
    tell(text, size, &used, "failed factorisations: %lld", result->solver.failed_factorisations);
  if (result->integrator.newton_failures > 0)
    tell(text, size, &used, "steps without convergence: %lld", result->integrator.newton_failures);
  if (used == 0) tell(text, size, &used, "none");
  if (isfinite(trouble->smallest_step))
    tell(text, size, &used, "smallest step %.1e s", trouble->smallest_step);
}

static void summarise_phases(const FemRunPhases *phases, Record *record) {
  record_number(record, "broad_phase", phases->broad_phase);
  record_number(record, "overlap", phases->overlap);
  record_number(record, "contact", phases->contact);
  record_number(record, "forces", phases->forces);
  record_number(record, "assembly", phases->assembly);
  record_number(record, "analysis", phases->analysis);
  record_number(record, "factorisation", phases->factorisation);
  record_number(record, "solve", phases->solve);
  record_number(record, "output", phases->output);
  double named = phases->broad_phase + phases->overlap + phases->contact + phases->forces + phases->assembly +
                 phases->analysis + phases->factorisation + phases->solve + phases->output;
  record_number(record, "other", phases->total - named);
}

static void summarise_counters(const FemRunResult *result, Record *record) {
  const FemIntegratorStats *stats = &result->integrator;
  record_integer(record, "setups", stats->setups);
  record_integer(record, "newton_iterations", stats->newton_iterations);
  record_integer(record, "newton_failures", stats->newton_failures);
  record_integer(record, "error_test_failures", stats->error_test_failures);
  record_integer(record, "residuals", stats->residuals);
  record_integer(record, "onsets", stats->roots);
  record_integer(record, "restarts", stats->restarts);
  record_integer(record, "state_unknowns", result->state_unknowns);
  record_integer(record, "energy_retries", result->energy_retries);
  record_integer(record, "pattern_layouts", result->pattern_layouts);
  record_integer(record, "matrix_assemblies", result->assemblies);
  record_integer(record, "analyses", result->solver.analyses);
  record_integer(record, "factorisations", result->solver.factorisations);
  record_integer(record, "failed_factorisations", result->solver.failed_factorisations);
  record_integer(record, "linear_solves", result->solver.solves);
  record_integer(record, "linear_iterations", result->solver.iterations);
  record_number(record, "factor_entries", result->solver.factor_entries);
}

// A row for each effect that there was.
static void summarise_effects(const FemRunResult *result, Record *record) {
  for (int i = 0; i < result->effect_count; i++) {
    const FemEffectCost *cost = &result->effects[i].cost;
    Record *row = record_child(record, result->effects[i].name);
    record_number(row, "force_s", cost->force_s);
    record_integer(row, "force_calls", cost->force_calls);
    record_number(row, "jacobian_s", cost->jacobian_s);
    record_integer(row, "jacobian_calls", cost->jacobian_calls);
    record_number(row, "prepare_s", cost->prepare_s);
    record_integer(row, "prepare_calls", cost->prepare_calls);
  }
}

void fem_run_summarise(const FemRunResult *result, Record *summary) {
  record_number(summary, "end_time", result->end_time);
  record_number(summary, "wall_s", result->wall_s);
  record_number(summary, "cpu_s", result->cpu_s);
  record_integer(summary, "steps", result->integrator.steps);
  record_text(summary, "solver", result->solver_name);
  summarise_phases(&result->phases, record_child(summary, "phases"));
  summarise_effects(result, record_child(summary, "effects"));
  record_integer(summary, "pairs_max", result->pairs_max);
  record_number(summary, "overlap_volume_max", result->overlap_volume_max);
  record_number(summary, "deepest_overlap_max", result->deepest_overlap_max);
  record_number(summary, "contact_force_max", result->contact_force_max);
  record_number(summary, "contact_force_last", result->last_contact_force);
  record_number(summary, "energy_gain_relative", result->audit.gain / result->audit.scale);
  record_number(summary, "energy_scale", result->audit.scale);
  record_number(summary, "min_det_F", result->min_det_F);
  fem_trouble_record(&result->trouble, record_child(summary, "trouble"));
  if (result->is_static) {
    Record *equilibrium = record_child(summary, "equilibrium");
    record_number(equilibrium, "residual_N", result->residual);
    record_number(equilibrium, "residual_allowed_N", result->residual_allowed);
    record_integer(equilibrium, "relaxation_steps", result->relaxation_steps);
    record_integer(equilibrium, "halvings", result->halvings);
  }
  record_integer(summary, "peak_rss_bytes", (long long)result->peak_rss_bytes);
  Record *counters = record_child(summary, "counters");
  summarise_counters(result, counters);
  record_merge(counters, result->counters);
}
