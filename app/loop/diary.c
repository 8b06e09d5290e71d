// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/diary.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

static Status append(AppLoopDiary *diary, const char *line, size_t size) {
  if (!memory_reserve((void **)&diary->text, &diary->capacity, diary->size + size + 1, 1))
    return status_no_memory("the record of what was set");
  memcpy(diary->text + diary->size, line, size);
  diary->size += size;
  diary->text[diary->size] = 0;
  return STATUS_OK;
}

static Status append_record(AppLoopDiary *diary, Record *record) {
  char *line = NULL;
  size_t size = 0;
  FILE *stream = record ? open_memstream(&line, &size) : NULL;
  Status status = stream ? record_print_line(record, stream) : status_no_memory("the record of what was set");
  if (stream) fclose(stream);
  if (!status) status = append(diary, line, size);
  free(line);
  record_destroy(record);
  return status;
}

Status app_loop_diary_create(AppLoopDiary *diary, int vertex_count) {
  char line[64];
  *diary = (AppLoopDiary){0};
  int size = snprintf(line, sizeof line, "{\"format\": %d, \"vertices\": %d}\n", APP_LOOP_DIARY_FORMAT,
                      vertex_count);
  return append(diary, line, (size_t)size);
}

void app_loop_diary_destroy(AppLoopDiary *diary) {
  memory_free(diary->text);
  *diary = (AppLoopDiary){0};
}

Status app_loop_diary_set(AppLoopDiary *diary, AppLoopKind kind, const char *name, double ramp,
                          const double *values, int count) {
  Record *record = record_new();
  record_text(record, kind == APP_LOOP_DRIVE ? "drive" : "load", name);
  record_numbers(record, "to", values, count);
  if (ramp == APP_LOOP_NEXT_ADVANCE)
    record_value(record, "ramp", NULL);
  else
    record_number(record, "ramp", ramp);
  return append_record(diary, record);
}

Status app_loop_diary_advance(AppLoopDiary *diary, double until, double stopped) {
  char line[128];
  int size = stopped < until
                 ? snprintf(line, sizeof line, "{\"advance\": %.17g, \"stopped\": %.17g}\n", until, stopped)
                 : snprintf(line, sizeof line, "{\"advance\": %.17g}\n", until);
  return append(diary, line, (size_t)size);
}

Status app_loop_diary_anew(AppLoopDiary *diary) {
  static const char line[] = "{\"anew\": true}\n";
  return append(diary, line, sizeof line - 1);
}

Status app_loop_diary_copy(AppLoopDiary *copy, const AppLoopDiary *diary) {
  copy->size = 0;
  return append(copy, diary->text, diary->size);
}

Status app_loop_diary_write(const AppLoopDiary *diary, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fwrite(diary->text, 1, diary->size, writer.stream);
  Status status = file_commit(&writer);
  file_abandon(&writer);
  return status;
}
