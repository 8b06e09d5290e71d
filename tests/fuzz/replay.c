// SPDX-License-Identifier: GPL-3.0-or-later
// Without libFuzzer: every target over its seeds and over the files that are kept of earlier findings.
//
//   fuzz_corpus                     all of them; part of ./check
//   fuzz_corpus TARGET FILE …       these files
//   fuzz_corpus --seeds TARGET DIR  writes the seeds as files, to start libFuzzer with
//   fuzz_corpus --random TARGET RUNS [SEED]
//                                   mutations of the seeds at full speed, blind to coverage; an input that
//                                   ends the program is left behind as crash-TARGET
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/random.h"
#include "target.h"

static const FuzzTarget *const targets[] = {&fuzz_scene,      &fuzz_mesh,  &fuzz_weights, &fuzz_dataset,
                                            &fuzz_checkpoint, &fuzz_pairs, &fuzz_kernels, &fuzz_table};
enum { TARGET_COUNT = sizeof targets / sizeof *targets, PATH_SIZE = 4096 };

// Exactly as large as the input, so that reading beyond it is seen by whoever watches memory.
static void run_exactly(const FuzzTarget *target, const uint8_t *data, size_t size) {
  uint8_t *copy = malloc(size ? size : 1);
  FUZZ_CLAIM(copy, "no memory for %zu bytes", size);
  memcpy(copy, data, size);
  target->run(copy, size);
  free(copy);
}

static int run_seeds(const FuzzTarget *target) {
  static uint8_t data[FUZZ_MAX_INPUT];
  int count = 0;
  for (size_t size; (size = target->seed(count, data)); count++) run_exactly(target, data, size);
  return count;
}

static void run_file(const FuzzTarget *target, const char *path) {
  static uint8_t data[1 << 22];
  size_t size = fuzz_target_read(path, data, sizeof data);
  printf("  %s\n", path);
  fflush(stdout);
  run_exactly(target, data, size);
}

static int run_kept(const FuzzTarget *target) {
  char folder[PATH_SIZE / 2], path[PATH_SIZE];
  snprintf(folder, sizeof folder, "%s/tests/fuzz/corpus/%s", TETLAP_SOURCE_DIR, target->name);
  DIR *list = opendir(folder);
  int count = 0;
  const struct dirent *entry;
  while (list && (entry = readdir(list))) {
    if (entry->d_name[0] == '.') continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    run_file(target, path);
    count++;
  }
  if (list) closedir(list);
  return count;
}

static const FuzzTarget *find(const char *name) {
  for (int t = 0; t < TARGET_COUNT; t++)
    if (strcmp(targets[t]->name, name) == 0) return targets[t];
  fprintf(stderr, "there is no target '%s'\n", name);
  exit(EXIT_FAILURE);
}

static void write_seeds(const FuzzTarget *target, const char *folder) {
  static uint8_t data[FUZZ_MAX_INPUT];
  int k = 0;
  for (size_t size; (size = target->seed(k, data)); k++) {
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/seed_%03d", folder, k);
    FILE *stream = fopen(path, "wb");
    FUZZ_CLAIM(stream && fwrite(data, 1, size, stream) == size && fclose(stream) == 0, "%s cannot be written",
               path);
  }
}

// Mutations without libFuzzer.

static Random blind;

// A byte, a number, a piece from elsewhere, one piece less.
static size_t change_blindly(uint8_t *data, size_t size, size_t room) {
  static const char digits[] = "0123456789-+.eE,:[]{}\"# \n";
  size_t place = size ? (size_t)random_bits(&blind) % size : 0,
         from = size ? (size_t)random_bits(&blind) % size : 0, length = (size_t)random_below(&blind, 16);
  if (size == 0 || (random_below(&blind, 6) == 0 && size + length < room)) { // longer
    memmove(data + place + length, data + place, size - place);
    for (size_t k = 0; k < length; k++) data[place + k] = (uint8_t)random_bits(&blind);
    return size + length;
  }
  switch (random_below(&blind, 6)) {
  case 0:
    data[place] ^= (uint8_t)(1 << random_below(&blind, 8));
    return size;
  case 1:
    data[place] = (uint8_t)random_bits(&blind);
    return size;
  case 2:
    data[place] = (uint8_t)digits[random_below(&blind, sizeof digits - 1)];
    return size;
  case 3: // shorter
    if (length > size - place) length = size - place;
    memmove(data + place, data + place + length, size - place - length);
    return size - length;
  default: // a copy
    if (length > size - place) length = size - place;
    if (length > size - from) length = size - from;
    memmove(data + place, data + from, length);
    return size;
  }
}

// What is being run, for the handler.
static struct {
  uint8_t data[FUZZ_MAX_INPUT];
  size_t size;
  char path[64];
} current;

static void keep_crash(int number) {
  int file = open(current.path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || write(file, current.data, current.size) < 0) _exit(EXIT_FAILURE);
  close(file);
  signal(number, SIG_DFL);
  raise(number);
}

static void run_random(const FuzzTarget *target, long long runs, uint64_t number) {
  int seed_count = 0;
  blind = random_seeded(number, 0);
  snprintf(current.path, sizeof current.path, "crash-%s", target->name);
  signal(SIGABRT, keep_crash), signal(SIGSEGV, keep_crash), signal(SIGFPE, keep_crash);
  while (target->seed(seed_count, current.data)) seed_count++;
  time_t began = time(NULL);
  for (long long k = 0, left = 0; k < runs; k++, left--) {
    if (left <= 0) {
      current.size = target->seed(random_below(&blind, seed_count), current.data);
      left = 1 + random_below(&blind, 12);
    }
    unsigned choice = (unsigned)random_bits(&blind);
    current.size = target->mutate
                       ? target->mutate(current.data, current.size, FUZZ_MAX_INPUT, choice, change_blindly)
                       : change_blindly(current.data, current.size, FUZZ_MAX_INPUT);
    run_exactly(target, current.data, current.size);
  }
  printf("%s: %lld runs in %lld s\n", target->name, runs, (long long)(time(NULL) - began));
}

static int run_all(void) {
  bool has_all = true;
  for (int t = 0; t < TARGET_COUNT; t++) {
    int seeds = run_seeds(targets[t]), kept = run_kept(targets[t]);
    printf("%s: %d seeds, %d kept\n", targets[t]->name, seeds, kept);
    has_all = has_all && seeds > 0;
  }
  return has_all ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argument_count, char **arguments) {
  int code = EXIT_SUCCESS;
  if (argument_count == 4 && strcmp(arguments[1], "--seeds") == 0)
    write_seeds(find(arguments[2]), arguments[3]);
  else if (argument_count > 3 && strcmp(arguments[1], "--random") == 0)
    run_random(find(arguments[2]), atoll(arguments[3]),
               argument_count > 4 ? strtoull(arguments[4], NULL, 10) : 1);
  else if (argument_count > 2)
    for (int a = 2; a < argument_count; a++) run_file(find(arguments[1]), arguments[a]);
  else
    code = run_all();
  fuzz_target_remove_files();
  return code;
}
