// SPDX-License-Identifier: GPL-3.0-or-later
// Fills a report with what is in folders of `tetlap run`, `tetlap compare` and `tetlap verdict`.
#ifndef TETLAP_APP_REPORT_COLLECT_H
#define TETLAP_APP_REPORT_COLLECT_H

#include "app/report/report.h"

// Adds the run in a folder, or if `is_alone` all runs of the comparison in it or its verdicts. At most
// `max_frames` of each run (0: all). STATUS_USAGE: too many runs; STATUS_INPUT, STATUS_IO, STATUS_MEMORY.
Status app_report_collect(AppReport *report, const char *directory, bool is_alone, int max_frames);

#endif
