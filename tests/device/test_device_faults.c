// SPDX-License-Identifier: GPL-3.0-or-later
// What a device refuses in the middle: every operation that it is asked for fails once, in turn, for every
// model that has kernels. The failure comes through as it is, with its message; all that was taken is given
// back; and where the device is still there, the next call answers as if nothing had been.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "base/memory.h"
#include "datagen/hard.h"
#include "device/overlap/overlap.h"

enum { COUNT = 60, HARD = 40, ALL = COUNT + HARD };

typedef enum Fault {
  NO_FAULT,
  REFUSED, // that one call
  LOST,    // that call, and all that follow but for giving back
  FAULT_COUNT
} Fault;

// The device `host`, counted.
static struct {
  Fault fault;
  int calls, fails_at;    // the call that fails, counted from 0
  int memories, programs; // that are there
} state;

static bool fails(void) {
  const int call = state.calls++;
  return state.fault == REFUSED ? call == state.fails_at : state.fault == LOST && call >= state.fails_at;
}

#define REFUSE(code, what)                                                                                   \
  if (fails()) return status_fail(code, "the device of tests: %s", what)

static Status build(void *self, const DeviceProgram *program, void **module) {
  REFUSE(STATUS_DEVICE, "no build");
  state.programs++;
  return device_host.build(self, program, module);
}

static void discard(void *self, void *module) {
  if (module) state.programs--;
  device_host.discard(self, module);
}

static Status kernel(void *self, void *module, const char *name, DeviceKernel *found) {
  REFUSE(STATUS_DEVICE, "no kernel");
  return device_host.kernel(self, module, name, found);
}

static Status take(void *self, size_t bytes, DeviceMemory *memory) {
  REFUSE(STATUS_MEMORY, "no memory");
  TRY(device_host.take(self, bytes, memory));
  state.memories++;
  return STATUS_OK;
}

static void release(void *self, DeviceMemory *memory) {
  if (memory->at) state.memories--;
  device_host.release(self, memory);
}

static Status put(void *self, const DeviceMemory *to, size_t at, size_t bytes, const void *from) {
  REFUSE(STATUS_DEVICE, "not sent");
  ck_assert_uint_le(at + bytes, to->bytes);
  return device_host.put(self, to, at, bytes, from);
}

static Status get(void *self, const DeviceMemory *from, size_t at, size_t bytes, void *to) {
  REFUSE(STATUS_DEVICE, "not fetched");
  ck_assert_uint_le(at + bytes, from->bytes);
  return device_host.get(self, from, at, bytes, to);
}

static Status launch(void *self, const DeviceKernel *kernel_, int groups, const DeviceArgument *arguments,
                     int count) {
  REFUSE(STATUS_DEVICE, "not started");
  return device_host.launch(self, kernel_, groups, arguments, count);
}

static Status mark(void *self, DeviceMark which) {
  REFUSE(STATUS_DEVICE, "no clock");
  return device_host.mark(self, which);
}

static Status elapsed(void *self, double *seconds) {
  REFUSE(STATUS_DEVICE, "no clock");
  return device_host.elapsed(self, seconds);
}

static DeviceOps faulty;
static Device device;
static double pairs[ALL * 24];

typedef struct Answers {
  double volume[ALL], more[ALL * 24];
  unsigned flags[ALL];
} Answers;

static Status evaluate(DeviceOverlap *overlap, DeviceQuantity quantity, Answers *answers) {
  memset(answers, 0, sizeof *answers);
  const OverlapBatch batch = {.pair_count = ALL,
                              .pairs = pairs,
                              .volume = answers->volume,
                              .gradient = quantity == DEVICE_GRADIENT ? answers->more : NULL,
                              .centroid = quantity == DEVICE_CENTROID ? answers->more : NULL,
                              .flags = answers->flags};
  return device_overlap_eval(overlap, &batch);
}

// A model made and asked once, with the k-th call failing. False: there are not so many calls.
static bool fail_at(const char *model, DeviceQuantity quantity, Fault fault, int k, const Answers *expected) {
  static Answers answers;
  DeviceOverlap overlap;
  state.fault = fault, state.calls = 0, state.fails_at = k;
  Status status = device_overlap_create(&overlap, &device, model);
  const bool is_made = status == STATUS_OK;
  if (is_made) status = evaluate(&overlap, quantity, &answers);
  const bool has_failed = state.calls > k;
  if (has_failed) {
    ck_assert_msg(status == STATUS_DEVICE || status == STATUS_MEMORY, "%s, call %d: status %d", model, k,
                  (int)status);
    ck_assert_msg(strncmp(status_message(), "the device of tests: ", 21) == 0, "%s, call %d: %s", model, k,
                  status_message());
    // nothing but giving back is asked of a device that has failed
    ck_assert_msg(state.calls == k + 1, "%s, call %d: %d calls after it", model, k, state.calls - k - 1);
  } else {
    ck_assert_ok(status);
  }
  if (is_made && fault == REFUSED) {
    state.fault = NO_FAULT;
    ck_assert_ok(evaluate(&overlap, quantity, &answers));
    ck_assert_mem_eq(answers.volume, expected->volume, sizeof answers.volume);
    ck_assert_mem_eq(answers.more, expected->more, sizeof answers.more);
    ck_assert_mem_eq(answers.flags, expected->flags, sizeof answers.flags);
  }
  device_overlap_destroy(&overlap);
  ck_assert_msg(state.memories == 0 && state.programs == 0,
                "%s, call %d: %d memories and %d programs are kept", model, k, state.memories,
                state.programs);
  return has_failed;
}

START_TEST(every_call_that_fails_is_told_and_nothing_is_kept) {
  static Answers expected;
  const char *model = device_overlap_models[_i / FAULT_COUNT];
  const Fault fault = (Fault)(_i % FAULT_COUNT);
  if (fault == NO_FAULT) return;
  for (int quantity = 0; quantity < 3; quantity++) {
    DeviceOverlap overlap;
    int calls = 0;
    if (!device_overlap_gives(model, (DeviceQuantity)quantity)) continue;
    state.fault = NO_FAULT;
    ck_assert_ok(device_overlap_create(&overlap, &device, model));
    ck_assert_ok(evaluate(&overlap, (DeviceQuantity)quantity, &expected));
    // all ways are gone: stages, and pairs that the host answers
    ck_assert_int_gt(overlap.handed_on[overlap.stage_count - 1], 0);
    device_overlap_destroy(&overlap);
    while (fail_at(model, (DeviceQuantity)quantity, fault, calls, &expected)) calls++;
    printf("%s, quantity %d: %d calls\n", model, quantity, calls);
    ck_assert_int_gt(calls, 20);
  }
}
END_TEST

static bool make_pairs(void) {
  if (app_bench_pairs_make("uniform", COUNT, 3, pairs) != STATUS_OK) return false;
  for (int i = 0; i < HARD; i++)
    memcpy(pairs + (size_t)(COUNT + i) * 24, datagen_hard_make(i % DATAGEN_HARD_CLASS_COUNT, i).x,
           24 * sizeof *pairs);
  // The first flat: the host's, except for networks that choose which one comes first. Both flat: the host's.
  memset(pairs, 0, 12 * sizeof *pairs);
  memset(pairs + 24, 0, 24 * sizeof *pairs);
  return true;
}

int main(void) {
  setenv("CK_FORK", "no", 1);
  if (device_open(&device, "host") != STATUS_OK || !make_pairs()) return EXIT_FAILURE;
  faulty = device_host;
  faulty.build = build, faulty.discard = discard, faulty.kernel = kernel;
  faulty.take = take, faulty.release = release, faulty.put = put, faulty.get = get;
  faulty.launch = launch, faulty.mark = mark, faulty.elapsed = elapsed;
  device.ops = &faulty;
  TCase *cases = tcase_create("device_faults");
  tcase_add_loop_test(cases, every_call_that_fails_is_told_and_nothing_is_kept, 0,
                      DEVICE_OVERLAP_MODELS * FAULT_COUNT);
  int result = suite_run("device faults", cases, 300);
  device_close(&device);
  return result;
}
