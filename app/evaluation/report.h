// SPDX-License-Identifier: GPL-3.0-or-later
// An evaluation as a table beside the paper's own numbers, and as JSON.
#ifndef TETLAP_APP_EVALUATION_REPORT_H
#define TETLAP_APP_EVALUATION_REPORT_H

#include <stdio.h>

#include "app/evaluation/evaluation.h"
#include "app/evaluation/paths.h"
#include "base/files/record.h"

// Table 4's own figures stand beside those of data like the paper's (`is_paper`): elsewhere volumes are of
// another size, and so are mean errors. STATUS_MEMORY.
Status app_evaluation_print(const AppEvaluation *evaluation, const char *model, const char *data,
                            bool is_paper, FILE *stream);

// The keys that others script against: accuracy (kind → share), accuracy_mean, mae, mae_small, … ; what could
// not be measured is null.
void app_evaluation_record(const AppEvaluation *evaluation, Record *record);

void app_evaluation_print_paths(const AppEvaluationPaths *paths, const char *model, FILE *stream);
// The keys count, replaced, jumping, volume_jump, gradient_jump.
void app_evaluation_record_paths(const AppEvaluationPaths *paths, Record *record);

#endif
