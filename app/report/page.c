// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/page.h"

// The assembler takes the file's bytes as they are, and a terminating 0.
__asm__(".pushsection .rodata\n"
        "app_report_page_begin:\n"
        ".incbin \"" TETLAP_PAGE "\"\n"
        ".byte 0\n"
        ".popsection\n");

extern const char page_begin[] __asm__("app_report_page_begin");

const char *app_report_page_text(void) {
  return page_begin;
}
