// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/pvd.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fem/output/vtk/xml.h"

Status fem_pvd_begin(FileWriter *list, const char *path) {
  TRY(file_begin(list, path));
  fprintf(list->stream, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
                        "  <Collection>\n");
  return STATUS_OK;
}

void fem_pvd_add(FileWriter *list, double time, int part, const char *name, const char *file) {
  fprintf(list->stream, "    <DataSet timestep=\"%.17g\" part=\"%d\"", time, part);
  if (name) {
    fprintf(list->stream, " name=\"");
    fem_xml_print(list->stream, name);
    fprintf(list->stream, "\"");
  }
  fprintf(list->stream, " file=\"");
  fem_xml_print(list->stream, file);
  fprintf(list->stream, "\"/>\n");
}

Status fem_pvd_commit(FileWriter *list) {
  fprintf(list->stream, "  </Collection>\n</VTKFile>\n");
  return file_commit(list);
}

// One entry `timestep="T" part="P" name="NAME" file="FILE"`, as printed above: the next file of the list.
static Status read_entry(const char *tag, FemPvdList *list, int *file_count) {
  const char *close = strstr(tag, "/>"), *time = strstr(tag, " timestep=\""), *file = strstr(tag, " file=\""),
             *part = strstr(tag, " part=\"");
  if (!close || !time || !file || time > close || file > close)
    return status_fail(STATUS_INPUT, "an entry lacks its time or its file");
  double at = strtod(time + strlen(" timestep=\""), NULL);
  long number = part && part < close ? strtol(part + strlen(" part=\""), NULL, 10) : 0;
  if (number == 0) list->times[list->count++] = at;
  if (list->count == 1) list->part_count = *file_count + 1;
  if (list->count == 0 || at != list->times[list->count - 1] ||
      number != *file_count - (list->count - 1) * list->part_count)
    return status_fail(STATUS_INPUT, "the times have not the same parts, in order");
  file += strlen(" file=\"");
  size_t length = strcspn(file, "\"");
  char *name = memory_zeroed(length + 1, 1);
  if (!name) return status_no_memory("the list of frames");
  memcpy(name, file, length);
  list->files[(*file_count)++] = name;
  return STATUS_OK;
}

static Status read_list(const char *text, FemPvdList *list) {
  static const char entry[] = "<DataSet ";
  if (!strstr(text, "type=\"Collection\""))
    return status_fail(STATUS_INPUT, "is not a list of frames (a VTK file of type Collection)");
  size_t count = 0;
  for (const char *tag = text; (tag = strstr(tag, entry)); tag++) count++;
  list->times = memory_zeroed(count, sizeof *list->times);
  list->files = memory_zeroed(count + 1, sizeof *list->files); // ends with NULL
  if (!list->times || !list->files) return status_no_memory("the list of frames");
  int file_count = 0;
  for (const char *tag = text; (tag = strstr(tag, entry)); tag++) TRY(read_entry(tag, list, &file_count));
  if (file_count != list->count * list->part_count)
    return status_fail(STATUS_INPUT, "the last time lacks some of its parts");
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
  for (char **file = list->files; file && *file; file++) memory_free(*file);
  memory_free(list->files);
  memory_free(list->times);
  *list = (FemPvdList){0};
}
