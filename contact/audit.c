// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/audit.h"

#include <math.h>

#include "base/vec3.h"

static int compare_pairs(const ContactPair *a, const ContactPair *b) {
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  if (a->cells[0] != b->cells[0]) return a->cells[0] < b->cells[0] ? -1 : 1;
  return (a->cells[1] > b->cells[1]) - (a->cells[1] < b->cells[1]);
}

double contact_audit_error(ContactAuditTerm term) {
  if (term.difference == 0) return 0;
  return term.size == 0 ? INFINITY : term.difference / term.size;
}

// The length of the difference of two pairs' forces; NULL: zero.
static double length_of(const double *force, const double *other) {
  double sum = 0;
  for (int c = 0; c < OVERLAP_PAIR_SIZE; c++) {
    double d = (force ? force[c] : 0) - (other ? other[c] : 0);
    sum += d * d;
  }
  return sqrt(sum);
}

// V and forces over the union of two sorted lists.
static void compare_overlaps(const ContactEvaluation *a, const ContactEvaluation *b, ContactAudit *audit) {
  for (int i = 0, j = 0; i < a->pair_count || j < b->pair_count; audit->pair_count++) {
    int order = i == a->pair_count ? 1 : j == b->pair_count ? -1 : compare_pairs(&a->pairs[i], &b->pairs[j]);
    const double *left = order <= 0 ? a->pair_forces + OVERLAP_PAIR_SIZE * (size_t)i : NULL,
                 *right = order >= 0 ? b->pair_forces + OVERLAP_PAIR_SIZE * (size_t)j : NULL;
    double left_volume = order <= 0 ? a->volumes[i++] : 0, right_volume = order >= 0 ? b->volumes[j++] : 0;
    audit->volume.difference += fabs(left_volume - right_volume);
    audit->volume.size += right_volume;
    audit->gradient.difference += length_of(left, right);
    audit->gradient.size += length_of(right, NULL);
  }
}

static ContactAuditTerm compare_totals(const ContactLayout *layout, const ContactEvaluation *a,
                                       const ContactEvaluation *b) {
  double difference = 0, total = 0;
  for (int f = 0; f < layout->interface_count; f++) {
    Vec3 left = vec3_at(a->interfaces[f].force), right = vec3_at(b->interfaces[f].force);
    Vec3 d = vec3_sub(left, right);
    difference += vec3_dot(d, d);
    total += vec3_dot(right, right);
  }
  return (ContactAuditTerm){sqrt(difference), sqrt(total)};
}

static ContactAuditTerm compare_forces(const ContactLayout *layout, const ContactEvaluation *a,
                                       const ContactEvaluation *b) {
  double difference = 0, total = 0;
  for (size_t k = 0; k < 3 * (size_t)layout->def.vertex_count; k++) {
    double d = a->forces[k] - b->forces[k];
    difference += d * d;
    total += b->forces[k] * b->forces[k];
  }
  return (ContactAuditTerm){sqrt(difference), sqrt(total)};
}

ContactAudit contact_audit_compare(const ContactLayout *layout, const ContactEvaluation *candidate,
                                   const ContactEvaluation *reference) {
  ContactAudit audit = {0};
  compare_overlaps(candidate, reference, &audit);
  audit.force = compare_forces(layout, candidate, reference);
  audit.total = compare_totals(layout, candidate, reference);
  return audit;
}
