// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/result/run_result.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/memory.h"
#include "base/text.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/limits.h"

// Steps and order are those of the part.
void fem_run_result_add_integrator(FemIntegratorStats *total, const FemIntegratorStats *part) {
  total->steps += part->steps, total->setups += part->setups, total->residuals += part->residuals;
  total->newton_iterations += part->newton_iterations, total->newton_failures += part->newton_failures;
  total->error_test_failures += part->error_test_failures;
  total->restarts += part->restarts;
  total->last_step = part->last_step, total->current_step = part->current_step;
  total->last_order = part->last_order;
}

void fem_run_result_add_solver(FemSolverStats *total, const FemSolverStats *part) {
  total->analyses += part->analyses, total->factorisations += part->factorisations;
  total->failed_factorisations += part->failed_factorisations, total->hierarchies += part->hierarchies;
  total->orders += part->orders;
  total->solves += part->solves, total->iterations += part->iterations;
  total->analyse_s += part->analyse_s, total->factorise_s += part->factorise_s;
  total->solve_s += part->solve_s;
  total->factor_entries = part->factor_entries;
}

static void add_cost(FemEffectCost *total, const FemEffectCost *part) {
  total->force_s += part->force_s, total->jacobian_s += part->jacobian_s;
  total->prepare_s += part->prepare_s;
  total->force_calls += part->force_calls, total->jacobian_calls += part->jacobian_calls;
  total->prepare_calls += part->prepare_calls;
  if (part->bytes_max > total->bytes_max) total->bytes_max = part->bytes_max;
}

static void add_pairs(ContactPairCounts *total, const ContactPairCounts *part) {
  total->tried += part->tried, total->enclosed += part->enclosed;
  total->fallbacks += part->fallbacks, total->by_net += part->by_net;
  total->blended += part->blended, total->beyond += part->beyond;
  total->unsound += part->unsound;
}

static void add_contact(FemRunResult *result, const ContactSystem *system) {
  const ContactCounters *counters = contact_system_counters(system);
  result->contact.is_on = true;
  result->contact.asks_model = contact_system_asks_model(system);
  add_pairs(&result->contact.pairs, &counters->pairs);
}

void fem_run_result_add_phases(FemRunPhases *phases, const FemSystem *system) {
  void *contact = fem_system_effect(system, &fem_effect_contact);
  if (contact) {
    const ContactCounters *counters = contact_system_counters(fem_effect_contact_system(contact));
    phases->broad_phase += counters->broad_s;
    phases->overlap += counters->overlap_s;
    phases->contact += counters->force_s + counters->update_s;
  }
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffectCost *cost = &system->costs[i];
    phases->assembly += cost->jacobian_s;
    if (system->effects[i].self == contact) continue;
    phases->forces += cost->force_s;
    phases->contact += cost->prepare_s;
  }
  phases->layout += system->layout_s;
}

void fem_run_result_add_system(FemRunResult *result, const FemSystem *system) {
  void *contact = fem_system_effect(system, &fem_effect_contact);
  if (contact) add_contact(result, fem_effect_contact_system(contact));
  fem_run_result_add_phases(&result->cost.phases, system);
  result->matrix.layouts += system->pattern_version;
  result->effect_count = system->effect_count;
  result->matrix.assemblies = 0;
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    result->effects[i].name = effect->ops->name;
    add_cost(&result->effects[i].cost, &system->costs[i]);
    if (result->effects[i].cost.jacobian_calls > result->matrix.assemblies)
      result->matrix.assemblies = result->effects[i].cost.jacobian_calls;
    if (effect->ops->report) effect->ops->report(effect->self, &system->accepted, result->counters);
  }
}

void fem_run_result_destroy(FemRunResult *result) {
  if (result->counters) record_destroy(result->counters);
  if (result->account.record) record_destroy(result->account.record);
  for (int i = 0; i < result->trajectory.interface_count; i++)
    memory_free(result->trajectory.interface_names[i]);
  memory_free(result->trajectory.interface_names);
  memory_free(result->trajectory.times);
  memory_free(result->trajectory.positions);
  memory_free(result->trajectory.interface_forces);
  *result = (FemRunResult){0};
}

// Appends a line.
static void append_line(char *text, size_t size, size_t *used, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static void append_line(char *text, size_t size, size_t *used, const char *format, ...) {
  char piece[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(piece, sizeof piece, format, arguments);
  va_end(arguments);
  text_append(text, size, used, "%s%s", *used > 0 ? "\n" : "", piece);
}

static const char UNSOUND[] = "pairs with a volume that no two such tetrahedra share";
static const char MEND_MODEL[] =
    "mend the model: with strict= before it a run ends at the first such pair and keeps it";

static bool is_unsound(const FemRunResult *result) {
  return (double)result->contact.pairs.unsound > FEM_DOUBT * (double)result->contact.pairs.tried;
}

Status fem_run_result_blame_model(const FemRunResult *result, Status status) {
  char message[2048];
  if (status != STATUS_SOLVER || !is_unsound(result)) return status;
  snprintf(message, sizeof message, "%s", status_message());
  return status_fail(status, "%s; before all else: %lld of %lld %s: %s", message,
                     result->contact.pairs.unsound, result->contact.pairs.tried, UNSOUND, MEND_MODEL);
}

static void append_trouble(char *text, size_t size, size_t *used, const char *what, const char *place,
                           const char *advice) {
  append_line(text, size, used, "%s", what);
  append_line(text, size, used, "  %s", place);
  append_line(text, size, used, "  what to do: %s", advice);
}

const char *fem_run_outcome(const FemRunResult *result, Status status) {
  if (status == STATUS_INTERRUPTED) return "interrupted";
  if (result->trouble.of[FEM_TROUBLE_PASSED].steps > 0) return "passed through";
  if (status) return "failed";
  return result->inside.count > 0 ? "inside each other" : "finished";
}

void fem_run_describe_inside(const FemRunInside *inside, const FemModel *model, char *text, size_t size) {
  snprintf(text, size, "'%s' and '%s': %d elements, element %d first",
           fem_compliance_party_name(model, inside->parties[0]),
           fem_compliance_party_name(model, inside->parties[1]), inside->count, inside->element);
}

void fem_run_describe_trouble(const FemRunResult *result, const FemModel *model, char *text, size_t size) {
  const FemTrouble *trouble = &result->trouble;
  size_t used = 0;
  text[0] = 0;
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    char place[256];
    if (trouble->of[k].steps == 0) continue;
    fem_trouble_place(trouble, model, (FemTroubleKind)k, place, sizeof place);
    append_trouble(text, size, &used, fem_trouble_what((FemTroubleKind)k), place,
                   fem_trouble_advice(trouble, model, (FemTroubleKind)k));
  }
  char place[256];
  if (result->inside.count > 0) {
    fem_run_describe_inside(&result->inside, model, place, sizeof place);
    append_trouble(text, size, &used, "bodies lie inside each other at the end", place,
                   "move them apart at the start, or by less than half of what is thinner");
  }
  if (trouble->sliver_count > 0) {
    snprintf(place, sizeof place, "%d elements, the worst is element %d", trouble->sliver_count,
             trouble->worst_sliver);
    append_trouble(text, size, &used, "slivers in the mesh", place, "mesh it anew");
  }
  if (!(result->momentum.gap <= FEM_MOMENTUM)) {
    snprintf(place, sizeof place, "of body '%s' by %.2g %% of all impulses",
             model->bodies[result->momentum.body].name, 100 * result->momentum.gap);
    append_trouble(text, size, &used, "forces and motion differ", place,
                   "try a smaller time.tolerance or time.max_step");
  }
  if ((double)result->contact.pairs.beyond > FEM_DOUBT * (double)result->contact.pairs.tried) {
    snprintf(place, sizeof place, "%lld of %lld", result->contact.pairs.beyond, result->contact.pairs.tried);
    append_trouble(text, size, &used, "pairs beyond the network's training", place,
                   "try contact.overlap: clip");
  }
  if (is_unsound(result)) {
    snprintf(place, sizeof place, "%lld of %lld", result->contact.pairs.unsound, result->contact.pairs.tried);
    append_trouble(text, size, &used, UNSOUND, place, MEND_MODEL);
  }
  const FemStability *stability = &result->equilibrium.stability;
  if (stability->unstable > 0) {
    char modes[64] = "";
    if (stability->most > 0) snprintf(modes, sizeof modes, ", up to %lld negative pivots", stability->most);
    snprintf(place, sizeof place, "a limit or a bifurcation between t = %.6g and %.6g s; %lld in all%s",
             stability->stable_until, stability->unstable_from, stability->unstable, modes);
    append_trouble(text, size, &used, "unstable equilibria", place,
                   "what follows is a way that a real body leaves: disturb it by a small force, or run it "
                   "without time.static");
  }
  if (used == 0) append_line(text, size, &used, "none");
}

void fem_run_describe_statistics(const FemRunResult *result, char *text, size_t size) {
  const struct {
    const char *what;
    long long count;
  } rows[] = {{"steps taken back for their energy", result->retries.energy},
              {"steps taken back for their momentum", result->retries.momentum},
              {"steps taken back at a reversal of slip", result->retries.slip},
              {"steps without convergence", result->integrator.newton_failures},
              {"failed factorisations", result->matrix.solver.failed_factorisations},
              {"enclosed pairs", result->contact.pairs.enclosed},
              {"pairs answered by a more careful model", result->contact.pairs.fallbacks},
              {"pairs beyond the network's training", result->contact.pairs.beyond},
              {UNSOUND, result->contact.pairs.unsound}};
  size_t used = 0;
  text[0] = 0;
  append_line(text, size, &used, "smallest det F %.3f (1: undeformed, 0: an element is flat)",
              result->min_det_F);
  if (!result->is_static)
    append_line(text, size, &used, "forces and motion agree to %.1e of all impulses", result->momentum.gap);
  if (isfinite(result->trouble.smallest_step))
    append_line(text, size, &used, "shortest step %.1e s", result->trouble.smallest_step);
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    if (rows[k].count > 0) append_line(text, size, &used, "%s: %lld", rows[k].what, rows[k].count);
}

double fem_run_result_named_s(const FemRunPhases *phases) {
  return phases->start + phases->broad_phase + phases->overlap + phases->contact + phases->forces +
         phases->layout + phases->assembly + phases->analysis + phases->factorisation + phases->solve +
         phases->products + phases->integration + phases->measures + phases->output;
}

static void summarise_phases(const FemRunPhases *phases, Record *record) {
  record_number(record, "start", phases->start);
  record_number(record, "broad_phase", phases->broad_phase);
  record_number(record, "overlap", phases->overlap);
  record_number(record, "contact", phases->contact);
  record_number(record, "forces", phases->forces);
  record_number(record, "layout", phases->layout);
  record_number(record, "assembly", phases->assembly);
  record_number(record, "analysis", phases->analysis);
  record_number(record, "factorisation", phases->factorisation);
  record_number(record, "solve", phases->solve);
  record_number(record, "products", phases->products);
  record_number(record, "integration", phases->integration);
  record_number(record, "measures", phases->measures);
  record_number(record, "output", phases->output);
  record_number(record, "other", phases->total - fem_run_result_named_s(phases));
}

static void summarise_counters(const FemRunResult *result, Record *record) {
  const FemIntegratorStats *stats = &result->integrator;
  record_integer(record, "setups", stats->setups);
  record_integer(record, "newton_iterations", stats->newton_iterations);
  record_integer(record, "newton_failures", stats->newton_failures);
  record_integer(record, "error_test_failures", stats->error_test_failures);
  record_integer(record, "residuals", stats->residuals);
  record_integer(record, "restarts", stats->restarts);
  record_integer(record, "state_unknowns", result->state_unknowns);
  record_integer(record, "energy_retries", result->retries.energy);
  record_integer(record, "momentum_retries", result->retries.momentum);
  record_integer(record, "slip_retries", result->retries.slip);
  record_integer(record, "pattern_layouts", result->matrix.layouts);
  record_integer(record, "matrix_assemblies", result->matrix.assemblies);
  record_integer(record, "analyses", result->matrix.solver.analyses);
  record_integer(record, "factorisations", result->matrix.solver.factorisations);
  record_integer(record, "failed_factorisations", result->matrix.solver.failed_factorisations);
  record_integer(record, "orders", result->matrix.solver.orders);
  record_integer(record, "hierarchies", result->matrix.solver.hierarchies);
  record_integer(record, "linear_solves", result->matrix.solver.solves);
  record_integer(record, "linear_iterations", result->matrix.solver.iterations);
  record_whole(record, "factor_entries", result->matrix.solver.factor_entries);
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
    record_integer(row, "bytes_max", cost->bytes_max);
  }
}

static void summarise_status(const ContactStatusCounts *pairs, Record *record) {
  record_integer(record, "pairs", pairs->asked);
  record_integer(record, "overlapping", pairs->overlapping);
  record_integer(record, "false_positive", pairs->false_positives);
  record_integer(record, "false_negative", pairs->false_negatives);
}

// In the order of fem/run/result/spread.c.
static const char *const spread_names[] = {
    "vertices",  "elements",   "matrix_entries", "peak_rss_bytes",  "cpu_s",     "work_s",
    "waiting_s", "calls",      "bytes_given",    "broad_phase_s",   "overlap_s", "contact_s",
    "forces_s",  "assembly_s", "analysis_s",     "factorisation_s", "solve_s",   "output_s",
};
static_assert(sizeof spread_names == FEM_RUN_SPREAD_COUNT * sizeof *spread_names, "one each");

static void summarise_ranks(const FemRunSpread *spread, Record *record) {
  record_integer(record, "count", spread->rank_count);
  for (int k = 0; k < FEM_RUN_SPREAD_COUNT; k++) {
    Record *row = record_child(record, spread_names[k]);
    record_number(row, "least", spread->least[k]);
    record_number(row, "mean", spread->mean[k]);
    record_number(row, "most", spread->most[k]);
  }
}

void fem_run_summarise(const FemRunResult *result, Record *summary) {
  record_number(summary, "end_time", result->end_time);
  record_number(summary, "wall_s", result->cost.wall_s);
  record_number(summary, "cpu_s", result->cost.cpu_s);
  record_integer(summary, "steps", result->integrator.steps);
  record_text(summary, "solver", result->matrix.solver_name);
  summarise_phases(&result->cost.phases, record_child(summary, "phases"));
  summarise_effects(result, record_child(summary, "effects"));
  record_integer(summary, "pairs_max", result->contact.pairs_max);
  if (result->contact.is_on) record_bool(summary, "uses_overlap_model", result->contact.asks_model);
  record_number(summary, "overlap_volume_max", result->contact.overlap_volume_max);
  record_number(summary, "deepest_overlap_max", result->contact.deepest_overlap_max);
  record_number(summary, "contact_force_max", result->contact.force_max);
  record_number(summary, "contact_force_last", result->contact.force_last);
  record_number(summary, "energy_gain_relative", result->energy.audit.gain / result->energy.audit.scale);
  record_number(summary, "energy_scale", result->energy.audit.scale);
  record_number(summary, "energy_gain_allowed", result->energy.bounds.run);
  record_number(summary, "energy_lost_J", fem_audit_lost(&result->energy.audit));
  record_number(summary, "energy_dissipated_J", result->energy.audit.dissipated);
  if (result->is_static) record_number(summary, "energy_open_J", result->energy.audit.open);
  if (!result->is_static) {
    record_number(summary, "energy_uncertain_J", result->energy.audit.uncertain);
    record_number(summary, "momentum_gap", result->momentum.gap);
    record_number(summary, "momentum_gap_allowed", FEM_MOMENTUM);
  }
  record_number(summary, "min_det_F", result->min_det_F);
  fem_trouble_record(&result->trouble, record_child(summary, "trouble"));
  if (result->is_static) {
    Record *equilibrium = record_child(summary, "equilibrium");
    record_number(equilibrium, "residual_N", result->equilibrium.residual);
    record_number(equilibrium, "residual_allowed_N", result->equilibrium.residual_allowed);
    record_integer(equilibrium, "relaxation_steps", result->equilibrium.relaxation_steps);
    record_integer(equilibrium, "halvings", result->equilibrium.halvings);
    record_integer(equilibrium, "loose", result->equilibrium.loose);
    const FemStability *stability = &result->equilibrium.stability;
    record_integer(equilibrium, "unstable", stability->unstable);
    record_integer(equilibrium, "negative_pivots", stability->most);
    record_number(equilibrium, "stable_until_s", stability->unstable ? stability->stable_until : NAN);
    record_number(equilibrium, "unstable_from_s", stability->unstable ? stability->unstable_from : NAN);
  }
  if (result->status.is_asked) summarise_status(&result->status.pairs, record_child(summary, "status"));
  record_integer(summary, "peak_rss_bytes", (long long)result->cost.peak_rss_bytes);
  if (result->spread.rank_count > 0) summarise_ranks(&result->spread, record_child(summary, "ranks"));
  record_merge(summary, result->account.record);
  Record *counters = record_child(summary, "counters");
  summarise_counters(result, counters);
  record_merge(counters, result->counters);
}
