// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts as a table for a terminal, as Markdown, and as verdict.json.
#ifndef TETLAP_APP_VERDICT_REPORT_H
#define TETLAP_APP_VERDICT_REPORT_H

#include <stdio.h>

#include "app/table/table.h"
#include "app/verdict/grade.h"

// A model's grades in words, then its runs.
Status app_verdict_print(const AppVerdictPlan *plan, const AppVerdictFindings *findings,
                         AppTableFormat format, FILE *stream);

// Grades and numbers of a model; owned by the caller, NULL: no memory.
Record *app_verdict_record(const AppVerdictPlan *plan, const AppVerdictFindings *findings);

#endif
