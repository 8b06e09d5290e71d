// SPDX-License-Identifier: GPL-3.0-or-later
#include "target.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"

enum { PATH_SIZE = 256, MAX_FILES = 16 };

// The files of this process, by name.
static struct {
  char folder[PATH_SIZE];
  int count;
  const char *names[MAX_FILES];
  char paths[MAX_FILES][2 * PATH_SIZE];
} files;

void fuzz_target_fail(const char *file, int line, const char *claim, const char *format, ...) {
  va_list args;
  fprintf(stderr, "%s:%d: %s does not hold: ", file, line, claim);
  va_start(args, format);
  vfprintf(stderr, format, args);
  va_end(args);
  fputc('\n', stderr);
  abort();
}

static void make_folder(void) {
  const char *parent = getenv("TMPDIR");
  snprintf(files.folder, sizeof files.folder, "%.200s/tetlap_fuzz_XXXXXX", parent ? parent : "/tmp");
  FUZZ_CLAIM(mkdtemp(files.folder) != NULL, "no folder can be made as %s", files.folder);
}

static char *path_of(const char *name) {
  if (!files.folder[0]) make_folder();
  for (int f = 0; f < files.count; f++)
    if (strcmp(files.names[f], name) == 0) return files.paths[f];
  FUZZ_CLAIM(files.count < MAX_FILES, "too many files with %s", name);
  files.names[files.count] = name;
  size_t used = 0;
  text_append(files.paths[files.count], sizeof *files.paths, &used, "%s/%s", files.folder, name);
  return files.paths[files.count++];
}

const char *fuzz_target_file(const char *name, const void *bytes, size_t size) {
  const char *path = path_of(name);
  FILE *stream = fopen(path, "wb");
  FUZZ_CLAIM(stream, "%s cannot be written", path);
  bool works = fwrite(bytes, 1, size, stream) == size;
  FUZZ_CLAIM(fclose(stream) == 0 && works, "%s cannot be written", path);
  return path;
}

void fuzz_target_remove_files(void) {
  for (int f = 0; f < files.count; f++) unlink(files.paths[f]);
  if (files.folder[0]) rmdir(files.folder);
  files.count = 0, files.folder[0] = 0;
}

size_t fuzz_target_read(const char *path, uint8_t *data, size_t room) {
  FILE *stream = fopen(path, "rb");
  FUZZ_CLAIM(stream, "%s is not there", path);
  size_t size = fread(data, 1, room, stream);
  bool is_whole = fgetc(stream) == EOF;
  fclose(stream);
  return is_whole ? size : 0;
}

size_t fuzz_target_source(const char *name, uint8_t *data, size_t room) {
  char path[PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", TETLAP_SOURCE_DIR, name);
  return fuzz_target_read(path, data, room);
}
