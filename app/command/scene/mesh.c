// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdbool.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "base/files/record.h"
#include "base/log.h"
#include "fem/mesh/mesh.h"

// Angles below this make the stiffness matrix worse conditioned than its size alone would.
static const double POOR_DIHEDRAL_DEGREES = 5;

typedef struct Options {
  const char *path;
  double size;
  bool is_json;
} Options;

static const AppOption option_table[] = {
    {"size", 's', "LENGTH", "Target edge length of a .stl or .geo, in its units", 0, CLI_POSITIVE,
     CLI_TO(Options, size)},
    {"json", 'j', NULL, "Print JSON", 0, CLI_FLAG, CLI_TO(Options, is_json)},
    {0},
};

// What an analyst should know before using the mesh, one sentence each.
enum { MAX_REMARKS = 7, REMARK_SIZE = 200 };

typedef struct Remarks {
  char lines[MAX_REMARKS][REMARK_SIZE];
  int count;
} Remarks;

static void remark(Remarks *remarks, const char *format, double number) {
  snprintf(remarks->lines[remarks->count++], REMARK_SIZE, format, number);
}

static Remarks find_remarks(const FemMeshQuality *quality, const FemMeshCurvature *curvature,
                            const FemMeshRepairs *repairs) {
  Remarks remarks = {0};
  if (repairs->reoriented_tets)
    remark(&remarks, "inverted tetrahedra whose orientation was corrected: %.0f", repairs->reoriented_tets);
  if (repairs->dropped_vertices)
    remark(&remarks, "vertices that belong to no tetrahedron and have been left out: %.0f",
           repairs->dropped_vertices);
  if (quality->coincident_vertex_count)
    remark(
        &remarks,
        "vertices that lie exactly on another: %.0f; the mesh is open there: merge them unless it is meant",
        quality->coincident_vertex_count);
  if (quality->component_count > 1)
    remark(&remarks, "parts that are not connected: %.0f; they move apart freely", quality->component_count);
  if (quality->pinch_edge_count || quality->pinch_vertex_count)
    remark(&remarks, "edges or vertices where the surface touches itself: %.0f; they act as hinges",
           quality->pinch_edge_count + quality->pinch_vertex_count);
  if (!(quality->min_dihedral_degrees >= POOR_DIHEDRAL_DEGREES))
    remark(&remarks, "the smallest dihedral angle is %.2g°: expect slow solves and small steps; mesh it anew",
           quality->min_dihedral_degrees);
  if (!(curvature->min_jacobian > 0))
    remark(&remarks,
           "tetrahedron %.0f, as a curved one, is inside out: only its corners can be used (element: linear)",
           curvature->min_jacobian_tet);
  return remarks;
}

static void print_order(const FemMesh *mesh, const FemMeshCurvature *curvature) {
  if (!mesh->middles) {
    printf("  order        1: four nodes a tetrahedron\n");
    return;
  }
  printf("  order        2: ten nodes a tetrahedron, %d on edges; what follows is of the four corners\n",
         mesh->edge_count);
  printf("  curvature    nodes on edges up to %.2g of an edge from its middle, volume %.6g m³,\n"
         "               smallest Jacobian %.3g in tetrahedron %d (straight: 1)\n",
         curvature->deviation, curvature->volume, curvature->min_jacobian, curvature->min_jacobian_tet);
}

static void print_text(const char *path, const FemMesh *mesh, const FemMeshQuality *q,
                       const FemMeshCurvature *curvature, const Remarks *remarks) {
  printf("%s\n", path);
  printf("  vertices     %d\n  tetrahedra   %d\n", mesh->vertex_count, mesh->tet_count);
  print_order(mesh, curvature);
  printf("  surface      %d triangles, %.6g m²\n", q->surface_triangle_count, q->surface_area);
  printf("  volume       %.6g m³\n  parts        %d\n", q->volume, q->component_count);
  printf("  box          (%g, %g, %g) … (%g, %g, %g) m\n", q->box_min[0], q->box_min[1], q->box_min[2],
         q->box_max[0], q->box_max[1], q->box_max[2]);
  printf("  edges        %.3g … %.3g m, mean %.3g m\n", q->min_edge, q->max_edge, q->mean_edge);
  printf("  dihedral     %.3g° … %.3g°, the smallest in tetrahedron %d\n", q->min_dihedral_degrees,
         q->max_dihedral_degrees, q->min_dihedral_tet);
  printf("  min det      %.3g in tetrahedron %d (6 V over longest edge cubed; regular: 0.707)\n", q->min_det,
         q->min_det_tet);
  printf("  groups      ");
  for (int g = 0; g < mesh->group_count; g++) {
    const FemMeshGroup *group = &mesh->groups[g];
    printf("%s %s (%d", g ? "," : "", group->name, group->vertex_count);
    if (group->tet_count > 0) printf(", %d tetrahedra", group->tet_count);
    printf(")");
  }
  printf("%s\n", mesh->group_count ? "" : " none");
  for (int k = 0; k < remarks->count; k++)
    printf("  %s %s\n", k ? "            " : "remarks     ", remarks->lines[k]);
  if (!remarks->count) printf("  remarks      none: nothing is wrong\n");
}

static void record_order(Record *root, const FemMesh *mesh, const FemMeshCurvature *curvature) {
  record_integer(root, "order", mesh->middles ? 2 : 1);
  if (!mesh->middles) return;
  record_integer(root, "nodes_on_edges", mesh->edge_count);
  record_number(root, "curvature_deviation", curvature->deviation);
  record_number(root, "curvature_volume", curvature->volume);
  record_number(root, "min_jacobian", curvature->min_jacobian);
  record_integer(root, "min_jacobian_tetrahedron", curvature->min_jacobian_tet);
}

static Status print_json(const char *path, const FemMesh *mesh, const FemMeshQuality *q,
                         const FemMeshCurvature *curvature, const FemMeshRepairs *repairs,
                         const Remarks *remarks) {
  Record *root = record_new();
  record_text(root, "file", path);
  record_integer(root, "vertices", mesh->vertex_count);
  record_integer(root, "tetrahedra", mesh->tet_count);
  record_order(root, mesh, curvature);
  record_integer(root, "surface_triangles", q->surface_triangle_count);
  record_number(root, "surface_area", q->surface_area);
  record_number(root, "volume", q->volume);
  record_integer(root, "parts", q->component_count);
  record_numbers(root, "box_min", q->box_min, 3);
  record_numbers(root, "box_max", q->box_max, 3);
  record_number(root, "min_edge", q->min_edge);
  record_number(root, "mean_edge", q->mean_edge);
  record_number(root, "max_edge", q->max_edge);
  record_number(root, "min_dihedral_degrees", q->min_dihedral_degrees);
  record_number(root, "max_dihedral_degrees", q->max_dihedral_degrees);
  record_integer(root, "min_dihedral_tetrahedron", q->min_dihedral_tet);
  record_number(root, "min_det", q->min_det);
  record_integer(root, "min_det_tetrahedron", q->min_det_tet);
  record_integer(root, "coincident_vertices", q->coincident_vertex_count);
  record_integer(root, "pinch_edges", q->pinch_edge_count);
  record_integer(root, "pinch_vertices", q->pinch_vertex_count);
  record_integer(root, "reoriented_tetrahedra", repairs->reoriented_tets);
  record_integer(root, "dropped_vertices", repairs->dropped_vertices);
  RecordList *groups = record_list(root, "groups");
  for (int g = 0; g < mesh->group_count; g++) {
    Record *group = record_append(groups);
    record_text(group, "name", mesh->groups[g].name);
    record_integer(group, "vertices", mesh->groups[g].vertex_count);
    record_integer(group, "tetrahedra", mesh->groups[g].tet_count);
  }
  RecordList *lines = record_list(root, "remarks");
  for (int k = 0; k < remarks->count; k++) record_append_text(lines, remarks->lines[k]);
  Status status = root ? record_print(root, stdout) : status_no_memory("the report");
  record_destroy(root);
  return status;
}

static Status report(const Options *options) {
  FemMesh mesh;
  FemMeshRepairs repairs;
  FemMeshQuality quality;
  FemMeshCurvature curvature;
  // The remarks repeat what reading would log.
  LogLevel level = log_level();
  log_set_level(LOG_WARNING);
  Status status = fem_mesh_read(&mesh, options->path, &(FemMeshOptions){.size = options->size}, &repairs);
  log_set_level(level);
  if (status == STATUS_OK) status = fem_mesh_quality(&mesh, &quality);
  if (status == STATUS_OK) status = fem_mesh_curvature(&mesh, &curvature);
  if (status == STATUS_OK) {
    Remarks remarks = find_remarks(&quality, &curvature, &repairs);
    if (options->is_json)
      status = print_json(options->path, &mesh, &quality, &curvature, &repairs, &remarks);
    else
      print_text(options->path, &mesh, &quality, &curvature, &remarks);
    if (status == STATUS_OK && fflush(stdout) != 0)
      status = status_fail(STATUS_IO, "standard output cannot be written");
  }
  fem_mesh_destroy(&mesh);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_mesh, argument_count, arguments, &options);
  return app_cli_command_end(report(&options));
}

const AppCommand app_command_mesh = {
    .name = "mesh",
    .help = "print a mesh's counts, volume, quality and faults",
    .options = option_table,
    .arguments = &(const AppArguments){"FILE", offsetof(Options, path), 1,
                                       .missing = "which mesh? give a file, as tetlap mesh meshes/block.msh",
                                       .excess = "'%s' is one argument too many: give one mesh file"},
    .doc =
        "Print a mesh's counts, volume, quality and faults: .msh, .mesh, .vtk, .node/.ele; a .stl or .geo is "
        "meshed first. Lengths are taken as metres.",
    .run = run_command};
