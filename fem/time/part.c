// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/part.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/ranks.h"

static int owner_of(const FemPart *part, const FemShare *share, int unknown) {
  return share->owner[part->numbering->dof_of_unknown[unknown] / 3];
}

static void order_unknowns(FemPart *part, const FemShare *share) {
  int rank_count = share->rank_count;
  for (int u = 0; u < part->n; u++) part->begin[owner_of(part, share, u) + 1]++;
  for (int r = 0; r < rank_count; r++) part->begin[r + 1] += part->begin[r];
  for (int u = 0; u < part->n; u++) part->order[part->begin[owner_of(part, share, u)]++] = u;
  for (int r = rank_count; r > 0; r--) part->begin[r] = part->begin[r - 1];
  part->begin[0] = 0;
  part->own = part->order + part->begin[share->rank];
  part->count = part->begin[share->rank + 1] - part->begin[share->rank];
}

Status fem_part_create(FemPart *part, const FemModel *model, const FemNumbering *numbering) {
  size_t n = (size_t)numbering->count;
  *part = (FemPart){.numbering = numbering, .n = numbering->count, .count = numbering->count};
  if (!model->share) return STATUS_OK;
  part->order = memory_zeroed(n, sizeof *part->order);
  part->begin = memory_zeroed((size_t)model->share->rank_count + 1, sizeof *part->begin);
  part->joined = memory_zeroed(2 * n, sizeof *part->joined);
  part->whole = memory_zeroed(2 * n, sizeof *part->whole);
  if (!part->order || !part->begin || !part->joined || !part->whole)
    return status_no_memory("the integrator");
  order_unknowns(part, model->share);
  return STATUS_OK;
}

void fem_part_destroy(FemPart *part) {
  memory_free(part->order), memory_free(part->begin);
  memory_free(part->joined), memory_free(part->whole);
  *part = (FemPart){0};
}

const double *fem_part_join(const FemPart *part, const double *own) {
  if (!part->order) return own;
  double *mine = part->joined + 2 * (part->own - part->order);
  for (int i = 0; i < part->count; i++) {
    mine[2 * i] = own[i];
    mine[2 * i + 1] = own[part->count + i];
  }
  ranks()->join(part->joined, 2 * sizeof *part->joined, part->begin);
  for (int p = 0; p < part->n; p++) {
    part->whole[part->order[p]] = part->joined[2 * (size_t)p];
    part->whole[part->n + part->order[p]] = part->joined[2 * (size_t)p + 1];
  }
  return part->whole;
}

void fem_part_take(const FemPart *part, const double *all, double *own) {
  if (part->order)
    for (int i = 0; i < part->count; i++) own[i] = all[part->own[i]];
  else
    memmove(own, all, (size_t)part->n * sizeof *own); // they may be one array
}

void fem_part_give(const FemPart *part, const double *own, double *all) {
  for (int i = 0; i < part->count; i++) all[fem_part_unknown(part, i)] = own[i];
}

double fem_part_sum(double own) {
  ranks()->sum(&own, 1);
  return own;
}

double fem_part_most(double own) {
  ranks()->most(&own, 1);
  return own;
}

// Among the 2·n of all ranks, of this one's i-th value.
static int number_of(const FemPart *part, int i) {
  return i < part->count ? fem_part_unknown(part, i) : part->n + fem_part_unknown(part, i - part->count);
}

int fem_part_worst(const FemPart *part, const double *values, const double *weights, int begin, int end) {
  int worst = -1;
  double largest = -1;
  for (int i = begin; i < end; i++) {
    double size = fabs(weights ? values[i] * weights[i] : values[i]);
    if (isnan(size)) size = INFINITY;
    if (size > largest) largest = size, worst = i;
  }
  double largest_of_all = fem_part_most(largest);
  return (int)fem_part_most(worst >= 0 && largest == largest_of_all ? number_of(part, worst) : 0);
}
