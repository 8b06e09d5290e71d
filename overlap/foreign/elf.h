// SPDX-License-Identifier: Apache-2.0
// Shared libraries before they are loaded: of one that was cut off, the system maps pages that are not there,
// and the first touch ends the program.
#ifndef TETLAP_OVERLAP_FOREIGN_ELF_H
#define TETLAP_OVERLAP_FOREIGN_ELF_H

#include "base/status.h"

// STATUS_INPUT: the file ends before what its headers say (System V ABI, chapters 4 and 5). What is no ELF
// file of this machine's class and order of bytes is left to dlopen.
Status overlap_foreign_elf_check(const char *path);

#endif
