// SPDX-License-Identifier: Apache-2.0
#include "device/backend/cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"

uint64_t device_cache_key(int count, const char *const *texts) {
  uint64_t key = DIGEST_START;
  for (int k = 0; k < count; k++) key = digest_bytes(key, texts[k], strlen(texts[k]) + 1);
  return key;
}

// False: there is no folder, or its path is too long.
static bool find_folder(char *path, size_t size) {
  const char *own = getenv("TETLAP_CACHE"), *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  int length = own && own[0]       ? snprintf(path, size, "%s", own)
               : cache && cache[0] ? snprintf(path, size, "%s/tetlap", cache)
               : home && home[0]   ? snprintf(path, size, "%s/.cache/tetlap", home)
                                   : -1;
  return length > 0 && (size_t)length < size;
}

static bool find_file(uint64_t key, char *path, size_t size) {
  char folder[3000], name[DIGEST_TEXT];
  if (!find_folder(folder, sizeof folder)) return false;
  digest_print(key, name);
  return (size_t)snprintf(path, size, "%s/%s.kernel", folder, name) < size;
}

typedef struct Head {
  uint64_t key, code; // code: its digest
} Head;

bool device_cache_read(uint64_t key, char **code, size_t *size) {
  char path[4096], *content = NULL;
  size_t length = 0;
  Head head;
  if (!find_file(key, path, sizeof path) || !file_exists(path)) return false;
  if (file_read(path, &content, &length) != STATUS_OK) return false;
  bool is_right = length > sizeof head;
  if (is_right) {
    memcpy(&head, content, sizeof head);
    *size = length - sizeof head;
    is_right = head.key == key && head.code == digest_bytes(DIGEST_START, content + sizeof head, *size);
  }
  *code = is_right ? memory_copy(content + sizeof head, *size, 1) : NULL;
  memory_free(content);
  return *code != NULL;
}

void device_cache_write(uint64_t key, const void *code, size_t size) {
  char path[4096], folder[3000];
  FileWriter writer = {0};
  const Head head = {key, digest_bytes(DIGEST_START, code, size)};
  if (!find_folder(folder, sizeof folder) || !find_file(key, path, sizeof path)) return;
  if (file_make_directories(folder) != STATUS_OK || file_begin(&writer, path) != STATUS_OK) return;
  if (fwrite(&head, sizeof head, 1, writer.stream) == 1 && fwrite(code, 1, size, writer.stream) == size)
    (void)file_commit(&writer);
  file_abandon(&writer);
}
