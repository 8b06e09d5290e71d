// SPDX-License-Identifier: GPL-3.0-or-later
// What libFuzzer calls; FUZZ_TARGET is the target of this program.
#include <stdlib.h>

#include "target.h"

int LLVMFuzzerInitialize(int *argument_count, char ***arguments);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned number);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t room); // libFuzzer's own

int LLVMFuzzerInitialize(int *argument_count, char ***arguments) {
  (void)argument_count, (void)arguments;
  atexit(fuzz_target_remove_files);
  return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  FUZZ_TARGET.run(data, size);
  return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t room, unsigned number) {
  return FUZZ_TARGET.mutate ? FUZZ_TARGET.mutate(data, size, room, number, LLVMFuzzerMutate)
                            : LLVMFuzzerMutate(data, size, room);
}
