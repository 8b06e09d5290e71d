// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/net_overlap.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "contact/exact.h"
#include "contact/weights.h"
#include "net/forward.h"
#include "net/weights.h"

enum { SIZE = CONTACT_PAIR_SIZE, PORTION = 224 }; // two chunks of the network's passes

// The network's outputs, of which only those asked for are computed.
enum { STATUS = 1 << 0, VOLUME = 1 << 1 };

// A portion's pairs as the network sees them; used by one caller at a time.
typedef struct Desk {
  atomic_flag is_taken;
  NetWork_f32 work;
  int count;
  int pair[PORTION]; // index within the portion
  ContactNormalised normalised[PORTION];
  float x[PORTION * SIZE], gx[PORTION * SIZE], y[PORTION * 2], c[PORTION * 2];
} Desk;

typedef struct NetOverlap {
  NetModel_f32 model;
  NetCard card;
  ContactNormalisation kind;
  double scale; // the network tells scale · V' of the normalised pair
  int desk_count;
  Desk *desks; // (desk_count), owned
} NetOverlap;

void contact_net_overlap_print(ContactNormalisation kind, double scale,
                               char text[CONTACT_NET_NORMALISATION_TEXT]) {
  snprintf(text, CONTACT_NET_NORMALISATION_TEXT, "%s, V times %.17g", contact_normalise_name(kind), scale);
}

bool contact_net_overlap_parse(const char *text, ContactNormalisation *kind, double *scale) {
  char name[8];
  int used = 0;
  if (sscanf(text, "%7[a-z], V times %lf%n", name, scale, &used) != 2 || text[used]) return false;
  int found = 0;
  while (found < CONTACT_NORMALISE_COUNT &&
         strcmp(name, contact_normalise_name((ContactNormalisation)found)) != 0)
    found++;
  *kind = (ContactNormalisation)found;
  return found<CONTACT_NORMALISE_COUNT && * scale> 0 && isfinite(*scale);
}

static Status fail_as_net(NetStatus status) {
  Status code = status == NET_NO_MEMORY ? STATUS_MEMORY : status == NET_BAD_IO ? STATUS_IO : STATUS_INPUT;
  return status_fail(code, "%s", net_status_message());
}

void contact_net_overlap_destroy(void *self) {
  NetOverlap *overlap = self;
  if (!overlap) return;
  for (int d = 0; overlap->desks && d < overlap->desk_count; d++)
    net_work_destroy_f32(&overlap->desks[d].work);
  memory_free(overlap->desks);
  net_card_destroy(&overlap->card);
  net_model_destroy_f32(&overlap->model);
  memory_free(overlap);
}

static Status furnish(NetOverlap *overlap) {
  overlap->desk_count = omp_get_max_threads();
  overlap->desks = memory_zeroed((size_t)overlap->desk_count, sizeof *overlap->desks);
  if (!overlap->desks) return status_no_memory("the network's memory of evaluation");
  NetWorkDef def = net_work_default();
  for (int d = 0; d < overlap->desk_count; d++) {
    Desk *desk = &overlap->desks[d];
    atomic_flag_clear(&desk->is_taken);
    for (int k = 0; k < PORTION; k++) desk->c[2 * k + 1] = 1;
    NetStatus status = net_work_create_f32(overlap->model.plan, &def, &desk->work);
    if (status != NET_OK) return fail_as_net(status);
    desk->work.outputs = VOLUME;
  }
  return STATUS_OK;
}

static Status load(NetOverlap *overlap, const char *path) {
  NetStatus status = net_weights_read_f32(path, &overlap->model, &overlap->card);
  if (status != NET_OK) return fail_as_net(status);
  if (overlap->model.plan->shape.kind != NET_TPN)
    return status_fail(STATUS_INPUT, "%s: a TetrahedronPairNet is needed, this is another network", path);
  if (!contact_net_overlap_parse(overlap->card.normalisation, &overlap->kind, &overlap->scale))
    return status_fail(
        STATUS_INPUT,
        "%s: made for the normalisation '%s'; expected 'unit, V times NUMBER', 'pca, …' or 'sorted, …'", path,
        overlap->card.normalisation);
  return furnish(overlap);
}

Status contact_net_overlap_create(void **self, const char *path) {
  NetOverlap *overlap = memory_zeroed(1, sizeof *overlap);
  if (!overlap) return status_no_memory("an overlap model");
  Status status = load(overlap, path);
  if (status == STATUS_OK)
    *self = overlap;
  else
    contact_net_overlap_destroy(overlap);
  return status;
}

// A thread's own desk as a rule; another one if threads that OpenMP does not count are about.
static Desk *take(const NetOverlap *overlap) {
  for (int d = omp_get_thread_num();; d++) {
    Desk *desk = &overlap->desks[d % overlap->desk_count];
    if (!atomic_flag_test_and_set_explicit(&desk->is_taken, memory_order_acquire)) return desk;
  }
}

static void leave(Desk *desk) {
  atomic_flag_clear_explicit(&desk->is_taken, memory_order_release);
}

// Puts the pairs that can be normalised on the desk.
static void lay_out(const NetOverlap *overlap, Desk *desk, int count, const double *pairs) {
  desk->count = 0;
  for (int i = 0; i < count; i++) {
    ContactNormalised *normalised = &desk->normalised[desk->count];
    if (!contact_normalise(overlap->kind, pairs + (ptrdiff_t)i * SIZE, normalised)) continue;
    for (int c = 0; c < SIZE; c++) desk->x[desk->count * SIZE + c] = (float)normalised->pair[c];
    desk->pair[desk->count++] = i;
  }
}

static void write_pair(const NetOverlap *overlap, const Desk *desk, int at,
                       const ContactOverlapBatch *batch) {
  const ContactNormalised *normalised = &desk->normalised[at];
  size_t i = (size_t)desk->pair[at];
  double inner_volume = fmax(0, (double)desk->y[2 * at + 1]) / overlap->scale, inner[SIZE];
  batch->volume[i] = normalised->factor * inner_volume;
  if (batch->flags) batch->flags[i] = inner_volume > 0 ? 0 : CONTACT_OVERLAP_DISJOINT;
  if (!batch->gradient) return;
  if (inner_volume > 0) {
    for (int c = 0; c < SIZE; c++) inner[c] = (double)desk->gx[at * SIZE + c] / overlap->scale;
    contact_normalise_pull(normalised, inner_volume, inner, batch->gradient + i * SIZE);
  } else {
    memset(batch->gradient + i * SIZE, 0, SIZE * sizeof(double));
  }
}

static Status fall_back(const ContactOverlapBatch *batch, int i) {
  unsigned flags;
  size_t at = (size_t)i * SIZE;
  TRY(contact_overlap_exact.eval_pair(NULL, batch->pairs + at, batch->volume + i,
                                      batch->gradient ? batch->gradient + at : NULL, NULL, &flags));
  if (batch->flags) batch->flags[i] = flags | CONTACT_OVERLAP_FALLBACK;
  return STATUS_OK;
}

// At most PORTION pairs.
static Status eval_portion(const NetOverlap *overlap, const ContactOverlapBatch *batch) {
  Desk *desk = take(overlap);
  lay_out(overlap, desk, batch->pair_count, batch->pairs);
  if (batch->gradient)
    net_forward_gradient_f32(&desk->work, &overlap->model, desk->count, desk->x, desk->c, desk->y, desk->gx);
  else
    net_forward_eval_f32(&desk->work, &overlap->model, desk->count, desk->x, desk->y);
  Status status = STATUS_OK;
  for (int i = 0, at = 0; i < batch->pair_count && status == STATUS_OK; i++) {
    if (at < desk->count && desk->pair[at] == i)
      write_pair(overlap, desk, at++, batch);
    else
      status = fall_back(batch, i);
  }
  leave(desk);
  return status;
}

static ContactOverlapBatch portion_of(const ContactOverlapBatch *batch, int number) {
  int first = number * PORTION, left = batch->pair_count - first;
  size_t begin = (size_t)first * SIZE;
  return (ContactOverlapBatch){.pair_count = left < PORTION ? left : PORTION,
                               .pairs = batch->pairs + begin,
                               .volume = batch->volume + first,
                               .gradient = batch->gradient ? batch->gradient + begin : NULL,
                               .flags = batch->flags ? batch->flags + first : NULL};
}

Status contact_net_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch) {
  int count = (batch->pair_count + PORTION - 1) / PORTION, first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (count > 1)
  for (int p = 0; p < count; p++) {
    ContactOverlapBatch portion = portion_of(batch, p);
    if (eval_portion(self, &portion) != STATUS_OK && p < first_failed) first_failed = p;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  ContactOverlapBatch portion = portion_of(batch, first_failed);
  Status status = eval_portion(self, &portion);
  return status == STATUS_OK ? status_fail(STATUS_SOLVER, "pairs from %d on failed once and not again",
                                           first_failed * PORTION)
                             : status;
}

Status contact_net_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags) {
  (void)hessian;
  ContactOverlapBatch batch = {
      .pair_count = 1, .pairs = pair, .volume = volume, .gradient = gradient, .flags = flags};
  return eval_portion(self, &batch);
}

Status contact_net_overlap_logits(const void *self, int count, const double *pairs, double *logits) {
  const NetOverlap *overlap = self;
  Desk *desk = take(overlap);
  for (int first = 0; first < count; first += PORTION) {
    int size = count - first < PORTION ? count - first : PORTION;
    for (int i = 0; i < size; i++) logits[first + i] = -INFINITY;
    lay_out(overlap, desk, size, pairs + (ptrdiff_t)first * SIZE);
    desk->work.outputs = STATUS;
    net_forward_eval_f32(&desk->work, &overlap->model, desk->count, desk->x, desk->y);
    for (int at = 0; at < desk->count; at++) logits[first + desk->pair[at]] = (double)desk->y[2 * at];
  }
  desk->work.outputs = VOLUME;
  leave(desk);
  return STATUS_OK;
}

static Status create_shipped(void **self, const char *weights) {
  char path[4096];
  if (!weights) TRY(contact_weights_find("tpn", path, sizeof path));
  return contact_net_overlap_create(self, weights ? weights : path);
}

const ContactOverlapOps contact_overlap_tpn = {
    .name = "tpn",
    .help = "learned: the paper's TetrahedronPairNet; its gradient jumps, disjoint pairs feel ghosts",
    .has_hessian = false,
    .seconds_per_pair = 3e-6,
    .create = create_shipped,
    .eval_pair = contact_net_overlap_eval_pair,
    .eval_batch = contact_net_overlap_eval_batch,
    .destroy = contact_net_overlap_destroy,
};
