// SPDX-License-Identifier: GPL-3.0-or-later
// The web page without its data, report/page.html, compiled into the program.
#ifndef TETLAP_APP_REPORT_PAGE_H
#define TETLAP_APP_REPORT_PAGE_H

// Where in the page the data belongs.
#define APP_REPORT_PAGE_MARK "<!--tetlap:data-->"

// Where its security policy, which lets it ask for nothing, ends.
#define APP_REPORT_PAGE_POLICY_END "\">\n<title>"

// The whole page; borrowed.
const char *app_report_page_text(void);

#endif
