// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/medit.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/files/temporary.h"
#include "base/memory.h"

// The end of the word that this line begins with and whose count follows on it; NULL: there is none. Version
// and dimension are looked for on the line of their word.
static const char *end_of_word(const char *line) {
  const char *word = line + strspn(line, " \t");
  const char *end = word;
  while (isalnum((unsigned char)*end)) end++;
  if (!isalpha((unsigned char)*word) || end == word) return NULL;
  size_t length = (size_t)(end - word);
  if (length == strlen("Dimension") && strncmp(word, "Dimension", length) == 0) return NULL;
  if (length == strlen("MeshVersionFormatted") && strncmp(word, "MeshVersionFormatted", length) == 0)
    return NULL;
  const char *count = end + strspn(end, " \t");
  return count > end && isdigit((unsigned char)*count) ? end : NULL;
}

static const char *next_line(const char *line) {
  const char *end = strchr(line, '\n');
  return end ? end + 1 : line + strlen(line);
}

static void write_split(FILE *stream, const char *text) {
  for (const char *line = text; *line; line = next_line(line)) {
    const char *cut = end_of_word(line), *end = next_line(line);
    if (cut) {
      fwrite(line, 1, (size_t)(cut - line), stream);
      fputc('\n', stream);
    }
    const char *rest = cut ? cut : line;
    fwrite(rest, 1, (size_t)(end - rest), stream);
  }
}

static bool needs_split(const char *text) {
  for (const char *line = text; *line; line = next_line(line))
    if (end_of_word(line)) return true;
  return false;
}

static Status write_copy(const char *text, char **copy) {
  TRY(temporary_file("mesh", ".mesh", copy));
  FILE *stream = fopen(*copy, "w");
  if (stream) write_split(stream, text);
  bool is_written = stream && !ferror(stream);
  if (stream && fclose(stream) != 0) is_written = false;
  if (is_written) return STATUS_OK;
  Status status =
      status_fail(STATUS_IO, "%s: a copy, with each count on a line of its own, cannot be written", *copy);
  temporary_remove(*copy);
  *copy = NULL;
  return status;
}

Status fem_mesh_medit_split(const char *path, char **copy) {
  char *text;
  size_t size;
  *copy = NULL;
  TRY(file_read(path, &text, &size));
  Status status = needs_split(text) ? write_copy(text, copy) : STATUS_OK;
  memory_free(text);
  return status == STATUS_OK ? STATUS_OK : status_prefix(status, "%s", path);
}
