// SPDX-License-Identifier: GPL-3.0-or-later
// What the drivers of tests have in common: their calls are counted, one of them fails. Which, the test says
// that has loaded the driver (fake_fail), or, to a program that runs by itself, the environment:
//
//   FAKE_FAIL=FUNCTION:CALL:CODE:KIND   call number CALL (from 0) of a function returns CODE
//   FAKE_CALLS=FILE                     the functions and how often each was called, when the program ends
//
// What is still there when it ends is told on standard error.
#ifndef TETLAP_TESTS_DEVICE_FAKE_FAULTS_H
#define TETLAP_TESTS_DEVICE_FAKE_FAULTS_H

typedef enum FakeKind {
  FAKE_ONCE,  // that call alone
  FAKE_LOST,  // that one and all that follow
  FAKE_LATER, // all that follow: it is taken, as what is done later is
} FakeKind;

// Begins to count anew. `function`: NULL for all, counted together; `call` < 0: none fails.
void fake_fail(const char *function, int call, int code, FakeKind kind);

// Calls since then, of all functions if `function` is NULL; the first that failed, NULL: none.
int fake_calls(const char *function);
const char *fake_failed(void);

// Objects that were made and not given back.
int fake_kept(void);

// For drivers: 0, or what this call is to return; an object more, or less.
int fake_ask(const char *function);
void fake_keep(int objects);

// A function of a driver, whose prototype nobody else has.
#define FAKE(type, name, ...)                                                                                \
  type name(__VA_ARGS__);                                                                                    \
  type name(__VA_ARGS__)

// Returns what this call is to return, if it is to fail.
#define FAKE_ASK                                                                                             \
  do {                                                                                                       \
    const int fake_code_ = fake_ask(__func__);                                                               \
    if (fake_code_ != 0) return fake_code_;                                                                  \
  } while (0)

#endif
