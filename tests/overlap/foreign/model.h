// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs for models of users, and what is asked of these.
#ifndef TETLAP_TESTS_FOREIGN_MODEL_H
#define TETLAP_TESTS_FOREIGN_MODEL_H

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#include "base/random.h"
#include "overlap/models.h"
#include "suite.h"

enum { PAIRS = 300 };

static double pairs[PAIRS][24], volume[PAIRS], gradient[PAIRS][24], centroid[PAIRS][3];
static unsigned flags[PAIRS];

static inline void draw(void) {
  Random random = random_seeded(11, 0);
  for (int i = 0; i < PAIRS; i++)
    for (int v = 0; v < 24; v++)
      pairs[i][v] = random_uniform(&random) + (i % 3 == 2 && v >= 12 && v % 3 == 0);
}

static inline OverlapBatch batch_of(int count, bool with_gradient, bool with_centroid) {
  return (OverlapBatch){.pair_count = count,
                        .pairs = pairs[0],
                        .volume = volume,
                        .gradient = with_gradient ? gradient[0] : NULL,
                        .centroid = with_centroid ? centroid[0] : NULL,
                        .flags = flags};
}

static inline void open_model(OverlapModel *model, const char *word) {
  ck_assert_ok(overlap_models_create(model, word));
}

static inline void expect_refused(const char *word, Status status, const char *says) {
  OverlapModel model;
  ck_assert_int_eq(overlap_models_create(&model, word), status);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
}

static inline void expect_failure(const char *word, Status status, const char *says) {
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, false, true);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), status);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
  overlap_model_destroy(&model);
}

// What a command prints; its exit code.
static inline int run_program(const char *words, char text[20000]) {
  char command[2000];
  snprintf(command, sizeof command, "{ %s %s; } 2>&1", TETLAP_PROGRAM, words);
  FILE *stream = popen(command, "r");
  ck_assert_ptr_nonnull(stream);
  text[fread(text, 1, 19999, stream)] = 0;
  int how = pclose(stream);
  return WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

#endif
