// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/checkpoint/numbers.h"

#include <assert.h>

#define AT(member) offsetof(FemCheckpoint, member)
#define AUDIT(name, unit)                                                                                    \
  { "audit/" #name, FEM_REAL, AT(audit.name), unit }
// A number of the result so far; one that a part of it has.
#define RESULT(name, type, unit)                                                                             \
  { "so_far/" #name, type, AT(so_far.name), unit }
#define PART(part, name, type, unit)                                                                         \
  { "so_far/" #part "/" #name, type, AT(so_far.part.name), unit }
#define PHASE(name) PART(cost, phases.name, FEM_REAL, "s")
#define COUNT(part, name) PART(part, name, FEM_LONG, "1")
// What a kind of trouble has done so far, and where it stood in the last state.
#define TROUBLE(kind, name)                                                                                  \
  {"so_far/trouble/" name "/steps", FEM_LONG, AT(so_far.trouble.of[kind].steps), "1"},                       \
      {"so_far/trouble/" name "/events", FEM_LONG, AT(so_far.trouble.of[kind].events), "1"},                 \
      {"so_far/trouble/" name "/most", FEM_INTEGER, AT(so_far.trouble.of[kind].most), "1"},                  \
      {"so_far/trouble/" name "/first_time", FEM_REAL, AT(so_far.trouble.of[kind].first_time), "s"},         \
      {"so_far/trouble/" name "/first", FEM_INTEGER, AT(so_far.trouble.of[kind].first), "1"},                \
      {"so_far/trouble/" name "/last_count", FEM_INTEGER, AT(so_far.trouble.last.count[kind]), "1"}, {       \
    "so_far/trouble/" name "/last_first", FEM_INTEGER, AT(so_far.trouble.last.first[kind]), "1"              \
  }
static const FemCheckpointNumber numbers[] = {
    {"time", FEM_REAL, AT(time), "s"},
    {"step", FEM_REAL, AT(step), "s"},
    {"next_frame", FEM_INTEGER, AT(next_frame), "1"},
    {"history/size", FEM_LONG, AT(history.size), "bytes of history.csv"},
    {"history/digest", FEM_LONG, AT(history.digest), "FNV-1a of 64 bits of these"},
    {"static/force_scale", FEM_REAL, AT(force_scale), "N"},
    {"static/driven_work", FEM_REAL, AT(driven_work), "J"},
    AUDIT(time, "s"),
    AUDIT(damped, "J"),
    AUDIT(dissipated, "J"),
    AUDIT(driven_work, "J"),
    AUDIT(work, "J"),
    AUDIT(total, "J"),
    AUDIT(uncertain, "J"),
    AUDIT(first, "J"),
    AUDIT(lowest, "J"),
    AUDIT(gain, "J"),
    AUDIT(scale, "J"),
    AUDIT(gravity_at_start, "J"),
    AUDIT(dissipated_at_start, "J"),
    AUDIT(dissipated_power, "W"),
    AUDIT(driven_power, "W"),
    AUDIT(open, "J"),
    AUDIT(load_change, "J/s2"),
    AUDIT(own_power, "W"),
    AUDIT(refused_power, "W"),
    AUDIT(refused_step, "s"),
    PART(cost, wall_s, FEM_REAL, "s"),
    PART(cost, cpu_s, FEM_REAL, "s"),
    PART(cost, work_s, FEM_REAL, "s"),
    PHASE(start),
    PHASE(broad_phase),
    PHASE(overlap),
    PHASE(contact),
    PHASE(forces),
    PHASE(layout),
    PHASE(assembly),
    PHASE(analysis),
    PHASE(factorisation),
    PHASE(solve),
    PHASE(products),
    PHASE(integration),
    PHASE(measures),
    PHASE(output),
    PHASE(total),
    COUNT(integrator, steps),
    COUNT(integrator, setups),
    COUNT(integrator, newton_iterations),
    COUNT(integrator, error_test_failures),
    COUNT(integrator, newton_failures),
    COUNT(integrator, residuals),
    COUNT(integrator, restarts),
    COUNT(matrix, solver.analyses),
    COUNT(matrix, solver.factorisations),
    COUNT(matrix, solver.failed_factorisations),
    COUNT(matrix, solver.orders),
    COUNT(matrix, solver.hierarchies),
    COUNT(matrix, solver.solves),
    COUNT(matrix, solver.iterations),
    PART(matrix, solver.analyse_s, FEM_REAL, "s"),
    PART(matrix, solver.factorise_s, FEM_REAL, "s"),
    PART(matrix, solver.solve_s, FEM_REAL, "s"),
    PART(matrix, solver.factor_entries, FEM_REAL, "1"),
    PART(matrix, assemblies, FEM_LONG, "1"),
    PART(matrix, layouts, FEM_LONG, "1"),
    COUNT(retries, energy),
    COUNT(retries, momentum),
    COUNT(retries, slip),
    COUNT(equilibrium, relaxation_steps),
    COUNT(equilibrium, halvings),
    COUNT(equilibrium, loose),
    PART(equilibrium, stability.unstable, FEM_LONG, "1"),
    PART(equilibrium, stability.most, FEM_LONG, "1"),
    PART(equilibrium, stability.stable_until, FEM_REAL, "s"),
    PART(equilibrium, stability.unstable_from, FEM_REAL, "s"),
    PART(equilibrium, residual, FEM_REAL, "N"),
    PART(equilibrium, residual_allowed, FEM_REAL, "N"),
    COUNT(contact, pairs.tried),
    COUNT(contact, pairs.enclosed),
    COUNT(contact, pairs.fallbacks),
    COUNT(contact, pairs.by_net),
    COUNT(contact, pairs.blended),
    COUNT(contact, pairs.beyond),
    COUNT(contact, pairs.unsound),
    COUNT(status, pairs.asked),
    COUNT(status, pairs.overlapping),
    COUNT(status, pairs.false_positives),
    COUNT(status, pairs.false_negatives),
    PART(contact, pairs_max, FEM_INTEGER, "1"),
    PART(contact, overlap_volume_max, FEM_REAL, "m3"),
    PART(contact, force_max, FEM_REAL, "N"),
    PART(contact, force_since_row, FEM_REAL, "N"),
    PART(contact, force_last, FEM_REAL, "N"),
    RESULT(min_det_F, FEM_REAL, "1"),
    PART(contact, deepest_overlap_max, FEM_REAL, "1"),
    PART(trouble, smallest_step, FEM_REAL, "s"),
    TROUBLE(FEM_TROUBLE_INVERTED, "inverted"),
    TROUBLE(FEM_TROUBLE_ENCLOSED, "enclosed"),
    TROUBLE(FEM_TROUBLE_WRONG_WAY, "wrong_way"),
    TROUBLE(FEM_TROUBLE_ENERGY, "energy"),
    TROUBLE(FEM_TROUBLE_PASSED, "passed"),
    PART(trouble, passed[0], FEM_INTEGER, "1"),
    PART(trouble, passed[1], FEM_INTEGER, "1"),
    PART(momentum, gap, FEM_REAL, "1"),
    PART(momentum, body, FEM_INTEGER, "1"),
};
#undef TROUBLE
#undef COUNT
#undef PHASE
#undef PART
#undef RESULT
#undef AUDIT
#undef AT

// Whoever adds a number to one of these adds it to the list above.
static_assert(sizeof(FemAudit) == 20 * sizeof(double), "numbers[] lists every number of FemAudit");
static_assert(sizeof(FemRunPhases) == 15 * sizeof(double), "numbers[] lists every phase");
static_assert(sizeof(FemIntegratorStats) == 10 * sizeof(double), "numbers[] lists the integrator's counts");
static_assert(sizeof(FemSolverStats) == 11 * sizeof(double), "numbers[] lists the solver's counts");
static_assert(sizeof(ContactPairCounts) == 7 * sizeof(long long), "numbers[] lists the counts of pairs");
static_assert(sizeof(ContactStatusCounts) == 4 * sizeof(long long),
              "numbers[] lists the counts of the status");

static_assert(sizeof(FemRunRetries) == 3 * sizeof(long long), "numbers[] lists every kind of retry");
static_assert(sizeof(FemRunEquilibrium) == 9 * sizeof(double), "numbers[] lists the equilibrium's numbers");

static_assert(FEM_TROUBLE_KIND_COUNT == 5, "numbers[] lists every kind of trouble");

const FemCheckpointNumber *fem_checkpoint_numbers(int *count) {
  *count = sizeof numbers / sizeof *numbers;
  return numbers;
}
