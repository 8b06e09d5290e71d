// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of net/ share: networks of random shape with random parameters, and random arrays.
#ifndef TETLAP_TESTS_NET_SUITE_H
#define TETLAP_TESTS_NET_SUITE_H

#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "net/memory.h"
#include "net/net.h"

#define ck_net_ok(call)                                                                                      \
  do {                                                                                                       \
    NetStatus ck_status_ = (call);                                                                           \
    ck_assert_msg(ck_status_ == NET_OK, "%s: %d: %s", #call, (int)ck_status_, net_status_message());         \
  } while (0)

// The call fails with `code` and a message that contains `words`.
#define ck_net_fails(call, code, words)                                                                      \
  do {                                                                                                       \
    NetStatus ck_status_ = (call);                                                                           \
    ck_assert_int_eq(ck_status_, code);                                                                      \
    ck_assert_msg(strstr(net_status_message(), words), "\"%s\" does not say \"%s\"", net_status_message(),   \
                  words);                                                                                    \
  } while (0)

static inline int net_suite_below(NetRandom *random, int count) {
  return (int)(net_random_uniform(random) * count);
}

static inline NetWidths net_suite_widths(NetRandom *random, int least) {
  NetWidths widths = {.count = least + net_suite_below(random, 3)};
  for (int k = 0; k < widths.count; k++) widths.width[k] = 1 + net_suite_below(random, 20);
  return widths;
}

static inline NetShape net_suite_shape(NetRandom *random, NetKind kind) {
  NetShape shape = {.kind = kind, .activation = (NetActivation)net_suite_below(random, 2)};
  if (kind == NET_MLP) {
    shape.hidden = net_suite_widths(random, 0);
    shape.input_count = 1 + net_suite_below(random, 30);
    shape.output_count = 1 + net_suite_below(random, 3);
    return shape;
  }
  shape.pool = (NetPool)net_suite_below(random, 2);
  shape.has_coordinates = net_suite_below(random, 2);
  shape.vertex = net_suite_widths(random, 1);
  shape.tetrahedron = net_suite_widths(random, 1);
  shape.combiner = net_suite_widths(random, 1);
  shape.backbone = net_suite_widths(random, 0);
  shape.status_head = net_suite_widths(random, 0);
  shape.volume_head = net_suite_widths(random, 0);
  static const NetSkip of_tetrahedra[] = {NET_SKIP_NONE, NET_SKIP_BIASED, NET_SKIP_UNBIASED, NET_SKIP_OWN};
  shape.vertex_skip = (NetSkip)net_suite_below(random, 5);
  shape.tetrahedron_skip = of_tetrahedra[net_suite_below(random, 4)];
  shape.combiner_skip = (NetSkip)net_suite_below(random, 3);
  shape.has_one_tetrahedron = net_suite_below(random, 2);
  shape.ends_linear = net_suite_below(random, 2);
  shape.input_count = shape.has_one_tetrahedron ? 12 : 24;
  shape.output_count = 2;
  return shape;
}

static inline double *net_suite_array(NetRandom *random, int count, double scale) {
  double *array = net_memory_zeroed((size_t)count, sizeof *array);
  ck_assert_ptr_nonnull(array);
  for (int k = 0; k < count; k++) array[k] = net_random_between(random, -scale, scale);
  return array;
}

// Initial weights and, so that nothing is special, biases that are not 0.
static inline NetModel_f64 net_suite_model(const NetShape *shape, uint64_t seed) {
  NetModel_f64 model;
  ck_net_ok(net_model_create_f64(shape, &model));
  net_model_initialise_f64(&model, seed);
  NetRandom random = net_random_seeded(seed, 1000);
  for (size_t k = 0; k < model.plan->parameter_count; k++)
    model.parameters[k] += net_random_between(&random, -0.1, 0.1);
  return model;
}

// The same parameters in single precision.
static inline NetModel_f32 net_suite_narrow(const NetModel_f64 *from) {
  NetModel_f32 model;
  ck_net_ok(net_model_create_f32(&from->plan->shape, &model));
  for (size_t k = 0; k < from->plan->parameter_count; k++) model.parameters[k] = (float)from->parameters[k];
  return model;
}

static inline NetWork_f64 net_suite_work(const NetModel_f64 *model, int threads, int tangents, int batch) {
  NetWork_f64 work;
  NetWorkDef def = net_work_default();
  def.thread_count = threads, def.tangent_count = tangents, def.batch = batch;
  ck_net_ok(net_work_create_f64(model->plan, &def, &work));
  return work;
}

#endif
