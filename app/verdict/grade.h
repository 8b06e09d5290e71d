// SPDX-License-Identifier: GPL-3.0-or-later
// Three grades of a model, each a list of conditions with their thresholds: the table in grade.c is what
// docs/verdict.md says.
#ifndef TETLAP_APP_VERDICT_GRADE_H
#define TETLAP_APP_VERDICT_GRADE_H

#include "app/verdict/findings.h"
#include "base/files/record.h"

typedef enum AppVerdictUse { APP_VERDICT_DETECT, APP_VERDICT_FORCES, APP_VERDICT_MOTION } AppVerdictUse;
enum { APP_VERDICT_USES = 3, APP_VERDICT_REASON = 160 };

extern const char *const app_verdict_uses[APP_VERDICT_USES]; // "detect", "forces", "motion"

typedef struct AppVerdictGrade {
  bool is_fit;
  char reason[APP_VERDICT_REASON]; // what is not met first, with figure and bound; "" where it is fit
} AppVerdictGrade;

// What was not measured is not met.
void app_verdict_grade(const AppVerdictFindings *findings, AppVerdictGrade grades[APP_VERDICT_USES]);

// The conditions of a use as rows: `what` in words, the `bound`, whether it is the `least` (else the most),
// the `value`, of runs the worst with its `scene`, and whether it is `met`.
void app_verdict_grade_record(const AppVerdictFindings *findings, AppVerdictUse use, RecordList *rows);

#endif
