// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/elf.h"

#include <elf.h>
#include <errno.h>
#include <link.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const unsigned char CLASS = sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32,
                           DATA = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? ELFDATA2LSB : ELFDATA2MSB;

static uint64_t greater(uint64_t a, uint64_t b) {
  return a > b ? a : b;
}

// The end of a part of a file; one that wraps round is beyond any file.
static uint64_t end_of(uint64_t begin, uint64_t size) {
  return begin + size < begin ? UINT64_MAX : begin + size;
}

// Where the last part ends that is loaded, as far as the headers are there.
static uint64_t find_end(FILE *file, const ElfW(Ehdr) * header) {
  uint64_t end = end_of(header->e_phoff, (uint64_t)header->e_phnum * header->e_phentsize);
  if (header->e_phentsize != sizeof(ElfW(Phdr)) || fseeko(file, (off_t)header->e_phoff, SEEK_SET) != 0)
    return end;
  for (int p = 0; p < header->e_phnum; p++) {
    ElfW(Phdr) part;
    if (fread(&part, sizeof part, 1, file) != 1) break;
    if (part.p_type == PT_LOAD) end = greater(end, end_of(part.p_offset, part.p_filesz));
  }
  return end;
}

Status overlap_foreign_elf_check(const char *path) {
  ElfW(Ehdr) header;
  struct stat about;
  FILE *file = fopen(path, "re");
  if (!file || fstat(fileno(file), &about) != 0) {
    if (file) fclose(file);
    return status_fail(STATUS_IO, "%s: cannot be opened: %s", path, strerror(errno));
  }
  const bool is_read = fread(&header, sizeof header, 1, file) == 1 &&
                       memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 && header.e_ident[EI_CLASS] == CLASS &&
                       header.e_ident[EI_DATA] == DATA;
  const uint64_t end = is_read ? find_end(file, &header) : 0, size = (uint64_t)about.st_size;
  fclose(file);
  if (end <= size) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "%s: is cut off: it has %llu bytes, its headers say %llu. Build or copy it again", path,
                     (unsigned long long)size, (unsigned long long)end);
}
