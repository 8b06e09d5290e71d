// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/pvd.h"

#include "base/file.h"
#include "fem/xml.h"

Status fem_pvd_write(const char *path, const double *times, const char *const *files, int count) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fprintf(writer.stream, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
                         "  <Collection>\n");
  for (int k = 0; k < count; k++) {
    fprintf(writer.stream, "    <DataSet timestep=\"%.17g\" part=\"0\" file=\"", times[k]);
    fem_xml_print(writer.stream, files[k]);
    fprintf(writer.stream, "\"/>\n");
  }
  fprintf(writer.stream, "  </Collection>\n</VTKFile>\n");
  return file_commit(&writer);
}
