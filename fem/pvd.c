// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/pvd.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fem/xml.h"

Status fem_pvd_begin(FileWriter *list, const char *path) {
  TRY(file_begin(list, path));
  fprintf(list->stream, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
                        "  <Collection>\n");
  return STATUS_OK;
}

void fem_pvd_add(FileWriter *list, double time, const char *file) {
  fprintf(list->stream, "    <DataSet timestep=\"%.17g\" part=\"0\" file=\"", time);
  fem_xml_print(list->stream, file);
  fprintf(list->stream, "\"/>\n");
}

Status fem_pvd_commit(FileWriter *list) {
  fprintf(list->stream, "  </Collection>\n</VTKFile>\n");
  return file_commit(list);
}

// One entry `timestep="T" part="0" file="NAME"`, as printed above.
static Status read_entry(const char *tag, FemPvdList *list) {
  const char *close = strstr(tag, "/>"), *time = strstr(tag, " timestep=\""), *file = strstr(tag, " file=\"");
  if (!close || !time || !file || time > close || file > close)
    return status_fail(STATUS_INPUT, "an entry lacks its time or its file");
  file += strlen(" file=\"");
  size_t length = strcspn(file, "\"");
  char *name = memory_zeroed(length + 1, 1);
  if (!name) return status_no_memory("the list of frames");
  memcpy(name, file, length);
  list->files[list->count] = name;
  list->times[list->count++] = strtod(time + strlen(" timestep=\""), NULL);
  return STATUS_OK;
}

static Status read_list(const char *text, FemPvdList *list) {
  static const char entry[] = "<DataSet ";
  if (!strstr(text, "type=\"Collection\""))
    return status_fail(STATUS_INPUT, "is not a list of frames (a VTK file of type Collection)");
  size_t count = 0;
  for (const char *tag = text; (tag = strstr(tag, entry)); tag++) count++;
  list->times = memory_zeroed(count, sizeof *list->times);
  list->files = memory_zeroed(count, sizeof *list->files);
  if (!list->times || !list->files) return status_no_memory("the list of frames");
  for (const char *tag = text; (tag = strstr(tag, entry)); tag++) TRY(read_entry(tag, list));
  return STATUS_OK;
}

Status fem_pvd_read(const char *path, FemPvdList *list) {
  char *text;
  size_t size;
  *list = (FemPvdList){0};
  TRY(file_read(path, &text, &size));
  Status status = read_list(text, list);
  memory_free(text);
  if (!status) return STATUS_OK;
  fem_pvd_destroy(list);
  return status_prefix(status, "%s", path);
}

void fem_pvd_destroy(FemPvdList *list) {
  for (int k = 0; k < list->count; k++) memory_free(list->files[k]);
  memory_free(list->files);
  memory_free(list->times);
  *list = (FemPvdList){0};
}
