// SPDX-License-Identifier: GPL-3.0-or-later
// Work beside the caller's: in its order, with its failures, and at once where there is one thread.
#include <omp.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/files/background.h"
#include "suite.h"

typedef struct Work {
  atomic_int is_let_go;
  int done, threads; // threads: of a region within
  pthread_t thread;
  Status answer;
} Work;

static Status work(void *self) {
  Work *given = self;
  while (!atomic_load(&given->is_let_go)) sched_yield();
  given->thread = pthread_self();
  given->threads = omp_get_max_threads();
  given->done++;
  return given->answer ? status_fail(given->answer, "work %d went wrong", given->done) : STATUS_OK;
}

START_TEST(the_caller_goes_on_while_it_is_done) {
  Background background = {0};
  Work given = {0};
  omp_set_num_threads(2);
  ck_assert_ok(background_begin(&background, work, &given)); // which waits for what comes next
  atomic_store(&given.is_let_go, 1);
  ck_assert_ok(background_wait(&background));
  ck_assert_int_eq(given.done, 1);
  ck_assert_int_eq(given.threads, 1);
  ck_assert(!pthread_equal(given.thread, pthread_self()));
  ck_assert_ok(background_wait(&background));
  ck_assert_int_eq(given.done, 1);
}
END_TEST

START_TEST(a_failure_is_told_once_and_leaves_the_next_undone) {
  Background background = {0};
  Work given = {.is_let_go = 1, .answer = STATUS_IO};
  omp_set_num_threads(2);
  ck_assert_ok(background_begin(&background, work, &given));
  ck_assert_int_eq(background_begin(&background, work, &given), STATUS_IO);
  ck_assert_str_eq(status_message(), "work 1 went wrong");
  ck_assert_int_eq(given.done, 1);
  ck_assert_ok(background_wait(&background));
}
END_TEST

START_TEST(one_thread_does_it_at_once) {
  Background background = {0};
  Work given = {.is_let_go = 1};
  omp_set_num_threads(1);
  ck_assert_ok(background_begin(&background, work, &given));
  ck_assert_int_eq(given.done, 1);
  ck_assert(pthread_equal(given.thread, pthread_self()));
  given.answer = STATUS_IO;
  ck_assert_int_eq(background_begin(&background, work, &given), STATUS_IO);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("background");
  tcase_add_test(test_case, the_caller_goes_on_while_it_is_done);
  tcase_add_test(test_case, a_failure_is_told_once_and_leaves_the_next_undone);
  tcase_add_test(test_case, one_thread_does_it_at_once);
  return suite_run("background", test_case, 1);
}
