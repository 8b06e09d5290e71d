// SPDX-License-Identifier: GPL-3.0-or-later
// A tetrahedral mesh in memory: positively oriented, every vertex used, every element of positive volume, no
// triangle with more than two tetrahedra. Whatever makes a FemMesh establishes this (fem/mesh/validate.h).
#ifndef TETLAP_FEM_MESH_MESH_H
#define TETLAP_FEM_MESH_MESH_H

#include <stdbool.h>

#include "base/status.h"

// A named set of vertices, and of tetrahedra where it has a volume: a physical group of the mesh file.
typedef struct FemMeshGroup {
  char *name;    // owned
  int *vertices; // sorted, distinct, owned   (vertex_count)
  int vertex_count;
  // Of second-order files: the edges whose nodes belong to it too, by number, sorted, distinct, owned.
  int *middles; //                            (middle_count)
  int middle_count;
  // The tetrahedra that the file puts into it, by number, sorted, distinct, owned; of a mesh made quadratic
  // the quadratic ones. None where it is of surfaces, curves, points.
  int *tets; //                               (tet_count)
  int tet_count;
} FemMeshGroup;

typedef struct FemMesh {
  int vertex_count;
  int tet_count;
  double *rest;         // rest positions [m]              (vertex_count, 3)
  int (*tets)[4];       // vertices, positively oriented   (tet_count)
  FemMeshGroup *groups; //                                 (group_count)
  int group_count;
  // Of a file of second-order tetrahedra, until the mesh is made linear or quadratic, else none: where the
  // nodes on edges lie, edges in the order of their ends (fem/mesh/edges.h).
  double *middles; // [m]                             (edge_count, 3)
  int edge_count;
  long long *tet_tags; // what the file calls its elements; NULL: their index   (tet_count)
  // Of a mesh made quadratic, else none: the nodes of each quadratic tetrahedron (fem/element/quadratic.h).
  // `tets` are their parts then, eight each in turn: 0 … 3 at the corners, 4 … 7 between them.
  int (*quadratic)[10]; //                               (quadratic_count)
  int quadratic_count;  // tet_count / 8
} FemMesh;

// What reading repaired, for `tetlap mesh` and the log.
typedef struct FemMeshRepairs {
  int reoriented_tets;
  int dropped_vertices; // not used by any tetrahedron (gmsh drops some itself, uncounted, as in .msh 2.2)
} FemMeshRepairs;

// Where a mesh stands in a scene: x ↦ translate + R(scale · x).
typedef struct FemPlacement {
  double scale[3];
  double axis[3]; // of the rotation; need not have unit length; zero: no rotation
  double angle_degrees;
  double translate[3]; // [m]
} FemPlacement;

// The rotated axes of space: row k is the image of axis k.
void fem_mesh_placement_axes(const FemPlacement *placement, double axes[3][3]);

// Options of meshing surfaces (.stl, .geo) in place.
typedef struct FemMeshOptions {
  double size; // target edge length in the file's units; 0: a .stl keeps its triangles, a .geo its own sizes
  bool is_curved; // edges on curved parts of the surface get curved (fem/mesh/curve.h), after reading
} FemMeshOptions;

// Reads by the ending: .msh (2.2, 4.1; ascii, binary), .mesh (MEDIT), .vtk (legacy), .stl and .geo (meshed in
// place by gmsh), .node/.ele (TetGen; either name). Repairs orientation and drops unused vertices.
// Second-order tetrahedra, of ten nodes, are taken by their corners, and their other nodes are kept beside
// them for fem_mesh_make_quadratic.
// Groups are the file's physical groups; one without a name is called point_7, curve_7, surface_7 or volume_7
// by its number. A file that has no physical groups (MEDIT never has) gives its entities (MEDIT references)
// under such names instead; TetGen's boundary markers become marker_7. A .stl has none.
// STATUS_IO: no such file, or not readable.
// STATUS_INPUT with file, element and what to do: not tetrahedral (other volume elements, or tetrahedra of
// both orders), zero volume, non-manifold (a face with more than two tetrahedra, two nodes on an edge),
// duplicate elements, indices out of range, not finite.
// `options` and `repairs` may be NULL.
Status fem_mesh_read(FemMesh *mesh, const char *path, const FemMeshOptions *options, FemMeshRepairs *repairs);

// Applies a placement; a mirroring scale keeps orientation positive. Quarter turns are exact. STATUS_INPUT,
// the mesh unchanged: a zero or non-finite scale, an angle about no axis, a result that is not finite.
Status fem_mesh_place(FemMesh *mesh, const FemPlacement *placement);

// Makes a mesh quadratic: a vertex on every edge, after the others and in the order of the edges' ends; where
// the file of second-order tetrahedra has it, else in the middle. Groups take in the nodes that the file
// gives them, or, where it gives none, those of their edges. STATUS_INPUT: too many or too flat tetrahedra,
// or so curved that they are inside out somewhere. After a failure the mesh is only to be destroyed.
Status fem_mesh_make_quadratic(FemMesh *mesh);

// Forgets the nodes on edges: what remains are straight tetrahedra of four corners.
void fem_mesh_make_linear(FemMesh *mesh);

void fem_mesh_destroy(FemMesh *mesh);
void fem_mesh_group_destroy(FemMeshGroup *group);

// A mesh of its own with the same content. STATUS_MEMORY: the copy is zeroed.
Status fem_mesh_copy(FemMesh *copy, const FemMesh *mesh);

typedef struct FemMeshQuality {
  double volume;                 // [m³]
  double box_min[3], box_max[3]; // [m]
  double min_dihedral_degrees, max_dihedral_degrees;
  int min_dihedral_tet;
  double min_det; // smallest 6 V / (longest edge)³; of a regular tetrahedron √½ = 0.707
  int min_det_tet;
  double min_edge, mean_edge, max_edge; // [m]; the mean over distinct edges
  int surface_triangle_count;
  double surface_area;         // [m²]
  int component_count;         // parts that share no vertex
  int pinch_edge_count;        // surface edges with more than two surface triangles
  int pinch_vertex_count;      // vertices where the surface touches itself, on no pinch edge
  int coincident_vertex_count; // vertices whose coordinates another, earlier one has exactly: an open seam
} FemMeshQuality;

// How second-order tetrahedra differ from straight ones. Zero, and no Jacobian, where the mesh has no
// middles.
typedef struct FemMeshCurvature {
  double deviation;    // of a node from the middle of its edge at most, over the edge's length
  double volume;       // of the curved elements, by their points of integration [m³]
  double min_jacobian; // smallest at those points, over that of the straight element; 1: straight
  int min_jacobian_tet;
} FemMeshCurvature;

Status fem_mesh_curvature(const FemMesh *mesh, FemMeshCurvature *curvature);

// The smallest of all dihedral angles [degrees].
double fem_mesh_min_dihedral(const FemMesh *mesh);

Status fem_mesh_quality(const FemMesh *mesh, FemMeshQuality *quality);

// How many of the positions (count, 3) an earlier one has exactly: `coincident_vertex_count` of a mesh.
Status fem_mesh_coincident(const double *positions, int count, int *coincident_count);

// Boundary triangles, outward oriented; `*triangles` is owned by the caller (memory_free).
Status fem_mesh_surface(const FemMesh *mesh, int (**triangles)[3], int *triangle_count);

// A box [0, size] cut into nx × ny × nz cubes of six (Kuhn) tetrahedra each; used by `mesh: {box: …}` and
// tests. Its faces are the groups x_min, x_max, y_min, y_max, z_min, z_max.
Status fem_mesh_box(FemMesh *mesh, const double size[3], const int cells[3]);

#endif
