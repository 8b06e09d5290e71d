// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/model_names.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "overlap/model.h"
#include "overlap/weights.h"

static const char HYBRID[] = "hybrid=", ENDING[] = ".safetensors";

// The length of the prefix `hybrid=`; 0: the source has none.
static size_t prefix_of(const char *source) {
  return strncmp(source, HYBRID, sizeof HYBRID - 1) == 0 ? sizeof HYBRID - 1 : 0;
}

// Takes "." and "..", and what they undo, out of an absolute path.
static void fold(char *path) {
  char *end = path; // of what is kept
  for (char *part = path; *part;) {
    while (*part == '/') part++;
    size_t length = strcspn(part, "/");
    if (length == 2 && memcmp(part, "..", 2) == 0) {
      while (end > path && *--end != '/') {
      }
    } else if (length > 0 && !(length == 1 && *part == '.')) {
      *end++ = '/';
      memmove(end, part, length);
      end += length;
    }
    part += length;
  }
  *end = 0;
}

bool app_model_names_locate(const char *source, char path[PATH_MAX]) {
  const char *file = source + prefix_of(source);
  if (!overlap_weights_is_path(file)) return false;
  char here[PATH_MAX] = "";
  if (file[0] != '/' && !getcwd(here, sizeof here)) here[0] = 0;
  if (snprintf(path, PATH_MAX, "%s/%s", here, file) >= PATH_MAX) return false;
  fold(path);
  return true;
}

// A source, and how much of its path is in its name.
typedef struct Entry {
  const char *source;
  char path[PATH_MAX]; // without its ending; "": it is no file
  int parts, most;     // names of the path that are taken, that there are
  AppModelName name;
} Entry;

static bool is_known(const char *name) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  for (int m = 0; m < count; m++)
    if (strcmp(models[m]->name, name) == 0) return true;
  return false;
}

// False: the name is too long, and cut.
static bool write_name(Entry *entry) {
  const char *from = entry->source;
  int prefix = (int)prefix_of(from);
  if (entry->path[0]) {
    from = entry->path + strlen(entry->path);
    for (int parts = 0; parts < entry->parts && from > entry->path; parts += *from == '/') from--;
    from += *from == '/';
  } else {
    from += prefix;
  }
  return snprintf(entry->name, APP_MODEL_NAME, "%.*s%s", prefix, entry->source, from) < APP_MODEL_NAME;
}

static void begin(Entry *entry, const char *source) {
  *entry = (Entry){.source = source, .parts = 1};
  if (!app_model_names_locate(source, entry->path)) entry->path[0] = 0;
  size_t length = strlen(entry->path), ending = sizeof ENDING - 1;
  if (length > ending && strcmp(entry->path + length - ending, ENDING) == 0) entry->path[length - ending] = 0;
  for (const char *c = entry->path; *c; c++) entry->most += *c == '/';
}

// The number of another source of the same name, −1: none, −2: the program's own model has it.
static int find_rival(const Entry *entries, int count, int i) {
  if (entries[i].path[0] && is_known(entries[i].name + prefix_of(entries[i].source))) return -2;
  for (int j = 0; j < count; j++)
    if (j != i && strcmp(entries[i].name, entries[j].name) == 0) return j;
  return -1;
}

// Takes one name more of each path whose name is not its own. False: there is none, or none is left.
static bool lengthen(Entry *entries, int count) {
  bool is_longer = false;
  for (int i = 0; i < count; i++) {
    Entry *entry = &entries[i];
    if (entry->parts >= entry->most || find_rival(entries, count, i) == -1) continue;
    entry->parts = -(entry->parts + 1); // written below, so that all are judged by the same names
    is_longer = true;
  }
  for (int i = 0; i < count; i++)
    if (entries[i].parts < 0) entries[i].parts = -entries[i].parts;
  return is_longer;
}

static Status find(Entry *entries, int count) {
  bool fits = true;
  do {
    for (int i = 0; i < count; i++) fits = write_name(&entries[i]) && fits;
  } while (lengthen(entries, count));
  for (int i = 0; i < count; i++) {
    int rival = find_rival(entries, count, i);
    if (rival < 0) continue;
    if (strcmp(entries[i].source, entries[rival].source) == 0)
      return status_fail(STATUS_USAGE, "the model '%s' is named twice; name it once", entries[i].source);
    return status_fail(STATUS_USAGE,
                       "the models '%s' and '%s' cannot be told apart by name; name one of them",
                       entries[i].source, entries[rival].source);
  }
  return fits ? STATUS_OK
              : status_fail(STATUS_USAGE, "the names of the models' files have more than %d characters",
                            APP_MODEL_NAME - 1);
}

Status app_model_names_find(int count, const char *const *sources, AppModelName *names) {
  Entry *entries = memory_zeroed((size_t)count + 1, sizeof *entries);
  if (!entries) return status_no_memory("the models' names");
  for (int i = 0; i < count; i++) begin(&entries[i], sources[i]);
  Status status = find(entries, count);
  for (int i = 0; i < count; i++) memcpy(names[i], entries[i].name, sizeof *names);
  memory_free(entries);
  return status;
}

void app_model_names_find_one(const char *source, AppModelName name) {
  Entry entry;
  begin(&entry, source);
  do write_name(&entry);
  while (lengthen(&entry, 1));
  memcpy(name, entry.name, sizeof entry.name);
}
