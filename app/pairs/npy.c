// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pairs/npy.h"

#include <endian.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/pairs/columns.h"

enum { MOST_HEAD = 65535, PREFIX = 10, ALIGNMENT = 64, COUNT_DIGITS = 20, VERSION_2_PREFIX = 12 };

const char app_pairs_npy_magic[APP_PAIRS_NPY_MAGIC] = {'\x93', 'N', 'U', 'M', 'P', 'Y'};

char app_pairs_npy_order(void) {
  return __BYTE_ORDER == __LITTLE_ENDIAN ? '<' : '>';
}

static Status fail_short(const char *name) {
  return status_fail(STATUS_INPUT, "%s: ends within the head of a .npy file; is it complete?", name);
}

// The dictionary behind the magic, as a text of the caller's (MOST_HEAD + 1).
static Status read_head(AppPairsNpy *npy, char *head) {
  unsigned char prefix[VERSION_2_PREFIX];
  if (fread(prefix, 1, PREFIX, npy->stream) != PREFIX) return fail_short(npy->name);
  if (memcmp(prefix, app_pairs_npy_magic, APP_PAIRS_NPY_MAGIC) != 0)
    return status_fail(STATUS_INPUT, "%s: is no .npy file", npy->name);
  int version = prefix[APP_PAIRS_NPY_MAGIC];
  if (version < 1 || version > 3)
    return status_fail(STATUS_INPUT, "%s: has version %d of the .npy format; 1 to 3 are known", npy->name,
                       version);
  size_t length = prefix[8] | (size_t)prefix[9] << 8;
  if (version > 1) {
    if (fread(prefix + PREFIX, 1, 2, npy->stream) != 2) return fail_short(npy->name);
    length |= (size_t)prefix[10] << 16 | (size_t)prefix[11] << 24;
  }
  if (length > MOST_HEAD)
    return status_fail(STATUS_INPUT, "%s: its head has %zu bytes; at most %d are read", npy->name, length,
                       MOST_HEAD);
  if (fread(head, 1, length, npy->stream) != length) return fail_short(npy->name);
  head[length] = 0;
  return STATUS_OK;
}

// What stands behind 'key': in the dictionary; NULL: there is no such key.
static const char *find_value(const char *head, const char *key) {
  const char *at = strstr(head, key);
  if (!at) return NULL;
  at += strlen(key);
  at += strspn(at, " ");
  if (*at != ':') return NULL;
  return at + 1 + strspn(at + 1, " ");
}

static Status read_type(AppPairsNpy *npy, const char *head) {
  const char *value = find_value(head, "'descr'");
  char order, kind;
  int size, used = 0;
  if (!value || sscanf(value, "'%c%c%d'%n", &order, &kind, &size, &used) != 3 || used == 0 || kind != 'f' ||
      (size != 4 && size != 8) || !strchr("<>=", order))
    return status_fail(
        STATUS_INPUT,
        "%s: its type is %.*s; float64 or float32 is expected: save x.astype(float), of one array", npy->name,
        value ? (int)strcspn(value, ",}") : 7, value ? value : "unknown");
  npy->number_size = size;
  npy->is_swapped = order != '=' && order != app_pairs_npy_order();
  return STATUS_OK;
}

// The lengths, as in "(1000, 2, 4, 3)"; one alone is a single row.
static Status read_shape(AppPairsNpy *npy, const char *head) {
  const char *value = find_value(head, "'shape'");
  long long lengths[8];
  int rank = 0;
  if (!value || *value != '(') return status_fail(STATUS_INPUT, "%s: its head has no shape", npy->name);
  for (char *at = (char *)value + 1; *at && *at != ')'; at += strspn(at, ", ")) {
    char *end;
    if (rank == 8 || !(*at >= '0' && *at <= '9'))
      return status_fail(STATUS_INPUT, "%s: its shape %.40s cannot be read", npy->name, value);
    lengths[rank++] = strtoll(at, &end, 10);
    at = end;
  }
  if (rank == 1) lengths[1] = lengths[0], lengths[0] = 1, rank = 2;
  npy->row_count = rank > 0 ? lengths[0] : 0;
  npy->row_size = rank > 0;
  for (int r = 1; r < rank; r++) {
    if (lengths[r] < 1 || lengths[r] > APP_PAIRS_MAX_COLUMNS / npy->row_size) npy->row_size = 0;
    if (npy->row_size == 0) break;
    npy->row_size *= (int)lengths[r];
  }
  if (npy->row_size == 0)
    return status_fail(STATUS_INPUT, "%s: its shape is %.*s); (n, 24) or (n, 2, 4, 3) is expected", npy->name,
                       (int)strcspn(value, ")"), value);
  return STATUS_OK;
}

Status app_pairs_npy_open(AppPairsNpy *npy, FILE *stream, const char *name) {
  char head[MOST_HEAD + 1];
  *npy = (AppPairsNpy){.stream = stream, .name = name};
  TRY(read_head(npy, head));
  TRY(read_type(npy, head));
  const char *order = find_value(head, "'fortran_order'");
  if (!order || strncmp(order, "False", 5) != 0)
    return status_fail(STATUS_INPUT, "%s: is stored column by column; save numpy.ascontiguousarray(x)", name);
  return read_shape(npy, head);
}

static double number_at(const AppPairsNpy *npy, const unsigned char *bytes) {
  if (npy->number_size == 4) {
    uint32_t bits;
    float value;
    memcpy(&bits, bytes, sizeof bits);
    if (npy->is_swapped) bits = __builtin_bswap32(bits);
    memcpy(&value, &bits, sizeof value);
    return value;
  }
  uint64_t bits;
  double value;
  memcpy(&bits, bytes, sizeof bits);
  if (npy->is_swapped) bits = __builtin_bswap64(bits);
  memcpy(&value, &bits, sizeof value);
  return value;
}

Status app_pairs_npy_read(AppPairsNpy *npy, double *row) {
  unsigned char bytes[8 * APP_PAIRS_MAX_COLUMNS];
  size_t size = (size_t)npy->row_size * (size_t)npy->number_size;
  if (fread(bytes, 1, size, npy->stream) != size) {
    if (ferror(npy->stream) && errno == EINTR) return status_fail(STATUS_INTERRUPTED, "interrupted");
    if (ferror(npy->stream))
      return status_fail(STATUS_IO, "%s: cannot be read: %s", npy->name, strerror(errno));
    return status_fail(STATUS_INPUT, "%s: announces %lld rows and ends in row %lld; is it complete?",
                       npy->name, npy->row_count, npy->next);
  }
  for (int k = 0; k < npy->row_size; k++) {
    row[k] = number_at(npy, bytes + (size_t)k * (size_t)npy->number_size);
    if (!isfinite(row[k]))
      return status_fail(STATUS_INPUT,
                         "%s: row %lld, number %d (both from 0): %g; a finite number is expected", npy->name,
                         npy->next, k, row[k]);
  }
  npy->next++;
  return STATUS_OK;
}

void app_pairs_npy_write_head(FILE *stream, const char *type, long long count) {
  char digits[COUNT_DIGITS + 1];
  snprintf(digits, sizeof digits, "%lld", count);
  int length =
      (int)strlen("{'descr': , 'fortran_order': False, 'shape': (,), }") + (int)strlen(type) + COUNT_DIGITS;
  int whole = (PREFIX + length + 1 + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  int behind = whole - PREFIX;
  fwrite(app_pairs_npy_magic, 1, APP_PAIRS_NPY_MAGIC, stream);
  fputc(1, stream), fputc(0, stream);
  fputc(behind & 0xff, stream), fputc(behind >> 8, stream);
  int written = fprintf(stream, "{'descr': %s, 'fortran_order': False, 'shape': (%s,), }", type, digits);
  for (; written < behind - 1; written++) fputc(' ', stream);
  fputc('\n', stream);
}
