// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/audit.h"

#include <math.h>

static int compare_pairs(const ContactPair *a, const ContactPair *b) {
  if (a->facing != b->facing) return a->facing < b->facing ? -1 : 1;
  if (a->tets[0] != b->tets[0]) return a->tets[0] < b->tets[0] ? -1 : 1;
  return (a->tets[1] > b->tets[1]) - (a->tets[1] < b->tets[1]);
}

static double relative(double difference, double size) {
  if (difference == 0) return 0;
  return size == 0 ? INFINITY : difference / size;
}

// Σ|ΔV| / ΣV over the union of two sorted lists.
static double compare_volumes(const ContactEvaluation *a, const ContactEvaluation *b, int *pair_count) {
  double difference = 0, total = 0;
  *pair_count = 0;
  for (int i = 0, j = 0; i < a->pair_count || j < b->pair_count; (*pair_count)++) {
    int order = i == a->pair_count ? 1 : j == b->pair_count ? -1 : compare_pairs(&a->pairs[i], &b->pairs[j]);
    double left = order <= 0 ? a->volumes[i++] : 0, right = order >= 0 ? b->volumes[j++] : 0;
    difference += fabs(left - right);
    total += right;
  }
  return relative(difference, total);
}

static double compare_forces(const ContactLayout *layout, const ContactEvaluation *a,
                             const ContactEvaluation *b) {
  double difference = 0, total = 0;
  for (size_t k = 0; k < 3 * (size_t)layout->def.vertex_count; k++) {
    double d = a->forces[k] - b->forces[k];
    difference += d * d;
    total += b->forces[k] * b->forces[k];
  }
  return relative(sqrt(difference), sqrt(total));
}

ContactAudit contact_audit_compare(const ContactLayout *layout, const ContactEvaluation *candidate,
                                   const ContactEvaluation *reference) {
  ContactAudit audit;
  audit.volume_error = compare_volumes(candidate, reference, &audit.pair_count);
  audit.force_error = compare_forces(layout, candidate, reference);
  return audit;
}
