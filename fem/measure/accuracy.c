// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/accuracy.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/pressure/patch/area.h"
#include "fem/effect/elements/elasticity.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"

static_assert(sizeof(FemAccuracyPair) == FEM_ACCURACY_KEPT * sizeof(double), "numbers only");

// A pair is estimated anew where its force has grown by as much as an estimate may err.
static const double GROWN = 1 + FEM_DOUBT;
// A peak this much above what two steps in a row have lasts one step.
static const double BRIEF = 2;

Status fem_accuracy_create(FemAccuracy *accuracy, const FemModel *model, const ContactSystem *contact) {
  *accuracy = (FemAccuracy){0};
  if (!contact) return STATUS_OK;
  accuracy->count = contact_system_layout(contact)->interface_count;
  size_t count = (size_t)accuracy->count;
  accuracy->pairs = memory_zeroed(count, sizeof *accuracy->pairs);
  accuracy->found = memory_zeroed(count, sizeof *accuracy->found);
  accuracy->places = memory_zeroed(count, sizeof *accuracy->places);
  accuracy->pressed = memory_zeroed(count, sizeof *accuracy->pressed);
  accuracy->forces = memory_zeroed(count, sizeof *accuracy->forces);
  accuracy->energies = memory_zeroed((size_t)model->body_count, sizeof *accuracy->energies);
  bool has_room = accuracy->pairs && accuracy->found && accuracy->places && accuracy->pressed &&
                  accuracy->forces && accuracy->energies;
  for (int i = 0; has_room && i < accuracy->count; i++) accuracy->pairs[i].seen = -INFINITY;
  return has_room ? STATUS_OK : status_no_memory("the accuracy of contact");
}

void fem_accuracy_destroy(FemAccuracy *accuracy) {
  memory_free(accuracy->pairs);
  memory_free(accuracy->found);
  memory_free(accuracy->places);
  memory_free(accuracy->pressed);
  memory_free(accuracy->forces);
  memory_free(accuracy->energies);
  *accuracy = (FemAccuracy){0};
}

// Of every body, scaled so that the sum is `elastic`: what the elements' own law leaves out is shared as the
// rest.
static void share_energy(FemAccuracy *accuracy, const FemSystem *system, const FemState *state,
                         double elastic) {
  const int count = system->model->scene->body_count;
  double sum = 0;
  void *elasticity = fem_system_effect(system, &fem_effect_elasticity);
  fem_effect_elasticity_energies(elasticity, state, accuracy->energies);
  for (int b = 0; b < count; b++) sum += accuracy->energies[b];
  for (int b = 0; b < count && sum > 0; b++) accuracy->energies[b] *= elastic / sum;
}

// Mean edge of the elements of a patch, each as if it were regular: V = e³ / (6 √2).
static double mean_edge(const ContactLayout *layout, const ContactPatches *patches,
                        const ContactPatch *patch) {
  double sum = 0;
  for (int e = patch->element_begin; e < patch->element_end; e++)
    sum += cbrt(6 * sqrt(2) * layout->tet_volumes[patches->elements[e].tet]);
  return sum / (patch->element_end - patch->element_begin);
}

// An element's share of Σ F and of what its pairs would press without edges.
typedef struct Push {
  double force[3], full;
} Push;

static void add_push(const ContactLayout *layout, const ContactEvaluation *evaluation, int k, Push *push) {
  const ContactFieldPair *field = &evaluation->fields[k];
  const ContactInterfaceDef *interface = &layout->interfaces[evaluation->pairs[k].interface];
  vec3_accumulate(push->force, vec3_at(field->force));
  double stiffness = interface->law ? contact_field_secant(field) : interface->stiffness;
  push->full += stiffness * (field->weighed[0] * vec3_length(vec3_at(field->slopes[1])) +
                             field->weighed[1] * vec3_length(vec3_at(field->slopes[0])));
}

// The pairs of an element are not beside each other, so its sums are kept in `pushes` (elements of the
// patch).
static double lost_at_rim(const ContactLayout *layout, const ContactEvaluation *evaluation,
                          const ContactPatch *patch, Push *pushes) {
  const ContactPatches *patches = &evaluation->patches;
  double along = 0, full = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++)
    add_push(layout, evaluation, k, &pushes[patches->pair_elements[k][0] - patch->element_begin]);
  for (int e = 0; e < patch->element_end - patch->element_begin; e++) {
    along += vec3_length(vec3_at(pushes[e].force));
    full += pushes[e].full;
  }
  return (full - along) / along;
}

static Status find_rim(const ContactLayout *layout, const ContactEvaluation *evaluation,
                       const ContactPatch *patch, double *rim) {
  *rim = NAN;
  if (!contact_layout_has_field(layout)) return STATUS_OK;
  Push *pushes = memory_zeroed((size_t)(patch->element_end - patch->element_begin), sizeof *pushes);
  if (!pushes) return status_no_memory("the accuracy of contact");
  *rim = fmax(0, lost_at_rim(layout, evaluation, patch, pushes));
  memory_free(pushes);
  return STATUS_OK;
}

// ½ F · depth of a patch, which is U where the law is linear.
static double energy_of(const ContactLayout *layout, const ContactEvaluation *evaluation,
                        const ContactPatch *patch) {
  double sum = 0;
  if (!layout->interfaces[patch->interface].law) return patch->energy;
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    const ContactFieldPair *field = &evaluation->fields[k];
    double area = contact_field_area(field), depth = area > 0 ? field->volume / area : 0;
    sum += 0.5 * vec3_length(vec3_at(field->force)) * depth;
  }
  return sum;
}

// Whether P of the patch is the largest so far; then `found` holds the values and places.
static bool is_largest(const ContactInterface *interface, double time, FemAccuracyPair *found) {
  if (!(interface->pressed > found->pressed)) return false;
  found->pressed = interface->pressed;
  found->time = time;
  found->resultant = vec3_length(vec3_at(interface->force));
  memcpy(found->centre, interface->centre, sizeof found->centre);
  return true;
}

// Whether the two store more than ever, U and what is elastic in them; then `found` holds it. What all bodies
// store is no less, and known.
static bool is_fullest(FemAccuracy *accuracy, const FemSystem *system, const FemState *state,
                       const ContactInterfaceDef *interface, double energy, double elastic,
                       FemAccuracyPair *found) {
  const int bodies = system->model->scene->body_count;
  if (!(energy + elastic > GROWN * found->stored)) return false;
  if (!accuracy->has_energies) share_energy(accuracy, system, state, elastic);
  accuracy->has_energies = true;
  double first = interface->a < bodies ? accuracy->energies[interface->a] : 0;
  double second =
      interface->b < bodies && interface->b != interface->a ? accuracy->energies[interface->b] : 0;
  if (!(energy + first + second > GROWN * found->stored)) return false;
  found->elastic[0] = first, found->elastic[1] = second;
  found->with = energy;
  found->stored = energy + first + second;
  found->full_time = state->time;
  return true;
}

static Status estimate(const ContactLayout *layout, const ContactEvaluation *evaluation,
                       const ContactPatch *patch, FemAccuracyPair *found) {
  found->estimated = found->pressed;
  found->energy = energy_of(layout, evaluation, patch);
  found->edge = mean_edge(layout, &evaluation->patches, patch);
  found->area = contact_area_find(layout, evaluation, patch);
  return find_rim(layout, evaluation, patch, &found->rim);
}

Status fem_accuracy_look(FemAccuracy *accuracy, const FemSystem *system, const ContactLayout *layout,
                         const ContactEvaluation *evaluation, const FemState *state, double elastic) {
  accuracy->found_count = 0;
  accuracy->has_energies = false;
  accuracy->time = state->time;
  for (int i = 0; i < accuracy->count; i++) {
    accuracy->pressed[i] = evaluation->interfaces[i].pressed;
    accuracy->forces[i] = vec3_length(vec3_at(evaluation->interfaces[i].force));
  }
  for (int p = 0; p < evaluation->patches.patch_count; p++) {
    const ContactPatch *patch = &evaluation->patches.patches[p];
    FemAccuracyPair *found = &accuracy->found[accuracy->found_count];
    const ContactInterface *interface = &evaluation->interfaces[patch->interface];
    if (!(interface->pressed > 0)) continue;
    *found = accuracy->pairs[patch->interface];
    bool is_more = is_largest(interface, state->time, found);
    is_more |= is_fullest(accuracy, system, state, &layout->interfaces[patch->interface],
                          energy_of(layout, evaluation, patch), elastic, found);
    if (!is_more) continue;
    if (found->pressed > GROWN * found->estimated) TRY(estimate(layout, evaluation, patch, found));
    accuracy->places[accuracy->found_count++] = patch->interface;
  }
  return STATUS_OK;
}

// Of a state that was accepted before, where a part of a run begins anew, nothing is new.
static void follow(FemAccuracyPair *pair, double time, double pressed, double force) {
  if (!(time > pair->seen)) return;
  pair->held = fmax(pair->held, fmin(pair->last, pressed));
  pair->last = pressed;
  pair->seen = time;
  if (!(force > pair->force)) return;
  pair->force = force;
  pair->force_time = time;
}

void fem_accuracy_accept(FemAccuracy *accuracy) {
  for (int i = 0; i < accuracy->found_count; i++) accuracy->pairs[accuracy->places[i]] = accuracy->found[i];
  for (int i = 0; i < accuracy->count; i++)
    follow(&accuracy->pairs[i], accuracy->time, accuracy->pressed[i], accuracy->forces[i]);
  accuracy->found_count = 0;
}

FemEstimate fem_accuracy_estimate(const FemAccuracyPair *pair, const FemModel *model, double stiffness) {
  const FemSceneDef *scene = model->scene;
  double depth = 2 * pair->energy / pair->estimated, tolerance = fem_model_position_tolerance(model);
  FemEstimate estimate = {.give = pair->with / (pair->with + pair->elastic[0] + pair->elastic[1]),
                          .give_time = pair->full_time,
                          .rim = pair->rim,
                          .depth = depth,
                          .depth_over_edge = depth / pair->edge,
                          .tolerance_over_depth = scene->is_static ? NAN : tolerance / depth,
                          .elements_across = sqrt(pair->area) / pair->edge,
                          .stiffness = stiffness,
                          .tolerance_for = NAN,
                          .is_brief = !scene->is_static && pair->seen > pair->time &&
                                      pair->pressed > BRIEF * pair->held};
  double by_give = estimate.give / (1 - estimate.give) * (1 - FEM_DOUBT) / FEM_DOUBT;
  double by_rim = isnan(estimate.rim) ? 0 : estimate.rim / FEM_DOUBT;
  estimate.stiffness_for = stiffness * fmax(1, fmax(by_give, by_rim));
  if (!isfinite(estimate.stiffness_for) || estimate.tolerance_over_depth > 1) estimate.stiffness_for = NAN;
  if (!scene->is_static)
    estimate.tolerance_for = scene->tolerance * fmin(1, FEM_DOUBT / estimate.tolerance_over_depth);
  return estimate;
}
