// SPDX-License-Identifier: GPL-3.0-or-later
// A pair in static friction, made by hand: two tetrahedra that share a point, pressed by a force that is
// given.
#ifndef TETLAP_TESTS_CONTACT_FRICTION_STICK_PAIR_H
#define TETLAP_TESTS_CONTACT_FRICTION_STICK_PAIR_H

#include <string.h>

#include "base/vec3.h"
#include "contact/friction/stick_told.h"
#include "suite.h"

static const double MU = 0.5, STIFFNESS = 2e4; // [Pa/m]
static const double AREA = 0.03, PRESS = 12;   // [m²], [N]

// A above, B below, both around the origin; x̄ is a point of space that both cover.
static const double REST[24] = {-0.5, -0.4, -0.3, 0.9, -0.2, -0.2, -0.1, 1.1,  -0.25, 0.1, 0.2, 0.9,
                                -0.6, -0.5, 0.3,  0.2, 1.0,  0.25, 0.8,  -0.3, 0.2,   0.0, 0.1, -0.8};
static const int TETS[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
static const double MEET[3] = {0.1, 0.05, 0.02};

typedef struct Fixture {
  ContactStick stick;
  double before[24], *history; // of the last accepted state
  size_t history_count;
  double x[24];
  double meet[3], force[3]; // x̄ and what presses A
  double area;              // that the pair covers
  bool has_body_below;      // else an obstacle without elements
  double obstacle[3];       // way of that since the last accepted state
} Fixture;

// Barycentric coordinates of p.
static inline void locate(const double *x, const int tet[4], const double *p, double lambda[4]) {
  Vec3 corner[4];
  for (int v = 0; v < 4; v++) corner[v] = vec3_at(x + 3 * tet[v]);
  double whole = vec3_det4(corner[0], corner[1], corner[2], corner[3]);
  for (int v = 0; v < 4; v++) {
    Vec3 other[4] = {corner[0], corner[1], corner[2], corner[3]};
    other[v] = vec3_at(p);
    lambda[v] = vec3_det4(other[0], other[1], other[2], other[3]) / whole;
  }
}

static inline ContactStickHistory history_of(const Fixture *f) {
  return contact_stick_history_view(1, f->history, f->history_count);
}

static inline void eval_pairs(Fixture *f, int count, const bool *is_resting) {
  const ContactStickLast last = {.positions = f->before, .history = history_of(f)};
  ck_assert_ok(contact_stick_eval(&f->stick, &last, count, f->x, is_resting));
}

static inline void eval(Fixture *f) {
  ck_assert_ok(contact_stick_reserve(&f->stick, 1));
  ContactStickPair *pair = &f->stick.pairs[0];
  *pair = (ContactStickPair){.tets = {0, f->has_body_below ? 1 : -1}, .area = f->area};
  memcpy(pair->force, f->force, sizeof f->force);
  for (int side = 0; side < 2; side++) locate(f->x, TETS[side], f->meet, pair->lambda[side]);
  vec3_store(pair->before, vec3_sub(vec3_at(f->meet), vec3_at(f->obstacle)));
  eval_pairs(f, 1, NULL);
}

static inline void accept_resting(Fixture *f, const bool *is_resting) {
  const ContactStickHistory history = history_of(f);
  size_t count = contact_stick_next_count(&f->stick, &history, is_resting);
  double *next = calloc(count, sizeof *next);
  ck_assert_ptr_nonnull(next);
  contact_stick_advance(&f->stick, &history, is_resting, next);
  free(f->history);
  f->history = next;
  f->history_count = count;
  memcpy(f->before, f->x, sizeof f->x);
}

static inline void accept(Fixture *f) {
  accept_resting(f, NULL);
  memset(f->obstacle, 0, sizeof f->obstacle);
}

static inline Fixture *start(double weight_above, bool has_body_below) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  ContactStickLaw law = {.friction = MU, .stiffness = STIFFNESS, .weight = {weight_above, 1 - weight_above}};
  ck_assert_ok(contact_stick_create(&f->stick, 8, REST, TETS, 1, &law));
  memcpy(f->x, REST, sizeof f->x);
  memcpy(f->before, REST, sizeof f->before);
  f->history_count = contact_stick_history_count(1, 0);
  f->history = calloc(f->history_count, sizeof *f->history);
  ck_assert_ptr_nonnull(f->history);
  memcpy(f->meet, MEET, sizeof f->meet);
  f->force[2] = PRESS;
  f->area = AREA;
  f->has_body_below = has_body_below;
  eval(f);
  accept(f);
  return f;
}

static inline void finish(Fixture *f) {
  contact_stick_destroy(&f->stick);
  free(f->history);
  free(f);
}

static inline void shift(Fixture *f, int tet, double x, double y, double z) {
  for (int v = 0; v < 4; v++) vec3_accumulate(f->x + 3 * TETS[tet][v], (Vec3){x, y, z});
}

static inline Vec3 pull_of(const Fixture *f) {
  return vec3_at(f->stick.forces[0]);
}

static inline Vec3 turn(const double R[9], const double *x) {
  return (Vec3){R[0] * x[0] + R[1] * x[1] + R[2] * x[2], R[3] * x[0] + R[4] * x[1] + R[5] * x[2],
                R[6] * x[0] + R[7] * x[1] + R[8] * x[2]};
}

// About the axis (1, 2, 2)/3.
static inline void make_rotation(double angle, double R[9]) {
  const double n[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3}, c = cos(angle), s = sin(angle);
  const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) R[3 * i + j] = c * (i == j) + (1 - c) * n[i] * n[j] + s * cross[3 * i + j];
}

static inline void rotate(Fixture *f, const double R[9]) {
  for (int v = 0; v < 8; v++) vec3_store(f->x + 3 * v, turn(R, f->x + 3 * v));
  vec3_store(f->meet, turn(R, f->meet));
  vec3_store(f->force, turn(R, f->force));
}

#endif
