// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_blame.h"

#include <stdio.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/effect/contact/contact.h"

static const char PAIR_FILE[] = "unsound_pair.csv";

Status fem_run_blame_clear(const FemRunState *run) {
  char *path = run->options->directory ? file_join(run->options->directory, PAIR_FILE) : NULL;
  if (run->options->directory && !path) return status_no_memory("a file name");
  if (path) file_remove(path);
  memory_free(path);
  return STATUS_OK;
}

static Status write(const double pair[24], const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  for (int v = 0; v < 24; v++) fprintf(writer.stream, "%.17g%c", pair[v], v < 23 ? ',' : '\n');
  return file_commit(&writer);
}

static const double *find_pair(const FemRunState *run) {
  void *effect = fem_system_effect(&run->system, &fem_effect_contact);
  return effect ? contact_system_blamed(fem_effect_contact_system(effect)) : NULL;
}

Status fem_run_blame_pair(const FemRunState *run, Status status) {
  char message[2048];
  const double *pair = run->options->directory ? find_pair(run) : NULL;
  if (!pair) return status;
  snprintf(message, sizeof message, "%s", status_message());
  char *path = file_join(run->options->directory, PAIR_FILE);
  const Status written = path ? write(pair, path) : status_no_memory("a file name");
  if (written)
    status_fail(status, "%s; its coordinates could not be written: %s", message, status_message());
  else
    status_fail(status, "%s. Its coordinates are in %s, for `tetlap overlap`", message, path);
  memory_free(path);
  return status;
}
