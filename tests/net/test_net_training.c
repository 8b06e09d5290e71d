// SPDX-License-Identifier: GPL-3.0-or-later
// net/: losses, optimiser, schedule and whitening; training finds what is known to be there; the same bits
// for any number of threads and across a stop.
#include "net_suite.h"

#include <unistd.h>

START_TEST(losses_have_the_values_and_derivatives_that_a_hand_computes) {
  double d;
  ck_assert_near(net_loss_huber(0.05, 0.1, &d), 0.00125, 1e-18);
  ck_assert_near(d, 0.05, 0);
  ck_assert_near(net_loss_huber(-3, 0.1, &d), 0.1 * 2.95, 1e-15);
  ck_assert_near(d, -0.1, 0);
  ck_assert_near(net_loss_cross_entropy(0, 1, &d), log(2), 1e-15);
  ck_assert_near(d, -0.5, 1e-15);
  ck_assert_near(net_loss_cross_entropy(800, 0, &d), 800, 1e-12);
  ck_assert_near(d, 1, 1e-15);
  ck_assert_near(net_loss_cross_entropy(-800, 1, &d), 800, 1e-12);
  ck_assert_near(d, -1, 1e-15);
  ck_assert_msg(isnan(net_loss_huber(NAN, 0.1, &d)) && isnan(d), "NaN must stay NaN");

  // Two pairs: logits 0, volumes e − 1 against 0 and −5 (clamped) against 0: ½ ln 2 + ½ √(½).
  double y[4] = {0, exp(1) - 1, 0, -5}, labels[2] = {1, 0}, targets[2] = {0, 0}, gy[4];
  NetLossPaper loss = net_loss_paper_f64(2, y, labels, targets, gy);
  ck_assert_near(loss.cross_entropy, log(2), 1e-15);
  ck_assert_near(loss.rmsle, sqrt(0.5), 1e-15);
  ck_assert_near(loss.total, 0.5 * log(2) + 0.5 * sqrt(0.5), 1e-15);
  ck_assert_double_eq(gy[3], 0);
}
END_TEST

START_TEST(the_losses_derivatives_agree_with_differences) {
  enum { COUNT = 7, TANGENTS = 2 };
  NetRandom random = net_random_seeded(2, 0);
  double *y = net_suite_array(&random, 2 * COUNT, 2), *labels = net_suite_array(&random, COUNT, 1);
  double *targets = net_suite_array(&random, COUNT, 2), *yt = net_suite_array(&random, TANGENTS * COUNT, 1);
  double *tt = net_suite_array(&random, TANGENTS * COUNT, 1), *scale = net_suite_array(&random, COUNT, 1);
  double gy[2 * COUNT], gyt[TANGENTS * COUNT], unused[2 * COUNT], h = 1e-6;
  for (int k = 0; k < COUNT; k++) labels[k] = labels[k] > 0, targets[k] = fabs(targets[k]);
  net_loss_paper_f64(COUNT, y, labels, targets, gy);
  for (int k = 0; k < 2 * COUNT; k++) {
    double kept = y[k];
    y[k] = kept + h;
    double above = net_loss_paper_f64(COUNT, y, labels, targets, unused).total;
    y[k] = kept - h;
    double below = net_loss_paper_f64(COUNT, y, labels, targets, unused).total;
    y[k] = kept;
    ck_assert_near(gy[k], (above - below) / (2 * h), 1e-8);
  }
  net_loss_sobolev_f64(COUNT, TANGENTS, 0.1, y, yt, targets, tt, scale, gy, gyt);
  for (int k = 0; k < COUNT * (1 + TANGENTS); k++) {
    double *at = k < COUNT ? y + k : yt + k - COUNT, kept = *at, a[COUNT], b[TANGENTS * COUNT];
    *at = kept + h;
    double above = net_loss_sobolev_f64(COUNT, TANGENTS, 0.1, y, yt, targets, tt, scale, a, b);
    *at = kept - h;
    double below = net_loss_sobolev_f64(COUNT, TANGENTS, 0.1, y, yt, targets, tt, scale, a, b);
    *at = kept;
    ck_assert_near(k < COUNT ? gy[k] : gyt[k - COUNT], (above - below) / (2 * h), 1e-8);
  }
  double *arrays[] = {y, labels, targets, yt, tt, scale};
  for (int k = 0; k < 6; k++) net_memory_free(arrays[k]);
}
END_TEST

START_TEST(the_schedule_warms_up_and_follows_half_a_cosine) {
  NetSchedule schedule = {.peak = 2, .final = 1, .warmup_steps = 4, .total_steps = 104};
  ck_assert_near(net_schedule_rate(&schedule, 0), 0.5, 1e-15);
  ck_assert_near(net_schedule_rate(&schedule, 3), 2, 1e-15);
  ck_assert_near(net_schedule_rate(&schedule, 4), 2, 1e-15);
  ck_assert_near(net_schedule_rate(&schedule, 54), 1.5, 1e-12);
  ck_assert_near(net_schedule_rate(&schedule, 104), 1, 1e-15);
  ck_assert_near(net_schedule_rate(&schedule, 1000), 1, 1e-15);
}
END_TEST

// With patience 2 the third score without a gain of a ten-thousandth cuts; counting begins anew after it.
START_TEST(a_plateau_cuts_the_rate_after_its_patience) {
  NetPlateau plateau = {.factor = 0.5, .patience = 2, .best = INFINITY};
  const double scores[] = {1, 0.99995, 1.2, 0.9, NAN, 0.95, 0.9, 0.8999, 0.9, 0.9, 0.89};
  const int cuts[] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  for (int k = 0; k < 11; k++) {
    net_plateau_add(&plateau, scores[k]);
    ck_assert_int_eq(plateau.cuts, cuts[k]);
    ck_assert_near(net_plateau_rate(&plateau, 2, 0), cuts[k] ? 1 : 2, 1e-15);
  }
  plateau.cuts = 10;
  ck_assert_near(net_plateau_rate(&plateau, 2, 0.25), 0.25, 1e-15);
}
END_TEST

// The first step of Adam is rate · sign(g), whatever the gradient's length; decay comes on top.
START_TEST(the_first_steps_of_adam_are_those_of_its_definition) {
  NetAdamDef def = net_adam_default();
  def.weight_decay = 0.1;
  NetAdam_f64 adam;
  ck_net_ok(net_adam_create_f64(2, &def, &adam));
  double w[2] = {1, -2}, g[2] = {1e-3, -50};
  net_adam_step_f64(&adam, 0.01, g, w);
  ck_assert_near(w[0], 0.999 - 0.01, 1e-6);
  ck_assert_near(w[1], -2 * 0.999 + 0.01, 1e-6);
  // The second, by the definition's own formulas.
  double expected = w[1], m = (1 - 0.9) * -50, v = (1 - 0.999) * 2500, h[2] = {1e-3, 7};
  m = 0.9 * m + 0.1 * 7, v = 0.999 * v + 0.001 * 49;
  expected = expected * 0.999 - 0.01 * (m / (1 - 0.81)) / (sqrt(v / (1 - 0.999 * 0.999)) + 1e-8);
  net_adam_step_f64(&adam, 0.01, h, w);
  ck_assert_near(w[1], expected, 1e-12);
  net_adam_destroy_f64(&adam);
  def.beta2 = 1;
  ck_net_fails(net_adam_create_f64(2, &def, &adam), NET_BAD_ARGUMENT, "beta2");
}
END_TEST

START_TEST(clipping_keeps_direction_and_leaves_what_is_short_or_not_finite) {
  double g[2] = {3, 4}, n[2] = {NAN, 1};
  ck_assert_near(net_adam_clip_f64(2, 10, g), 5, 1e-15);
  ck_assert_double_eq(g[0], 3);
  ck_assert_near(net_adam_clip_f64(2, 1, g), 5, 1e-15);
  ck_assert_near(g[0], 0.6, 1e-15);
  ck_assert_near(g[1], 0.8, 1e-15);
  ck_assert(isnan(net_adam_clip_f64(2, 1, n)));
  ck_assert_double_eq(n[1], 1);
}
END_TEST

// An affine network and the mean squared error: the optimum is what generated the data.
START_TEST(training_a_linear_network_reaches_the_known_optimum) {
  enum { COUNT = 200, INPUTS = 5 };
  NetShape shape = net_shape_mlp(INPUTS, 0, 0, 1);
  NetModel_f64 model = net_suite_model(&shape, 1);
  NetWork_f64 work = net_suite_work(&model, 2, 0, COUNT);
  NetAdamDef def = net_adam_default();
  def.weight_decay = 0;
  NetAdam_f64 adam;
  ck_net_ok(net_adam_create_f64(model.plan->parameter_count, &def, &adam));
  NetRandom random = net_random_seeded(3, 0);
  double *x = net_suite_array(&random, COUNT * INPUTS, 1), y[COUNT], gy[COUNT], target[COUNT],
         gradient[INPUTS + 1];
  static const double truth[INPUTS + 1] = {0.3, -1.2, 2, 0, 0.7, -0.4};
  for (int s = 0; s < COUNT; s++) {
    target[s] = truth[INPUTS];
    for (int i = 0; i < INPUTS; i++) target[s] += truth[i] * x[s * INPUTS + i];
  }
  NetSchedule schedule = {.peak = 0.1, .warmup_steps = 10, .total_steps = 1500};
  for (int step = 0; step < 1500; step++) {
    net_gradient_forward_f64(&work, &model, COUNT, 0, x, NULL, y, NULL);
    for (int s = 0; s < COUNT; s++) gy[s] = 2 * (y[s] - target[s]) / COUNT;
    net_gradient_backward_f64(&work, &model, COUNT, 0, gy, NULL, gradient);
    net_adam_step_f64(&adam, net_schedule_rate(&schedule, step), gradient, model.parameters);
  }
  for (int k = 0; k <= INPUTS; k++) ck_assert_near(model.parameters[k], truth[k], 1e-6);
  net_memory_free(x);
  net_adam_destroy_f64(&adam);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

// Sobolev training of a SiLU network on f = sin(x₁) x₂ with tangents: a few hundred steps in a small fraction
// of the loss, and the gradient comes out right where it was never given in that direction.
typedef struct Task {
  NetModel_f32 model;
  NetWork_f32 work;
  NetAdam_f32 adam;
  NetSchedule schedule;
  NetRandom random;
  float *gradient, *best;
  double best_score;
} Task;

enum { BATCH = 300, WAYS = 2 };

static Task make_task(int threads) {
  NetShape shape = net_shape_mlp(2, 24, 2, 1);
  Task task = {.schedule = {.peak = 1e-2, .final = 1e-4, .warmup_steps = 20, .total_steps = 600},
               .random = net_random_seeded(21, 0),
               .best_score = INFINITY};
  ck_net_ok(net_model_create_f32(&shape, &task.model));
  net_model_initialise_f32(&task.model, 5);
  NetWorkDef def = net_work_default();
  def.thread_count = threads, def.batch = BATCH, def.tangent_count = WAYS;
  ck_net_ok(net_work_create_f32(task.model.plan, &def, &task.work));
  NetAdamDef adam = net_adam_default();
  ck_net_ok(net_adam_create_f32(task.model.plan->parameter_count, &adam, &task.adam));
  task.gradient = net_memory_zeroed(task.model.plan->parameter_count, sizeof *task.gradient);
  task.best = net_memory_zeroed(task.model.plan->parameter_count, sizeof *task.best);
  return task;
}

static void destroy_task(Task *task) {
  net_memory_free(task->gradient), net_memory_free(task->best);
  net_adam_destroy_f32(&task->adam);
  net_work_destroy_f32(&task->work);
  net_model_destroy_f32(&task->model);
}

static double step_task(Task *task) {
  float x[BATCH * 2], xt[BATCH * WAYS * 2], target[BATCH], target_t[BATCH * WAYS], scale[BATCH];
  float y[BATCH], yt[BATCH * WAYS], gy[BATCH], gyt[BATCH * WAYS];
  for (int s = 0; s < BATCH; s++) {
    double a = net_random_between(&task->random, -2, 2), b = net_random_between(&task->random, -1, 1);
    x[2 * s] = (float)a, x[2 * s + 1] = (float)b;
    target[s] = (float)(sin(a) * b);
    scale[s] = 1;
    for (int t = 0; t < WAYS; t++) {
      double u = net_random_normal(&task->random), v = net_random_normal(&task->random);
      int at = s * WAYS + t;
      xt[2 * at] = (float)u, xt[2 * at + 1] = (float)v;
      target_t[at] = (float)(cos(a) * b * u + sin(a) * v);
    }
  }
  net_gradient_forward_f32(&task->work, &task->model, BATCH, WAYS, x, xt, y, yt);
  double loss = net_loss_sobolev_f32(BATCH, WAYS, 0.1, y, yt, target, target_t, scale, gy, gyt);
  net_gradient_backward_f32(&task->work, &task->model, BATCH, WAYS, gy, gyt, task->gradient);
  net_adam_clip_f32(task->adam.count, 1, task->gradient);
  net_adam_step_f32(&task->adam, net_schedule_rate(&task->schedule, task->adam.step), task->gradient,
                    task->model.parameters);
  if (loss < task->best_score) {
    task->best_score = loss;
    memcpy(task->best, task->model.parameters, task->adam.count * sizeof *task->best);
  }
  return loss;
}

START_TEST(sobolev_training_learns_values_and_gradients) {
  Task task = make_task(1);
  double first = step_task(&task), last = 0;
  for (int k = 1; k < 600; k++) last = step_task(&task);
  ck_assert_msg(last < 2e-3 * first, "loss from %g to %g", first, last);
  float x[2] = {0.7f, -0.4f}, one = 1, y, gx[2];
  net_forward_gradient_f32(&task.work, &task.model, 1, x, &one, &y, gx);
  ck_assert_near((double)y, sin(0.7) * -0.4, 0.03);
  ck_assert_near((double)gx[0], cos(0.7) * -0.4, 0.06);
  ck_assert_near((double)gx[1], sin(0.7), 0.06);
  destroy_task(&task);
}
END_TEST

static bool equal_parameters(const Task *a, const Task *b) {
  return memcmp(a->model.parameters, b->model.parameters, a->adam.count * sizeof(float)) == 0 &&
         memcmp(a->adam.first, b->adam.first, a->adam.count * sizeof(float)) == 0 &&
         memcmp(a->adam.second, b->adam.second, a->adam.count * sizeof(float)) == 0;
}

START_TEST(the_number_of_threads_does_not_change_a_bit) {
  Task one = make_task(1), two = make_task(2), five = make_task(5);
  for (int k = 0; k < 30; k++) {
    double a = step_task(&one), b = step_task(&two), c = step_task(&five);
    ck_assert_double_eq(a, b);
    ck_assert_double_eq(a, c);
  }
  ck_assert(equal_parameters(&one, &two) && equal_parameters(&one, &five));
  destroy_task(&one), destroy_task(&two), destroy_task(&five);
}
END_TEST

// A batch whose chunks outnumber the lanes, of the paper's network.
START_TEST(a_large_batch_of_the_papers_network_is_the_same_for_any_number_of_threads) {
  enum { COUNT = 2500 };
  NetShape shape = net_shape_tpn_a();
  NetModel_f32 model;
  ck_net_ok(net_model_create_f32(&shape, &model));
  net_model_initialise_f32(&model, 5);
  NetRandom random = net_random_seeded(22, 0);
  float *x = net_memory_zeroed(COUNT * 24, sizeof *x), *gradient[2];
  float *y = net_memory_zeroed(COUNT * 2, sizeof *y), *gy = net_memory_zeroed(COUNT * 2, sizeof *gy);
  for (int k = 0; k < COUNT * 24; k++) x[k] = (float)net_random_uniform(&random);
  for (int k = 0; k < COUNT * 2; k++) gy[k] = (float)net_random_between(&random, -1, 1);
  for (int run = 0; run < 2; run++) {
    NetWork_f32 work;
    NetWorkDef def = net_work_default();
    def.thread_count = 1 + 2 * run, def.batch = COUNT;
    ck_net_ok(net_work_create_f32(model.plan, &def, &work));
    gradient[run] = net_memory_zeroed(model.plan->parameter_count, sizeof **gradient);
    net_gradient_forward_f32(&work, &model, COUNT, 0, x, NULL, y, NULL);
    net_gradient_backward_f32(&work, &model, COUNT, 0, gy, NULL, gradient[run]);
    net_work_destroy_f32(&work);
  }
  double length = 0;
  for (int k = 0; k < 73370; k++) length += (double)(gradient[0][k] * gradient[0][k]);
  ck_assert_double_gt(length, 1);
  ck_assert_int_eq(memcmp(gradient[0], gradient[1], model.plan->parameter_count * sizeof **gradient), 0);
  net_memory_free(x), net_memory_free(y), net_memory_free(gy);
  net_memory_free(gradient[0]), net_memory_free(gradient[1]);
  net_model_destroy_f32(&model);
}
END_TEST

// More chunks than lanes: nothing is left out and nothing counted twice.
START_TEST(the_gradient_of_a_large_batch_is_the_sum_of_its_parts) {
  enum { COUNT = 2500, PART = 100 };
  NetShape shape = net_shape_tpn_b();
  NetModel_f64 model = net_suite_model(&shape, 5);
  NetWork_f64 work = net_suite_work(&model, 2, 0, COUNT);
  int size = (int)model.plan->parameter_count;
  NetRandom random = net_random_seeded(23, 0);
  double *x = net_suite_array(&random, COUNT * 24, 1), *gy = net_suite_array(&random, COUNT * 2, 1);
  double *y = net_suite_array(&random, COUNT * 2, 0), *whole = net_suite_array(&random, size, 0);
  double *part = net_suite_array(&random, size, 0), *sum = net_suite_array(&random, size, 0);
  net_gradient_forward_f64(&work, &model, COUNT, 0, x, NULL, y, NULL);
  net_gradient_backward_f64(&work, &model, COUNT, 0, gy, NULL, whole);
  for (int first = 0; first < COUNT; first += PART) {
    net_gradient_forward_f64(&work, &model, PART, 0, x + first * 24, NULL, y, NULL);
    net_gradient_backward_f64(&work, &model, PART, 0, gy + first * 2, NULL, part);
    for (int k = 0; k < size; k++) sum[k] += part[k];
  }
  double scale = 0;
  for (int k = 0; k < size; k++) scale = fmax(scale, fabs(whole[k]));
  for (int k = 0; k < size; k++) ck_assert_near(whole[k], sum[k], 1e-13 * COUNT * scale);
  double *arrays[] = {x, gy, y, whole, part, sum};
  for (int k = 0; k < 6; k++) net_memory_free(arrays[k]);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

static NetCheckpoint_f32 describe(Task *task) {
  return (NetCheckpoint_f32){.model = &task->model,
                             .adam = &task->adam,
                             .best = task->best,
                             .best_score = task->best_score,
                             .schedule = task->schedule,
                             .random = task->random};
}

START_TEST(a_resumed_training_continues_to_the_bit) {
  char path[64];
  snprintf(path, sizeof path, "/tmp/tetlap_checkpoint_%ld", (long)getpid());
  Task whole = make_task(1), stopped = make_task(1), resumed = make_task(2);
  for (int k = 0; k < 40; k++) step_task(&whole);
  for (int k = 0; k < 25; k++) step_task(&stopped);
  // Nothing of the resumed task's own may be left.
  resumed.schedule = (NetSchedule){0}, resumed.random = (NetRandom){{0}}, resumed.best_score = 0;
  resumed.adam.def = (NetAdamDef){0};
  NetCheckpoint_f32 written = describe(&stopped), read = describe(&resumed);
  written.note = "epoch 3 — {\"seen\": 7500}";
  ck_net_ok(net_whitening_create(3, &written.whitening));
  for (int k = 0; k < 9; k++) written.whitening.matrix[k] = 1.0 / (k + 3);
  ck_net_ok(net_checkpoint_write_f32(path, &written));
  ck_net_ok(net_checkpoint_read_f32(path, &read));
  ck_assert_str_eq(read.note, written.note);
  ck_assert_int_eq(read.whitening.count, 3);
  ck_assert_int_eq(memcmp(read.whitening.matrix, written.whitening.matrix, 9 * sizeof(double)), 0);
  ck_assert_int_eq(memcmp(stopped.best, resumed.best, stopped.adam.count * sizeof(float)), 0);
  ck_assert_double_eq(read.best_score, stopped.best_score);
  ck_assert_int_eq(resumed.adam.step, 25);
  resumed.random = read.random, resumed.schedule = read.schedule, resumed.best_score = read.best_score;
  for (int k = 0; k < 15; k++) step_task(&resumed);
  ck_assert(equal_parameters(&whole, &resumed));
  ck_assert_double_eq(resumed.schedule.final, whole.schedule.final);
  ck_assert_double_eq(whole.best_score, resumed.best_score);
  net_whitening_destroy(&written.whitening);
  net_checkpoint_release_f32(&read);
  destroy_task(&whole), destroy_task(&stopped), destroy_task(&resumed);
  unlink(path);
}
END_TEST

START_TEST(a_checkpoint_of_another_shape_or_precision_is_refused) {
  char path[64];
  snprintf(path, sizeof path, "/tmp/tetlap_checkpoint_%ld", (long)getpid());
  Task task = make_task(1);
  NetCheckpoint_f32 written = describe(&task);
  ck_net_ok(net_checkpoint_write_f32(path, &written));
  NetShape shape = net_shape_mlp(2, 24, 2, 1), other = net_shape_mlp(2, 24, 3, 1);
  NetModel_f64 wide;
  NetModel_f32 deep;
  NetAdam_f64 adam;
  NetAdamDef def = net_adam_default();
  ck_net_ok(net_model_create_f64(&shape, &wide));
  ck_net_ok(net_model_create_f32(&other, &deep));
  ck_net_ok(net_adam_create_f64(wide.plan->parameter_count, &def, &adam));
  double *best = net_memory_zeroed(wide.plan->parameter_count, sizeof *best);
  NetCheckpoint_f64 double_read = {.model = &wide, .adam = &adam, .best = best};
  ck_net_fails(net_checkpoint_read_f64(path, &double_read), NET_BAD_FILE, "precision");
  NetCheckpoint_f32 deep_read = describe(&task);
  deep_read.model = &deep;
  ck_net_fails(net_checkpoint_read_f32(path, &deep_read), NET_BAD_FILE, "another shape");
  net_memory_free(best);
  net_adam_destroy_f64(&adam);
  net_model_destroy_f64(&wide), net_model_destroy_f32(&deep);
  destroy_task(&task);
  unlink(path);
}
END_TEST

// Features that nearly depend on each other, of scales 1 to 1e6.
START_TEST(whitened_samples_are_uncorrelated_and_folding_changes_nothing) {
  enum { COUNT = 500, N = 6 };
  NetRandom random = net_random_seeded(8, 0);
  double *f = net_memory_zeroed(COUNT * N, sizeof *f), *w = net_memory_zeroed(COUNT * N, sizeof *w);
  for (int s = 0; s < COUNT; s++) {
    double a = net_random_normal(&random), b = net_random_normal(&random), c = net_random_normal(&random);
    double row[N] = {a, 1e6 * (a + b), 3 + a - 0.1 * c,
                     5, c + 1e-2 * b,  1e-3 * b + net_random_normal(&random)};
    memcpy(f + s * N, row, sizeof row);
  }
  NetWhitening whitening;
  ck_net_ok(net_whitening_fit(N, COUNT, f, &whitening));
  net_whitening_apply(&whitening, COUNT, f, w);
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      double mean = 0, product = 0;
      for (int s = 0; s < COUNT; s++)
        mean += w[s * N + i] / COUNT, product += w[s * N + i] * w[s * N + j] / COUNT;
      ck_assert_near(mean, 0, 1e-9);
      // The constant feature stays 0; the others have unit variance but for the 1e-8 under the root.
      if (i != j) ck_assert_near(product, 0, 1e-6);
      if (i == j) ck_assert(fabs(product - 1) < 1e-2 || fabs(product) < 1e-12);
    }
  NetShape shape = net_shape_mlp(N, 8, 2, 1);
  NetModel_f64 model = net_suite_model(&shape, 6);
  NetWork_f64 work = net_suite_work(&model, 1, 0, 0);
  double before[COUNT], after[COUNT];
  net_forward_eval_f64(&work, &model, COUNT, w, before);
  ck_net_ok(net_whitening_fold(&whitening, &model));
  net_forward_eval_f64(&work, &model, COUNT, f, after);
  for (int s = 0; s < COUNT; s++) ck_assert_near(after[s], before[s], 1e-9);

  NetShape other = net_shape_mlp(N + 1, 8, 2, 1);
  NetModel_f64 wrong = net_suite_model(&other, 6);
  ck_net_fails(net_whitening_fold(&whitening, &wrong), NET_BAD_ARGUMENT, "6 features");
  ck_net_fails(net_whitening_fit(N, 1, f, &(NetWhitening){0}), NET_BAD_ARGUMENT, "1 samples");
  net_model_destroy_f64(&wrong), net_model_destroy_f64(&model);
  net_work_destroy_f64(&work);
  net_whitening_destroy(&whitening);
  net_memory_free(f), net_memory_free(w);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_training");
  tcase_add_test(test_case, losses_have_the_values_and_derivatives_that_a_hand_computes);
  tcase_add_test(test_case, the_losses_derivatives_agree_with_differences);
  tcase_add_test(test_case, the_schedule_warms_up_and_follows_half_a_cosine);
  tcase_add_test(test_case, a_plateau_cuts_the_rate_after_its_patience);
  tcase_add_test(test_case, the_first_steps_of_adam_are_those_of_its_definition);
  tcase_add_test(test_case, clipping_keeps_direction_and_leaves_what_is_short_or_not_finite);
  tcase_add_test(test_case, training_a_linear_network_reaches_the_known_optimum);
  tcase_add_test(test_case, sobolev_training_learns_values_and_gradients);
  tcase_add_test(test_case, the_number_of_threads_does_not_change_a_bit);
  tcase_add_test(test_case, a_large_batch_of_the_papers_network_is_the_same_for_any_number_of_threads);
  tcase_add_test(test_case, the_gradient_of_a_large_batch_is_the_sum_of_its_parts);
  tcase_add_test(test_case, a_resumed_training_continues_to_the_bit);
  tcase_add_test(test_case, a_checkpoint_of_another_shape_or_precision_is_refused);
  tcase_add_test(test_case, whitened_samples_are_uncorrelated_and_folding_changes_nothing);
  return suite_run("net_training", test_case, 60);
}
