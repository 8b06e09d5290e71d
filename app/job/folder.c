// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/folder.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"

// Cuts the last part of a path off. False: there is none.
static bool cut(char *path) {
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/') path[--length] = 0;
  char *slash = strrchr(path, '/');
  if (!slash || slash == path) return false;
  *slash = 0;
  return true;
}

int app_job_folder_missing(const char *directory) {
  char path[PATH_MAX];
  int missing = 0;
  snprintf(path, sizeof path, "%s", directory);
  do {
    if (file_exists(path)) return missing;
    missing++;
  } while (cut(path));
  return missing;
}

bool app_job_folder_is_refused(Status status, const FemRunResult *result) {
  return (status == STATUS_INPUT || status == STATUS_USAGE) && result->integrator.steps == 0;
}

static void remove_files(const char *directory) {
  DIR *folder = opendir(directory);
  for (struct dirent *entry = folder ? readdir(folder) : NULL; entry; entry = readdir(folder)) {
    char *path = file_join(directory, entry->d_name);
    if (path && entry->d_name[0] != '.') unlink(path); // of folders it fails
    memory_free(path);
  }
  if (folder) closedir(folder);
}

void app_job_folder_remove(const char *directory, int missing) {
  char path[PATH_MAX];
  if (missing == 0 || ranks()->number != 0) return;
  snprintf(path, sizeof path, "%s", directory);
  remove_files(path);
  for (int k = 0; k < missing && rmdir(path) == 0 && cut(path); k++) {
  }
}
