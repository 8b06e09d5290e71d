// SPDX-License-Identifier: GPL-3.0-or-later
// Something that is fed with arbitrary bytes and must obey its promises all the same: one target for each
// kind of input that comes from outside. libFuzzer drives a target through driver.c; replay.c runs all of
// them over their seeds and the files that are kept in corpus/.
#ifndef TETLAP_TESTS_FUZZ_TARGET_H
#define TETLAP_TESTS_FUZZ_TARGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FUZZ_MAX_INPUT = 1 << 18 }; // [bytes] of a seed

// Changes `size` bytes in place, at most `room` of them afterwards; returns the new size. What libFuzzer does
// by itself has this form.
typedef size_t (*FuzzPlainMutation)(uint8_t *data, size_t size, size_t room);

typedef struct FuzzTarget {
  const char *name;
  // Ends the program with a message if a promise is broken (FUZZ_CLAIM).
  void (*run)(const uint8_t *data, size_t size);
  // The k-th seed, at most FUZZ_MAX_INPUT bytes; 0: there are no more.
  size_t (*seed)(int k, uint8_t *data);
  // A mutation that knows the form of the input; NULL: bytes are changed without knowledge.
  size_t (*mutate)(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain);
} FuzzTarget;

extern const FuzzTarget fuzz_scene, fuzz_mesh, fuzz_weights, fuzz_dataset, fuzz_checkpoint, fuzz_pairs,
    fuzz_kernels, fuzz_table;

// What a target claims of the code that it feeds; `...` is a printf format with what was found instead.
#define FUZZ_CLAIM(is_true, ...)                                                                             \
  do {                                                                                                       \
    if (!(is_true)) fuzz_target_fail(__FILE__, __LINE__, #is_true, __VA_ARGS__);                             \
  } while (0)

_Noreturn void fuzz_target_fail(const char *file, int line, const char *claim, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

// Puts bytes into a file of that name in a folder of this process (in $TMPDIR, /tmp without) and returns its
// path, valid until the next call with this name. What cannot be written ends the program. The name is kept.
const char *fuzz_target_file(const char *name, const void *bytes, size_t size);
void fuzz_target_remove_files(void);

// The bytes of a file, at most `room`; 0: it does not fit. A file that is not there ends the program.
size_t fuzz_target_read(const char *path, uint8_t *data, size_t room);
// The same of a file of the source tree.
size_t fuzz_target_source(const char *name, uint8_t *data, size_t room);

#endif
