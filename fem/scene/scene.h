// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as its file says it: the definition from which a model is built. Plain data with defaults; reading
// the file is app/scene/read.c. Strings and arrays are owned by the scene.
#ifndef TETLAP_FEM_SCENE_SCENE_H
#define TETLAP_FEM_SCENE_SCENE_H

#include <stdbool.h>

#include "base/expression.h"
#include "contact/def.h"
#include "contact/pressure/law.h"
#include "fem/material/material.h"
#include "fem/mesh/mesh.h"
#include "fem/sparse/solver.h"

// A place in the scene file, for messages; line 0: not from the file, but given by --set or made by a
// program.
typedef struct FemScenePlace {
  int line, column;
} FemScenePlace;

// Which vertices: exactly one way.
typedef enum FemSelectKind {
  FEM_SELECT_ALL,
  FEM_SELECT_BOX,       // inside box_min … box_max, faces included
  FEM_SELECT_HALFSPACE, // normal·(x − point) ≤ 0
  FEM_SELECT_GROUP,     // a named group of the mesh
  FEM_SELECT_RADIUS,    // from the line through `point` along `normal`, or, if that is zero, from the point
  FEM_SELECT_NORMAL,    // of surface triangles whose outward normals make at most `degrees` with `normal`
} FemSelectKind;

typedef struct FemSelectDef {
  FemSelectKind kind;
  double box_min[3], box_max[3]; // [m], in the scene, at rest
  double point[3], normal[3];
  double radius_min, radius_max; // [m], both included
  double degrees;
  char *group;
  FemScenePlace place;
} FemSelectDef;

// Fixed (all motion zero) or driven vertices. A driven vertex moves with the displacement
// d(t) = velocity·t + amplitude·sin(2π frequency t), or along a table of (time, displacement), or by a
// formula for each coordinate, until `until`, where it stops; and turns about `axis` through `centre` by
// spin·t [rad], or by an angle of its own. From `release` on the vertices are free, with the velocity that
// they had.
typedef struct FemConstraintDef {
  FemSelectDef select;
  bool components[3];  // which of x, y, z are prescribed
  double velocity[3];  // [m/s]
  double amplitude[3]; // [m]
  double frequency;    // [Hz]
  double spin;         // [rad/s]
  bool turns;          // by `angle` or `angles`
  Expression *angle;   // [rad] of t [s], owned; NULL: none
  double *angles;      // time [s], angle [rad]       (angle_count, 2), times increasing
  int angle_count;
  double axis[3], centre[3];
  bool moves_first; // the turn is of what has been displaced; else what has turned is displaced, axis and all
  double *table;    // time [s], displacement [m]    (table_count, 4), times increasing
  int table_count;
  Expression *formula[3]; // displacement [m] of t [s], owned; NULL: none
  double until;           // [s]; INFINITY: for ever
  bool is_external;       // the table is filled while the run goes on (fem_drive_set)
  double release;         // [s]; 0: never
} FemConstraintDef;

// A load on the surface or the vertices of a body: its value times a factor that may depend on time.
typedef enum FemLoadKind {
  FEM_LOAD_FORCE,      // total, distributed evenly over the selected vertices [N]
  FEM_LOAD_BODY_FORCE, // by rest volume [N/m³]
  FEM_LOAD_TRACTION,   // by rest area of the surface triangles whose corners are all selected [N/m²]
  FEM_LOAD_PRESSURE,   // on the same triangles, against their outward normal [Pa]
  FEM_LOAD_TORQUE,     // moment of the selected vertices, without a resultant [N m]
  FEM_LOAD_EXTERNAL,   // nodal forces that are set while the run goes on (fem_load_set) [N]
} FemLoadKind;

typedef struct FemLoadDef {
  FemSelectDef select; // the first member, as in FemConstraintDef
  FemLoadKind kind;
  double vector[3]; // of all kinds but pressure
  double pressure;
  bool is_dead;       // a pressure that keeps its direction and area at rest; else it follows the surface
  Expression *factor; // of t [s], owned; NULL: none
  double *table;      // time [s], factor; linear between, constant outside    (table_count, 2)
  int table_count;
} FemLoadDef;

// How a body's tetrahedra resist. `nodal` and `quadratic` do not lock as ν → ½.
typedef enum FemElementKind {
  FEM_ELEMENT_LINEAR,
  FEM_ELEMENT_NODAL,     // linear, the volume change averaged at the vertices (fem/effect/elements/volume.h)
  FEM_ELEMENT_QUADRATIC, // ten nodes (fem/element/quadratic.h)
} FemElementKind;

// Part of a body's boundary that is no surface: a plane of symmetry, or glued to something.
typedef struct FemInnerDef {
  FemSelectDef select; // the first member; its faces have all their corners in it
} FemInnerDef;

enum { FEM_MAX_INNER = 8 }; // of a body

// A part of a body whose force, moment, pressure, area and displacement are in the history.
typedef struct FemProbeDef {
  FemSelectDef select; // the first member
  char *name;
} FemProbeDef;

// Points along a straight line, evenly from end to end, that a body carries.
typedef struct FemLineDef {
  char *name;
  double from[3], to[3]; // [m], in the scene, at rest
  int points;
  FemScenePlace place;
} FemLineDef;

// What a part of a body is made of.
typedef struct FemPartDef {
  FemMaterial material; // the first member
  FemSelectDef select;  // of tetrahedra: in a group, or with their middle inside
} FemPartDef;

typedef struct FemBodyDef {
  char *name;
  char *mesh_path;    // as written, relative to the scene file; NULL: a box
  double box_size[3]; // [m]
  int box_cells[3];
  FemMeshOptions mesh_options;
  FemScenePlace mesh_place;
  FemPlacement placement;
  FemMaterial material; // of what no part has; E 0: of nothing
  FemPartDef *parts;    //                                    (part_count)
  int part_count;
  FemElementKind element;
  bool self_contact;       // its parts may touch each other
  double velocity[3];      // initial [m/s]
  double spin[3];          // initial angular velocity about the centre of mass [rad/s]
  FemConstraintDef *fixed; //                                 (fixed_count)
  int fixed_count;
  FemConstraintDef *driven; //                                (driven_count)
  int driven_count;
  FemLoadDef *loads; //                                       (load_count)
  int load_count;
  FemInnerDef *inner; //                                      (inner_count)
  int inner_count;
  FemProbeDef *probes; //                                     (probe_count)
  int probe_count;
  FemLineDef *lines; //                                       (line_count)
  int line_count;
  FemScenePlace place;
} FemBodyDef;

typedef enum FemObstacleKind {
  FEM_OBSTACLE_MESH,
  FEM_OBSTACLE_HALFSPACE,
  FEM_OBSTACLE_BALL,
  FEM_OBSTACLE_BOX,
  FEM_OBSTACLE_CYLINDER,
} FemObstacleKind;

// An obstacle carries no unknowns; it stands still or moves.
typedef struct FemObstacleDef {
  char *name;
  FemObstacleKind kind;
  double point[3];   // on a half-space's surface; the centre of a ball, a box, a cylinder
  double normal[3];  // out of a half-space
  double radius;     // of a ball, a cylinder [m]
  double size[3];    // edges of a box [m]
  FemPlacement turn; // of a box about its centre; only axis and angle
  double axis[3];    // of a cylinder
  double length;     // along it [m]
  char *mesh_path;   // else a mesh, or a box as in FemBodyDef
  double box_size[3];
  int box_cells[3];
  FemMeshOptions mesh_options;
  FemScenePlace mesh_place;
  FemPlacement placement;
  FemConstraintDef motion; // selection ignored; a half-space must not spin
  FemScenePlace place;
} FemObstacleDef;

// A pressure law; linear, by a stiffness, where the scene gives none.
typedef struct FemContactLawDef {
  ContactLaw law;
  FemScenePlace place;
} FemContactLawDef;

// Coulomb friction.
typedef struct FemFrictionDef {
  double coefficient; // μ
  double at_rest;     // of what sticks; 0: μ
  double length;      // slid until the one has become the other [m]; 0: chosen
} FemFrictionDef;

// What holds between two in place of what holds between any two.
typedef struct FemContactPairDef {
  char *names[2];          // of bodies or obstacles
  double stiffness;        // κ; 0: as without
  FemFrictionDef friction; // coefficient NAN: as without
  FemContactLawDef law;    // linear: as without, or by `stiffness`
  FemScenePlace place;
} FemContactPairDef;

typedef struct FemContactDef {
  bool is_on;
  double stiffness;     // κ; 0: chosen (fem/model/compliance/compliance.h, or the softest body's E)
  FemContactLawDef law; // of the potential `field`, in place of κ
  ContactPotential potential;
  FemContactPairDef *pairs; //                                (pair_count)
  int pair_count;
  char *overlap;               // name of the overlap model
  FemScenePlace overlap_place; // line 0: the command line has it
  double margin;               // [m]; 0: chosen
  int smooth; // how often the edges of curved surfaces are halved for contact; 0: facets as they are; −1:
              // chosen
  double crease;                        // edges between faces that make more stay sharp [°]
  FemFrictionDef friction;              // between any two; coefficient 0: none
  double viscosity;                     // η [Pa s]; 0: none
  bool rest_is_on;                      // bodies at rest are left out
  double rest_speed, rest_acceleration; // below them a body is calm [m/s], [m/s²]; 0: chosen
  double rest_time;                     // so long, and it is at rest [s]; 0: chosen
} FemContactDef;

typedef enum FemHistoryRows { FEM_HISTORY_NONE, FEM_HISTORY_FRAMES, FEM_HISTORY_STEPS } FemHistoryRows;

typedef struct FemSceneDef {
  char *path; // of the scene file
  char *title;
  FemBodyDef *bodies; // (body_count)
  int body_count;
  FemObstacleDef *obstacles; // (obstacle_count)
  int obstacle_count;
  // effects
  bool has_gravity;
  double gravity[3];        // [m/s²]
  double stiffness_damping; // β [s] of every body whose material gives none
  FemContactDef contact;
  char *start; // folder of the run from whose end state this one starts, from the scene file; NULL: rest
  bool starts_anyhow; // though that run has failed or was interrupted
  // time
  double end;                              // [s]
  bool is_static;                          // equilibria only: time is the parameter of loads and motions
  double tolerance;                        // error per step, as a share of the smallest body's size
  double velocity_tolerance;               // [m/s]; 0: chosen
  double max_step, initial_step, min_step; // [s]; 0: chosen
  int max_order;                           // 1 or 2
  // solver
  FemSolverKind solver;
  double solver_tolerance; // of iterative solvers, relative; 0: as the solver says
  int threads;             // 0: all
  // output
  int frames;                // written at i · end/frames, i = 0 … frames
  int checkpoint_frames;     // between two checkpoints; 0: none; −1: chosen
  double checkpoint_seconds; // wall time between two that are written [s]
  bool write_vtu;
  bool write_pieces;      // of each rank one
  FemHistoryRows history; // rows of history.csv
  char *status_reference; // the overlap model that elements' status is held against; NULL: none
} FemSceneDef;

// Frees everything that the scene owns and zeroes it.
// The place in words: "scene.yaml:3:7", "scene.yaml with --set", or "scene" of one that has no file.
typedef struct FemSceneWhere {
  char text[512];
} FemSceneWhere;
FemSceneWhere fem_scene_where(const FemSceneDef *scene, const FemScenePlace *place);

void fem_scene_destroy(FemSceneDef *scene);

// When frame 0 … frames is due [s].
double fem_scene_frame_time(const FemSceneDef *scene, int frame);

// What a body is made of: its own material, then those of its parts.
const FemMaterial *fem_scene_material(const FemBodyDef *body, int index);
// Whether some body is made of such a material.
bool fem_scene_has_material(const FemSceneDef *scene, bool (*is_such)(const FemMaterial *material));

// Obstacles without elements.
int fem_scene_shape_count(const FemSceneDef *scene);

// The largest μ between any two, at rest or not; 0: nothing rubs.
double fem_scene_most_friction(const FemContactDef *contact);
// Whether friction at rest is larger than that of what slides somewhere.
bool fem_scene_has_breakaway(const FemContactDef *contact);
// Whether a body rubs on itself, by the scene's μ or by its own of `contact.pairs`.
bool fem_scene_has_self_friction(const FemSceneDef *scene);

#endif
