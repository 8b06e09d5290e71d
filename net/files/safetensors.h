// SPDX-License-Identifier: Apache-2.0
// Files of named tensors in the safetensors format (huggingface/safetensors): eight bytes that say how long
// the header is, a JSON header {"__metadata__": {text: text}, NAME: {"dtype", "shape", "data_offsets"}}, then
// the numbers, little-endian, without gaps. Only F32 and F64 of at most two dimensions. A file is written
// beside its place and renamed, so a reader finds the old one or the new one, whole.
#ifndef NET_SAFETENSORS_H
#define NET_SAFETENSORS_H

#include <stddef.h>

#include "net/json.h"
#include "net/status.h"

enum { NET_ENTRY_NAME = 64 };

typedef enum NetNumber { NET_FLOAT, NET_DOUBLE } NetNumber;

typedef struct NetEntry {
  char name[NET_ENTRY_NAME];
  NetNumber number;
  int rank;         // 0 … 2
  size_t shape[2];  // the first `rank`
  const void *data; // borrowed; when read it may lie on any byte
} NetEntry;

typedef struct NetTensorFile {
  int count;
  NetEntry *entries;       // (count), in the order of their numbers; owned
  const NetJson *metadata; // texts by name; borrowed from the header
  NetJson *header;         // owned
  char *bytes;             // the whole file; owned
} NetTensorFile;

size_t net_safetensors_size(const NetEntry *entry);  // elements
size_t net_safetensors_bytes(const NetEntry *entry); // bytes

// Metadata is an object of texts, borrowed. Failures name the path.
NetStatus net_safetensors_write(const char *path, int count, const NetEntry *entries,
                                const NetJson *metadata);

// NET_BAD_IO where there is no such file, NET_BAD_FILE with the name of what is wrong. Destroy it; a zeroed
// one can be.
NetStatus net_safetensors_read(const char *path, NetTensorFile *file);
void net_safetensors_destroy(NetTensorFile *file);

// NULL: no tensor of that name.
const NetEntry *net_safetensors_find(const NetTensorFile *file, const char *name);

// The metadata's text, or NET_BAD_FILE with the path and the missing name.
NetStatus net_safetensors_text(const NetTensorFile *file, const char *path, const char *key,
                               const char **text);

#endif
