// SPDX-License-Identifier: GPL-3.0-or-later
// Text inside XML: shared by the writers of .vtu and .pvd.
#ifndef TETLAP_FEM_OUTPUT_VTK_XML_H
#define TETLAP_FEM_OUTPUT_VTK_XML_H

#include <stdio.h>

// Prints `text` with &, <, > and " replaced, so that it can stand in an attribute or between tags.
static inline void fem_xml_print(FILE *stream, const char *text) {
  for (; *text; text++) {
    switch (*text) {
    case '&':
      fputs("&amp;", stream);
      break;
    case '<':
      fputs("&lt;", stream);
      break;
    case '>':
      fputs("&gt;", stream);
      break;
    case '"':
      fputs("&quot;", stream);
      break;
    default:
      fputc(*text, stream);
    }
  }
}

#endif
