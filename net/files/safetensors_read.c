// SPDX-License-Identifier: Apache-2.0
#include "net/files/safetensors.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "net/memory.h"

enum { MAX_HEADER = 100 << 20 }; // [bytes], the format's own limit

size_t net_safetensors_size(const NetEntry *entry) {
  size_t size = 1;
  for (int k = 0; k < entry->rank; k++) size *= entry->shape[k];
  return size;
}

size_t net_safetensors_bytes(const NetEntry *entry) {
  return net_safetensors_size(entry) * (entry->number == NET_FLOAT ? sizeof(float) : sizeof(double));
}

static NetStatus read_bytes(const char *path, char **bytes, size_t *size) {
  errno = 0;
  FILE *stream = fopen(path, "rb");
  if (!stream) return net_status_fail(NET_BAD_IO, "%s: cannot be opened: %s", path, strerror(errno));
  struct stat about;
  NetStatus status = NET_OK;
  if (fstat(fileno(stream), &about) != 0 || !S_ISREG(about.st_mode))
    status = net_status_fail(NET_BAD_IO, "%s: cannot be read: no plain file", path);
  *size = status == NET_OK ? (size_t)about.st_size : 0;
  *bytes = status == NET_OK ? net_memory_zeroed(*size, 1) : NULL;
  if (status == NET_OK && !*bytes) status = net_status_no_memory(path);
  if (status == NET_OK && fread(*bytes, 1, *size, stream) != *size)
    status = net_status_fail(NET_BAD_IO, "%s: cannot be read: %s", path, strerror(errno));
  fclose(stream);
  return status;
}

// What is being read, for messages.
typedef struct Source {
  const char *path;
  const char *data; // behind the header
  size_t data_size;
} Source;

// A file of torch.save: a zip archive, or before PyTorch 1.6 a pickle of protocol 2 and later.
static bool is_pytorch(const char *bytes, size_t size) {
  bool is_zip = size >= 4 && memcmp(bytes, "PK\3\4", 4) == 0;
  return is_zip || (size >= 2 && (unsigned char)bytes[0] == 0x80 && bytes[1] >= 2 && bytes[1] <= 5);
}

static NetStatus fail_foreign(const char *path, const char *bytes, size_t size) {
  if (is_pytorch(bytes, size))
    return net_status_fail(
        NET_BAD_FILE,
        "%s: is a file of PyTorch; load it in the module of a Python file, and name that, as in "
        "mine.py:Net, or write the weights of a network of tetlap's layers as a "
        "safetensors file by tetlap.write_weights",
        path);
  return net_status_fail(
      NET_BAD_FILE,
      "%s: is not a safetensors file: that begins with eight bytes that say how long its header "
      "is; give the NAME.safetensors that `tetlap train` wrote",
      path);
}

static NetStatus read_header(const char *path, NetTensorFile *file, size_t size, Source *source) {
  uint64_t length;
  if (size < sizeof length)
    return net_status_fail(NET_BAD_FILE, "%s: %zu bytes are no safetensors file", path, size);
  memcpy(&length, file->bytes, sizeof length);
  if (length > MAX_HEADER || length < 2) return fail_foreign(path, file->bytes, size);
  if (length > size - sizeof length)
    return net_status_fail(NET_BAD_FILE, "%s: truncated: the header should have %llu bytes, the file has %zu",
                           path, (unsigned long long)length, size);
  char error[160];
  file->header = net_json_parse(file->bytes + sizeof length, (size_t)length, error);
  if (!file->header) return net_status_fail(NET_BAD_FILE, "%s: header: %s", path, error);
  *source = (Source){path, file->bytes + sizeof length + length, size - sizeof length - (size_t)length};
  return NET_OK;
}

static NetStatus read_shape(const Source *source, const NetJson *json, NetEntry *entry) {
  const NetJson *shape = net_json_member(json, "shape");
  int rank = shape && net_json_is_array(shape) ? net_json_count(shape) : -1;
  if (rank < 0 || rank > 2)
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s: \"shape\" must be a list of at most two sizes",
                           source->path, entry->name);
  entry->rank = rank;
  for (int k = 0; k < rank; k++) {
    int64_t extent;
    if (!net_json_integer(net_json_element(shape, k), &extent) || extent < 0 || extent > INT32_MAX)
      return net_status_fail(NET_BAD_FILE, "%s: tensor %s: a size in \"shape\" is no integer from 0 to %d",
                             source->path, entry->name, INT32_MAX);
    entry->shape[k] = (size_t)extent;
  }
  if (rank == 2 && entry->shape[0] > source->data_size / (entry->shape[1] ? entry->shape[1] : 1))
    return net_status_fail(NET_BAD_FILE,
                           "%s: truncated: tensor %s of %zu × %zu numbers, but %zu bytes of them",
                           source->path, entry->name, entry->shape[0], entry->shape[1], source->data_size);
  return NET_OK;
}

static NetStatus read_offsets(const Source *source, const NetJson *json, NetEntry *entry) {
  const NetJson *offsets = net_json_member(json, "data_offsets");
  int64_t begin, end;
  if (!offsets || net_json_count(offsets) != 2 || !net_json_integer(net_json_element(offsets, 0), &begin) ||
      !net_json_integer(net_json_element(offsets, 1), &end) || begin < 0 || end < begin)
    return net_status_fail(NET_BAD_FILE,
                           "%s: tensor %s: \"data_offsets\" must be [begin, end], 0 ≤ begin ≤ end",
                           source->path, entry->name);
  if ((uint64_t)end > source->data_size)
    return net_status_fail(NET_BAD_FILE, "%s: truncated: tensor %s ends at byte %lld of %zu", source->path,
                           entry->name, (long long)end, source->data_size);
  if ((size_t)(end - begin) != net_safetensors_bytes(entry))
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s: %lld bytes where its shape and dtype need %zu",
                           source->path, entry->name, (long long)(end - begin), net_safetensors_bytes(entry));
  entry->data = source->data + begin;
  return NET_OK;
}

static NetStatus read_entry(const Source *source, const char *name, const NetJson *json, NetEntry *entry) {
  if (strlen(name) >= sizeof entry->name)
    return net_status_fail(NET_BAD_FILE, "%s: tensor name %.40s… is longer than %d", source->path, name,
                           NET_ENTRY_NAME - 1);
  strcpy(entry->name, name);
  if (!net_json_is_object(json))
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s is no object in the header", source->path, name);
  const char *dtype = net_json_text(net_json_member(json, "dtype"));
  if (!dtype || (strcmp(dtype, "F32") != 0 && strcmp(dtype, "F64") != 0))
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s has dtype %.20s; expected F32 or F64", source->path,
                           name, dtype ? dtype : "(none)");
  entry->number = dtype[1] == '3' ? NET_FLOAT : NET_DOUBLE;
  NET_TRY(read_shape(source, json, entry));
  return read_offsets(source, json, entry);
}

static int compare_entries(const void *a, const void *b) {
  const NetEntry *left = a, *right = b;
  const char *p = left->data, *q = right->data;
  if (p != q) return p < q ? -1 : 1;
  size_t m = net_safetensors_bytes(left), n = net_safetensors_bytes(right);
  return m < n ? -1 : m > n;
}

// Tensors follow each other without gap or overlap, from the first byte to the last.
static NetStatus check_tiling(const Source *source, const NetTensorFile *file) {
  const char *reached = source->data;
  const char *before = "the header";
  for (int k = 0; k < file->count; k++) {
    const NetEntry *entry = &file->entries[k];
    const char *begin = entry->data;
    if (begin < reached)
      return net_status_fail(NET_BAD_FILE, "%s: tensors %s and %s overlap", source->path, before,
                             entry->name);
    if (begin > reached)
      return net_status_fail(NET_BAD_FILE, "%s: %td bytes between %s and tensor %s belong to nothing",
                             source->path, begin - reached, before, entry->name);
    reached = begin + net_safetensors_bytes(entry);
    before = entry->name;
  }
  ptrdiff_t left = source->data + source->data_size - reached;
  if (left)
    return net_status_fail(NET_BAD_FILE, "%s: %td bytes behind %s belong to no tensor", source->path, left,
                           before);
  return NET_OK;
}

static NetStatus read_entries(const Source *source, NetTensorFile *file) {
  file->entries = net_memory_zeroed((size_t)net_json_count(file->header), sizeof *file->entries);
  if (!file->entries) return net_status_no_memory("a list of tensors");
  void *cursor = NULL;
  const char *name;
  const NetJson *value;
  while (net_json_next(file->header, &cursor, &name, &value)) {
    if (strcmp(name, "__metadata__") == 0)
      file->metadata = value;
    else
      NET_TRY(read_entry(source, name, value, &file->entries[file->count++]));
  }
  if (!file->metadata || !net_json_is_object(file->metadata))
    return net_status_fail(NET_BAD_FILE, "%s: no __metadata__ in the header: not a file of this program",
                           source->path);
  qsort(file->entries, (size_t)file->count, sizeof *file->entries, compare_entries);
  return check_tiling(source, file);
}

NetStatus net_safetensors_read(const char *path, NetTensorFile *file) {
  *file = (NetTensorFile){0};
  size_t size = 0;
  Source source = {0};
  NetStatus status = read_bytes(path, &file->bytes, &size);
  if (status == NET_OK) status = read_header(path, file, size, &source);
  if (status == NET_OK) status = read_entries(&source, file);
  if (status != NET_OK) net_safetensors_destroy(file);
  return status;
}

void net_safetensors_destroy(NetTensorFile *file) {
  net_memory_free(file->entries);
  net_memory_free(file->bytes);
  net_json_destroy(file->header);
  *file = (NetTensorFile){0};
}

const NetEntry *net_safetensors_find(const NetTensorFile *file, const char *name) {
  for (int k = 0; k < file->count; k++)
    if (strcmp(file->entries[k].name, name) == 0) return &file->entries[k];
  return NULL;
}

NetStatus net_safetensors_text(const NetTensorFile *file, const char *path, const char *key,
                               const char **text) {
  *text = net_json_text(net_json_member(file->metadata, key));
  if (*text) return NET_OK;
  return net_status_fail(NET_BAD_FILE, "%s: metadata \"%s\" is missing: not a file of this program", path,
                         key);
}
