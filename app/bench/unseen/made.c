// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/unseen/made.h"

#include <stdio.h>

#include "base/files/file.h"
#include "base/files/temporary.h"
#include "base/memory.h"

// The ground face, drawn up by extrusion.
static Status write_box(const char *path, const double size[3], double edge, double growth) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fprintf(writer.stream, "Mesh.Algorithm3D = 1;\n"); // Delaunay; others are not the same at every call
  for (int p = 0; p < 4; p++)
    fprintf(writer.stream, "Point(%d) = {%.17g, %.17g, 0, %.17g};\n", p + 1, (p % 3 ? 0.5 : -0.5) * size[0],
            (p > 1 ? 0.5 : -0.5) * size[1], edge * (p % 3 ? growth : 1));
  for (int p = 0; p < 4; p++) fprintf(writer.stream, "Line(%d) = {%d, %d};\n", p + 1, p + 1, (p + 1) % 4 + 1);
  fprintf(writer.stream, "Curve Loop(1) = {1, 2, 3, 4};\nPlane Surface(1) = {1};\n");
  fprintf(writer.stream, "body[] = Extrude {0, 0, %.17g} { Surface{1}; };\n", size[2]);
  return file_commit(&writer);
}

Status app_unseen_made_create(FemMesh *mesh, const double size[3], double edge, double growth) {
  char *path;
  TRY(temporary_file("unseen", ".geo", &path));
  Status status = write_box(path, size, edge, growth);
  if (!status) status = fem_mesh_read(mesh, path, NULL, NULL);
  temporary_remove(path);
  return status;
}
