// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // realpath
#endif
#include "net/files/safetensors.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "net/memory.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they lie in memory");

static bool set_entry(NetJson *header, const NetEntry *entry, size_t begin) {
  int64_t shape[2] = {(int64_t)entry->shape[0], (int64_t)entry->shape[1]};
  int64_t offsets[2] = {(int64_t)begin, (int64_t)(begin + net_safetensors_bytes(entry))};
  NetJson *json = net_json_object();
  bool ok = json && net_json_set_text(json, "dtype", entry->number == NET_FLOAT ? "F32" : "F64") &&
            net_json_set_integers(json, "shape", entry->rank, shape) &&
            net_json_set_integers(json, "data_offsets", 2, offsets);
  return net_json_set_object(header, entry->name, json) && ok;
}

// The metadata are printed and read again, for a value belongs to one object.
static bool set_metadata(NetJson *header, const NetJson *metadata) {
  char *text = net_json_print(metadata), error[160];
  NetJson *copy = text ? net_json_parse(text, strlen(text), error) : NULL;
  net_memory_free(text);
  return net_json_set_object(header, "__metadata__", copy);
}

static char *print_header(int count, const NetEntry *entries, const NetJson *metadata) {
  NetJson *header = net_json_object();
  bool ok = header && set_metadata(header, metadata);
  size_t begin = 0;
  for (int k = 0; ok && k < count; k++) {
    ok = set_entry(header, &entries[k], begin);
    begin += net_safetensors_bytes(&entries[k]);
  }
  char *text = ok ? net_json_print(header) : NULL;
  net_json_destroy(header);
  return text;
}

// The header is padded by blanks to eight bytes, so that numbers are aligned.
static bool put(FILE *stream, const char *header, int count, const NetEntry *entries) {
  size_t length = strlen(header);
  uint64_t padded = (length + 7) / 8 * 8;
  bool ok = fwrite(&padded, sizeof padded, 1, stream) == 1 && fwrite(header, 1, length, stream) == length;
  for (size_t k = length; k < padded; k++) ok = ok && fputc(' ', stream) == ' ';
  for (int k = 0; ok && k < count; k++) {
    size_t bytes = net_safetensors_bytes(&entries[k]);
    ok = fwrite(entries[k].data, 1, bytes, stream) == bytes;
  }
  struct stat info;
  bool is_file = fstat(fileno(stream), &info) == 0 && S_ISREG(info.st_mode);
  return ok && fflush(stream) == 0 && (!is_file || fsync(fileno(stream)) == 0);
}

// What is no file, as a pipe or /dev/stdout, is written into; a file is written beside and renamed.
static bool is_replaced(const char *path) {
  struct stat info;
  bool is_descriptor = strncmp(path, "/dev/", 5) == 0 || strncmp(path, "/proc/", 6) == 0;
  return !is_descriptor && (stat(path, &info) != 0 || S_ISREG(info.st_mode));
}

NetStatus net_safetensors_write(const char *path, int count, const NetEntry *entries,
                                const NetJson *metadata) {
  char real[PATH_MAX];
  bool is_through = !is_replaced(path);
  const char *place = !is_through && realpath(path, real) ? real : path; // behind all links
  size_t size = strlen(place) + 32;
  char *beside = net_memory_zeroed(size, 1);
  char *header = beside ? print_header(count, entries, metadata) : NULL;
  NetStatus status = header ? NET_OK : net_status_no_memory("a header of tensors");
  if (status == NET_OK) {
    if (is_through)
      snprintf(beside, size, "%s", place);
    else
      snprintf(beside, size, "%s.partial-%ld", place, (long)getpid());
    errno = 0;
    FILE *stream = fopen(beside, "wb");
    bool ok = stream && put(stream, header, count, entries);
    int error = errno;
    if (stream && fclose(stream) != 0) ok = false, error = errno;
    if (ok && !is_through && rename(beside, place) != 0) ok = false, error = errno;
    if (!ok) {
      if (stream && !is_through) unlink(beside);
      status = net_status_fail(NET_BAD_IO, "%s: cannot be written: %s", path, strerror(error));
    }
  }
  net_memory_free(header);
  net_memory_free(beside);
  return status;
}
