// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "programs.h"

const DeviceProgram *fake_kernels_program(const char *text, DeviceLanguage language) {
  const DeviceProgram *found = NULL;
  for (int k = 0; k < PROGRAM_COUNT && !found; k++) {
    char *whole;
    if (device_source_text(programs[k], language, &whole) != STATUS_OK) abort();
    if (strcmp(text, whole) == 0) found = programs[k];
    memory_free(whole);
  }
  return found;
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// Whether a word is among `length` letters.
static bool has_word(const char *text, size_t length, const char *word) {
  const size_t size = strlen(word);
  for (size_t k = 0; k + size <= length; k++)
    if (strncmp(text + k, word, size) == 0 && (k == 0 || !is_letter(text[k - 1])) &&
        (k + size == length || !is_letter(text[k + size])))
      return true;
  return false;
}

// Behind "#define NAME", where NAME are `length` letters; NULL: there is no such line.
static const char *definition(const char *text, const char *name, size_t length) {
  for (const char *at = strstr(text, "#define "); at; at = strstr(at + 1, "#define ")) {
    const char *begin = at + strlen("#define ");
    if (strncmp(begin, name, length) == 0 && !is_letter(begin[length])) return begin + length;
  }
  return NULL;
}

static void add_arguments(const char *text, const char *list, char end, FakeKernel *kernel);

static void add_argument(const char *text, const char *word, size_t length, FakeKernel *kernel) {
  while (length > 0 && !is_letter(*word)) word++, length--;
  while (length > 0 && !is_letter(word[length - 1])) length--;
  bool is_name = length > 0;
  for (size_t k = 0; k < length; k++) is_name = is_name && is_letter(word[k]);
  const char *others = is_name ? definition(text, word, length) : NULL;
  if (others) {
    add_arguments(text, others, '\n', kernel);
    return;
  }
  if (kernel->argument_count == DEVICE_MAX_ARGUMENTS) abort();
  kernel->kinds[kernel->argument_count++] = has_word(word, length, "GLOBAL") ? DEVICE_MEMORY
                                            : has_word(word, length, "int")  ? DEVICE_INT
                                                                             : DEVICE_DOUBLE;
}

// Declarations with commas between, to `end`; a line that ends with a backslash goes on.
static void add_arguments(const char *text, const char *list, char end, FakeKernel *kernel) {
  const char *begin = list, *at = list;
  for (; *at && (*at != end || at[-1] == '\\'); at++)
    if (*at == ',') {
      add_argument(text, begin, (size_t)(at - begin), kernel);
      begin = at + 1;
    }
  add_argument(text, begin, (size_t)(at - begin), kernel);
}

bool fake_kernels_find(const DeviceProgram *program, const char *text, const char *name, FakeKernel *kernel) {
  void *module;
  const size_t length = strlen(name);
  *kernel = (FakeKernel){0};
  if (device_host.build(NULL, program, &module) != STATUS_OK) return false;
  if (device_host.kernel(NULL, module, name, &kernel->host) != STATUS_OK) return false;
  kernel->host.items = program->items;
  for (const char *at = strstr(text, "KERNEL("); at; at = strstr(at + 1, "KERNEL(")) {
    const char *begin = strchr(at, ',') + 2;
    if (strncmp(begin, name, length) != 0 || begin[length] != ',') continue;
    add_arguments(text, begin + length + 1, ')', kernel);
    return true;
  }
  return false;
}

void fake_kernels_run(const FakeKernel *kernel, int groups, const DeviceArgument *arguments) {
  if (device_host.launch(NULL, &kernel->host, groups, arguments, kernel->argument_count) != STATUS_OK)
    abort();
}
