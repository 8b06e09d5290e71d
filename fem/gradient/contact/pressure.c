// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/contact/pressure.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/pressure/field_pull.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/compliance/laws.h"

Status fem_pressure_check(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (!scene->contact.is_on) return status_fail(STATUS_INPUT, "the scene has no contact");
  if (fem_laws_are_wanted(&scene->contact))
    return status_fail(STATUS_INPUT, "contact.law: with it the pressure has no derivative");
  return STATUS_OK;
}

// A pair as the patch sees it.
typedef struct Touch {
  double share;       // W
  double force, area; // |F|, A
} Touch;

typedef struct Patch {
  const FemPressure *pressure;
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const double *marks;  // 1 in the patch, else 0, by the contact mesh's vertices    (…, 3)
  double largest;       // p of all pairs
  double pressed, area; // the sums above and below the line, with p over the largest
} Patch;

static int side_count(const Patch *patch, int k) {
  return patch->evaluation->pairs[k].cells[1] < 0 ? 1 : 2;
}

static double mark_of(const Patch *patch, int k, int t, int v) {
  const int *vertices = contact_layout_vertices(patch->layout, patch->evaluation->pairs[k].cells[t]);
  return patch->marks[3 * (size_t)vertices[v]];
}

static Touch touch_of(const Patch *patch, int k) {
  const ContactFieldPair *field = &patch->evaluation->fields[k];
  Touch touch = {.force = vec3_length(vec3_at(field->force)), .area = contact_field_area(field)};
  for (int t = 0; t < side_count(patch, k); t++)
    for (int v = 0; v < 4; v++) touch.share += field->weights[t][v] * mark_of(patch, k, t, v);
  if (!(touch.force > 0 && touch.area > 0)) touch.share = 0;
  return touch;
}

static void sum_up(Patch *patch) {
  int m = patch->pressure->power;
  for (int k = 0; k < patch->evaluation->pair_count; k++) {
    Touch touch = touch_of(patch, k);
    if (touch.share != 0) patch->largest = fmax(patch->largest, touch.force / touch.area);
  }
  for (int k = 0; k < patch->evaluation->pair_count; k++) {
    Touch touch = touch_of(patch, k);
    if (touch.share == 0) continue;
    double power = touch.share * pow(touch.force / touch.area / patch->largest, m);
    patch->pressed += power * touch.force;
    patch->area += power * touch.area;
  }
}

// ∂P/∂ of a pair's F, A and weights: with q = p over the largest, ∂(|F| qᵐ) = (m + 1) qᵐ ∂|F| − m p qᵐ ∂A and
// ∂(A qᵐ) = m qᵐ/p ∂|F| + (1 − m) qᵐ ∂A.
static ContactFieldSlopes slopes_of(const Patch *patch, int k, const Touch *touch, double value) {
  int m = patch->pressure->power;
  double p = touch->force / touch->area, scale = pow(p / patch->largest, m) / patch->area;
  double by_force = scale * touch->share * (m + 1 - m * value / p);
  double by_share = scale * (touch->force - value * touch->area);
  ContactFieldSlopes by = {.area = scale * touch->share * (-m * p - (1 - m) * value)};
  vec3_store(by.force, vec3_scale(by_force / touch->force, vec3_at(patch->evaluation->fields[k].force)));
  for (int t = 0; t < side_count(patch, k); t++)
    for (int v = 0; v < 4; v++) by.weights[t][v] = by_share * mark_of(patch, k, t, v);
  return by;
}

static void scale_slopes(ContactFieldSlopes *by, double weight) {
  by->area *= weight;
  for (int c = 0; c < 3; c++) by->force[c] *= weight;
  for (int i = 0; i < 8; i++) by->weights[i / 4][i % 4] *= weight;
}

// Adds a pair's slope by the vertices of its tetrahedra.
static void pull(const Patch *patch, const ContactStars *stars, int k, const double *slopes,
                 const ContactFieldSlopes *by) {
  const ContactEvaluation *evaluation = patch->evaluation;
  const ContactPair *pair = &evaluation->pairs[k];
  const double *coordinates = evaluation->coordinates + 24 * (size_t)k;
  double *answers = patch->pressure->answers, slope[24] = {0};
  if (side_count(patch, k) == 1)
    contact_field_pull_shape(patch->layout, pair, evaluation->time, coordinates, &evaluation->fields[k],
                             evaluation->pair_forces + 24 * (size_t)k, by, slope);
  else
    contact_field_pull(patch->layout, pair, coordinates, &evaluation->fields[k], slopes + 96 * (size_t)k, by,
                       slope, answers ? answers + 4 * (size_t)k : NULL);
  for (int z = 0; z < 4 * side_count(patch, k); z++) {
    int vertex = contact_layout_vertices(patch->layout, pair->cells[z / 4])[z % 4];
    contact_stars_push(stars, vertex, vec3_at(slope + 3 * z), patch->pressure->slope);
  }
}

static Status pull_all(FemPressure *pressure, const FemTangent *tangent, const Patch *patch, double value) {
  const double *slopes;
  TRY(contact_system_slopes(tangent->contact, patch->evaluation, &slopes));
  for (int k = 0; k < patch->evaluation->pair_count; k++) {
    const ContactPair *pair = &patch->evaluation->pairs[k];
    Touch touch = touch_of(patch, k);
    bool is_wanted = pressure->interface == CONTACT_ALL_INTERFACES || pressure->interface == pair->interface;
    if (touch.share == 0 || !is_wanted) continue;
    ContactFieldSlopes by = slopes_of(patch, k, &touch, value);
    scale_slopes(&by, pressure->weight);
    pressure->stiffness += vec3_dot(vec3_at(by.force), vec3_at(patch->evaluation->fields[k].force));
    pull(patch, contact_system_stars(tangent->contact), k, slopes, &by);
  }
  return STATUS_OK;
}

Status fem_pressure_find(FemPressure *pressure, const FemTangent *tangent, double *value) {
  const FemModel *model = tangent->system->model;
  const FemProbe *probe = &model->probes[pressure->probe];
  Patch patch = {.pressure = pressure, .layout = contact_system_layout(tangent->contact)};
  double *marks = memory_zeroed(3 * (size_t)model->vertex_count, sizeof *marks);
  if (!marks) return status_no_memory("the pressure on a patch");
  for (int i = 0; i < probe->vertex_count; i++) marks[3 * (size_t)probe->vertices[i]] = 1;
  Status status = fem_effect_contact_evaluate(tangent->system, tangent->state, &patch.evaluation);
  if (!status) {
    patch.marks = contact_system_spread(tangent->contact, marks);
    sum_up(&patch);
    *value = patch.area > 0 ? patch.pressed / patch.area : 0;
    pressure->stiffness = 0;
    if (pressure->slope && patch.area > 0) status = pull_all(pressure, tangent, &patch, *value);
  }
  memory_free(marks);
  return status;
}
