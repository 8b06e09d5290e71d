// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/ranks.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/data.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"

// Set for the ranks that this program starts itself.
static const char STARTED[] = "TETLAP_RANKS";

// What this program was started with, words ended by 0.
static char *line;
static size_t line_size;

void app_ranks_keep_line(void) {
  memory_free(line);
  line = NULL;
  if (file_read("/proc/self/cmdline", &line, &line_size)) line = NULL;
}

// The first of these variables that is set, which Open MPI, others and Slurm set; −1: none is.
static int find_number(const char *const names[3]) {
  for (int i = 0; i < 3; i++) {
    const char *text = getenv(names[i]);
    if (text) return atoi(text);
  }
  return -1;
}

int app_ranks_started(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"};
  int count = find_number(names);
  return count > 1 ? count : 1;
}

bool app_ranks_is_heard(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"};
  return app_ranks_started() == 1 || find_number(names) <= 0;
}

Status app_ranks_check(const AppCommand *command) {
  int count = ranks()->count;
  if (count > 1 && !command->has_ranks)
    return status_fail(
        STATUS_USAGE,
        "'%s' runs in one process, and there are %d: call it by itself; over ranks run 'run', 'resume' "
        "and 'compare'",
        command->name, count);
  if (count > 1 || app_ranks_started() == 1 || !command->has_threads) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "mpiexec has started this program %d times, and each would do the same: use tetlap-mpi, "
                     "as in mpiexec -n %d tetlap-mpi run SCENE, or tetlap run --ranks %d SCENE",
                     app_ranks_started(), app_ranks_started(), app_ranks_started());
}

// The program for ranks, beside this one.
static Status find_program(char path[PATH_MAX]) {
  ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 16);
  if (length < 0) return status_fail(STATUS_IO, "/proc/self/exe: cannot be read: %s", strerror(errno));
  path[length] = 0;
  char *slash = strrchr(path, '/');
  snprintf(slash ? slash + 1 : path, 16, "tetlap-mpi");
  if (file_exists(path)) return STATUS_OK;
  return status_fail(
      STATUS_USAGE,
      "--ranks needs the program tetlap-mpi, and %s is not there: `cmake --build "
      "build/release` makes it from source where MPI, PETSc and METIS (libmetis-dev) are found",
      path);
}

// Replaces this process by `first` (count), ended by the arguments that it was started with itself.
static Status replace(int count, char *const *first) {
  size_t word_count = 0;
  if (!line) return status_fail(STATUS_IO, "/proc/self/cmdline: could not be read");
  for (size_t i = 0; i < line_size; i++) word_count += line[i] == 0;
  char **words = memory_zeroed(word_count + (size_t)count, sizeof *words);
  if (!words) return status_no_memory("the command line");
  for (int i = 0; i < count; i++) words[i] = first[i];
  char *word = line + strlen(line) + 1; // behind this program's own name
  for (size_t i = 1; i < word_count; i++, word += strlen(word) + 1) words[(size_t)count + i - 1] = word;
  execv(words[0], words);
  memory_free(words);
  return status_fail(STATUS_IO, "%s: cannot be started: %s", first[0], strerror(errno));
}

Status app_ranks_become(void) {
  char program[PATH_MAX];
  if (ranks()->divides) return STATUS_OK;
  TRY(find_program(program));
  return replace(1, (char *[]){program});
}

Status app_ranks_start(int count) {
  char program[PATH_MAX], script[PATH_MAX];
  if (count <= 1 || ranks()->count == count) return STATUS_OK;
  if (ranks()->count > 1)
    return status_fail(STATUS_USAGE, "--ranks %d, but mpiexec has started %d", count, ranks()->count);
  if (getenv(STARTED))
    return status_fail(STATUS_USAGE,
                       "mpiexec has started %d processes that do not find each other: do tetlap-mpi and "
                       "mpiexec belong to the same MPI?",
                       count);
  TRY(find_program(program));
  TRY(data_find("tools/ranks", script, sizeof script));
  char number[16];
  snprintf(number, sizeof number, "%d", count);
  setenv(STARTED, number, 1);
  return replace(3, (char *[]){script, number, program});
}
