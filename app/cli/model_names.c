// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/model_names.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/text.h"
#include "overlap/models.h"
#include "overlap/source.h"

// The length of what stands before the file or name, as in `hybrid=`.
static size_t prefix_of(const char *source) {
  return (size_t)(overlap_source_model(source) - source);
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

// The absolute path of the source's file alone. False: it names no file.
static bool find_path(const char *source, char path[PATH_MAX]) {
  const char *file;
  char here[PATH_MAX] = "";
  size_t length = overlap_source_path(source, &file);
  if (length == 0) return false;
  if (file[0] != '/' && !getcwd(here, sizeof here)) here[0] = 0;
  if (snprintf(path, PATH_MAX, "%s/%.*s", here, (int)length, file) >= PATH_MAX) return false;
  fold(path);
  return true;
}

bool app_model_names_settle(const char *source, char word[PATH_MAX]) {
  char path[PATH_MAX];
  return find_path(source, path) && overlap_source_with_path(source, path, word, PATH_MAX);
}

bool app_model_names_locate(const char *source, char path[PATH_MAX]) {
  return app_model_names_settle(source + prefix_of(source), path);
}

// A source, and how much of its path is in its name.
typedef struct Entry {
  const char *source;
  char path[PATH_MAX];  // without its ending; "": it is no file
  const char *function; // what follows the path: ":name", or ""
  int parts, most;      // names of the path that are taken, that there are
  AppModelName name;
} Entry;

static bool is_known(const char *name) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++)
    if (strcmp(models[m]->name, name) == 0) return true;
  return false;
}

// The program that a command begins with, without its folder.
static int program_of(const char *command, const char **name) {
  size_t length = strcspn(command, " ");
  *name = command;
  for (size_t c = 0; c < length; c++)
    if (command[c] == '/') *name = command + c + 1;
  return (int)(command + length - *name);
}

// What a word is called that names no file of ours: the program that a command begins with, without its
// folder; what a channel says last.
static int call_source(const char *source, const char **name) {
  if (overlap_source_of(source) == OVERLAP_SOURCE_CHANNEL) {
    *name = strrchr(source, ':') + 1;
    return (int)strlen(*name);
  }
  return program_of(strchr(source, ':') + 1, name);
}

// False: the name is too long, and cut.
static bool write_name(Entry *entry) {
  const char *from = entry->source;
  int prefix = (int)prefix_of(from), length = INT_MAX;
  if (entry->path[0]) {
    from = entry->path + strlen(entry->path);
    for (int parts = 0; parts < entry->parts && from > entry->path; parts += *from == '/') from--;
    from += *from == '/';
  } else if (overlap_source_is_foreign(from)) {
    length = call_source(from + prefix, &from);
  } else {
    from += prefix;
  }
  return snprintf(entry->name, APP_MODEL_NAME, "%.*s%.*s%s", prefix, entry->source, length, from,
                  entry->function) < APP_MODEL_NAME;
}

// Takes the ending off the path, which says no more than what the file is.
static void cut_ending(char *path) {
  static const char *const endings[] = {".safetensors", ".so", ".py", ".onnx"};
  for (size_t e = 0; e < sizeof endings / sizeof *endings; e++) {
    if (!text_ends_in(path, endings[e])) continue;
    path[strlen(path) - strlen(endings[e])] = 0;
    return;
  }
}

static void begin(Entry *entry, const char *source) {
  const char *path;
  *entry = (Entry){.source = source, .parts = 1, .function = ""};
  if (!find_path(source, entry->path)) entry->path[0] = 0;
  if (entry->path[0]) {
    size_t length = overlap_source_path(source, &path);
    entry->function = path + length;
  }
  cut_ending(entry->path);
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
