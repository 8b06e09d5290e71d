// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/report.h"

#include <stddef.h>

// A run as a row; errors in per cent.
#define TEXT(key, member, head)                                                                              \
  { key, APP_TABLE_TEXT, offsetof(AppVerdictRun, member), head, NULL }
#define NUMBER(key, member, head)                                                                            \
  { key, APP_TABLE_NUMBER, offsetof(AppVerdictRun, member), head, NULL }

// What a text column points to.
typedef struct Row {
  const char *outcome;
} Row;

static const AppTableColumn columns[] = {
    TEXT("scene", scene, "scene"),
    TEXT("kind", kind, "kind"),
    NUMBER("share_reached", share_reached, "reached"),
    NUMBER("nodal_force_error", nodal_error, "nodal forces"),
    NUMBER("total_force_error", total_error, "total force"),
    NUMBER("path_error", path_error, "path"),
    NUMBER("energy_gain", energy_gain, "energy gained"),
    NUMBER("momentum_gap", momentum_gap, "momentum gap"),
    NUMBER("steps_ratio", steps, "steps / clip"),
    NUMBER("time_ratio", time, "time / clip"),
};
static const AppTableColumn outcome_column[] = {
    {"outcome", APP_TABLE_TEXT, offsetof(Row, outcome), "outcome", NULL}};

static const char *const headlines[APP_VERDICT_USES] = {
    "fit to detect overlaps", "fit for forces at given states", "fit to drive a motion"};

Status app_verdict_print(const AppVerdictPlan *plan, const AppVerdictFindings *findings,
                         AppTableFormat format, FILE *stream) {
  AppVerdictGrade grades[APP_VERDICT_USES];
  Row rows[APP_VERDICT_SCENES];
  const char *bullet = format == APP_TABLE_MARKDOWN ? "- " : "  ";
  app_verdict_grade(findings, grades);
  fprintf(stream, format == APP_TABLE_MARKDOWN ? "## %s\n\n" : "%s\n", plan->name);
  for (int u = 0; u < APP_VERDICT_USES; u++)
    fprintf(stream, "%s%s: %s%s%s\n", bullet, headlines[u], grades[u].is_fit ? "yes" : "no",
            grades[u].is_fit ? "" : ", ", grades[u].reason);
  fputc('\n', stream);
  for (int r = 0; r < findings->run_count; r++) rows[r].outcome = findings->runs[r].outcome;
  const AppTablePart parts[] = {
      {columns, sizeof columns / sizeof *columns, findings->runs, sizeof *findings->runs},
      {outcome_column, 1, rows, sizeof *rows}};
  TRY(app_table_print(&(AppTable){parts, 2, findings->run_count}, format, stream));
  fputc('\n', stream);
  return STATUS_OK;
}

Record *app_verdict_record(const AppVerdictPlan *plan, const AppVerdictFindings *findings) {
  AppVerdictGrade grades[APP_VERDICT_USES];
  Record *record = record_new();
  app_verdict_grade(findings, grades);
  record_integer(record, "format", 1);
  record_text(record, "model", plan->name);
  record_text(record, "source", plan->source);
  record_bool(record, "quick", plan->is_quick);
  Record *uses = record_child(record, "grades");
  for (int u = 0; u < APP_VERDICT_USES; u++) {
    Record *use = record_child(uses, app_verdict_uses[u]);
    record_bool(use, "fit", grades[u].is_fit);
    record_text(use, "reason", grades[u].reason);
    app_verdict_grade_record(findings, (AppVerdictUse)u, record_list(use, "conditions"));
  }
  app_verdict_findings_record(findings, record);
  return record;
}
