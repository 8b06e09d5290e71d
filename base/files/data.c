// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // dladdr1
#endif
#include "base/files/data.h"

#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"

// The file that this function is in: the program, or a shared library.
static bool find_own_file(char path[PATH_MAX]) {
  Dl_info info;
  struct link_map *map = NULL;
  void *here = (void *)(size_t)&find_own_file;
  if (!dladdr1(here, &info, (void **)&map, RTLD_DL_LINKMAP) || !map) return false;
  // the program itself has no name there, and argv[0] may be anything
  return realpath(map->l_name[0] ? map->l_name : "/proc/self/exe", path) != NULL;
}

// Cuts a path to the folder that it is in; false: it is in none.
static bool cut_to_folder(char *path) {
  char *end = strrchr(path, '/');
  if (end) *end = '\0';
  return end != NULL;
}

static Status join(const char *folder, const char *between, const char *name, char *path, size_t size) {
  int length = snprintf(path, size, "%s%s/%s", folder, between, name);
  return length >= 0 && (size_t)length < size
             ? STATUS_OK
             : status_fail(STATUS_INPUT, "%s%s: the path is too long", folder, between);
}

static const char REMEDY[] =
    "set TETLAP_DATA to the folder that holds it: share/tetlap of an installation, or a "
    "checkout";

static Status find_in(const char *folder, const char *name, char *path, size_t size) {
  TRY(join(folder, "", name, path, size));
  if (file_exists(path)) return STATUS_OK;
  return status_fail(STATUS_IO, "%s is not in %s, which TETLAP_DATA names; %s", name, folder, REMEDY);
}

Status data_find(const char *name, char *path, size_t size) {
  const char *named = getenv("TETLAP_DATA");
  if (named && named[0]) return find_in(named, name, path, size);
  char own[PATH_MAX], folder[PATH_MAX];
  if (!find_own_file(own))
    return status_fail(STATUS_IO, "%s: the place of this program could not be found; %s", name, REMEDY);
  memcpy(folder, own, sizeof folder);
  for (int above = 0; above < 3 && cut_to_folder(folder); above++) {
    TRY(join(folder, "/share/tetlap", name, path, size));
    if (file_exists(path)) return STATUS_OK;
  }
  return status_fail(STATUS_IO, "%s is in no share/tetlap beside or above %s; %s", name, own, REMEDY);
}
