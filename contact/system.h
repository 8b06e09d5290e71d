// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of many bodies by a penalty on overlap volumes: positions in; energy, forces, stiffness out. It
// knows no mechanics: bodies are ranges of vertices and tetrahedra, obstacles are bodies without unknowns or
// shapes without elements.
//
//     candidates (broad.h, kept while motion < margin/2)
//         │ gather (n, 2, 4, 3)
//         ▼
//     overlap model ──► V_ij, ∇V_ij ──► W_i = Σ_j V_ij, W_a = ¼ Σ_{i∋a} W_i ──► pressure p_ij ──► −Σ p_ij
//     ∇V_ij
//
// W is kept per interface (unordered pair of bodies), so a third body does not change the pressure between
// two. A body that meets itself is an interface of its own, with the same potential: W_i is what other
// elements of the body cover of i, each pair counts once for either of its elements, and the leading ½ is
// that between two bodies; two halves of a body that are not connected press each other as two bodies would.
// The overlap models see bodies in general position (contact/layout.h), so that planes of regular meshes do
// not coincide. Evaluation changes no list: an integrator may try a step, reject it and try again.
#ifndef TETLAP_CONTACT_SYSTEM_H
#define TETLAP_CONTACT_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "overlap/model.h"

typedef struct ContactBody {
  const char *name; // borrowed
  int vertex_begin, vertex_end;
  int tet_begin, tet_end;
  bool is_obstacle;  // carries no unknowns: static or driven
  bool meets_itself; // parts of it may touch each other (contact/self.h)
} ContactBody;

// Obstacles without elements.
typedef enum ContactShapeKind {
  CONTACT_SHAPE_HALFSPACE, // { x : normal·(x − point) ≤ 0 }
  CONTACT_SHAPE_BALL,      // { x : |x − point| ≤ radius }
  CONTACT_SHAPE_CONVEX,    // `convex` about `point`, along `axes`
} ContactShapeKind;

// `point` moves by point(t) = point + t velocity, or as `move` says, which returns position and velocity at a
// time of what rests at `rest`, by a rigid motion; a half-space must not turn. `move` may be called from
// several threads.
typedef struct ContactShape {
  const char *name; // borrowed
  ContactShapeKind kind;
  double point[3];                    // [m]
  double normal[3];                   // of a half-space, unit length
  double radius;                      // of a ball [m]
  const struct ContactConvex *convex; // of that kind; borrowed
  double axes[3][3];                  // its own axes at rest, in space, orthonormal and right-handed
  double velocity[3];                 // [m/s]
  const void *motion;                 // handed to `move`; borrowed
  void (*move)(const void *motion, double time, const double rest[3], double position[3],
               double velocity[3]); // NULL: by `velocity`
} ContactShape;

// The potentials, by the name a scene uses. W_i: what the other body covers of element i [m³]; V_i its rest
// volume; W_a, V_a their shares of vertex a (a quarter of each adjacent element). κ: stiffness.
// Between two bodies each side's sum gets a leading ½; against an obstacle only the body's side counts,
// without ½.
typedef enum ContactPotential {
  CONTACT_POTENTIAL_NODAL,   // U = Σ_a ½ κ W_a²/V_a, κ [Pa]: even pressure, no false friction
  CONTACT_POTENTIAL_ELEMENT, // U = Σ_i ½ κ W_i²/V_i, κ [Pa]
  CONTACT_POTENTIAL_PAIR,    // U = Σ_ij ½ κ V_ij²/V_ref, V_ref the smaller of the two rest volumes (a
                             // half-space: V_i), κ [Pa]
  CONTACT_POTENTIAL_LINEAR,  // U = κ Σ_ij V_ij, κ [Pa]: constant pressure, the force jumps at touch
  CONTACT_POTENTIAL_BODY,    // U = ½ κ (Σ_ij V_ij)² a pair of bodies, κ [Pa/m³]
} ContactPotential;

enum { CONTACT_POTENTIAL_COUNT = 5 };
const char *contact_potential_name(ContactPotential potential); // "nodal", …
const char *contact_potential_help(ContactPotential potential); // one line

typedef struct ContactSystemDef {
  int vertex_count;
  const double *rest;   // rest positions [m], borrowed                    (vertex_count, 3)
  const int (*tets)[4]; // borrowed; all bodies one after another          (tet_count)
  int tet_count;
  const ContactBody *bodies; // borrowed                                    (body_count)
  int body_count;
  const ContactShape *shapes; // borrowed                           (shape_count)
  int shape_count;
  ContactPotential potential;
  double stiffness;      // κ
  double margin;         // skin margin while bodies are near [m]; 0: half the shortest mean edge of a body
  bool use_full_hessian; // include p ∇²V, of `clip` if the model has none; else Gauss–Newton
  const OverlapModel *model; // borrowed
} ContactSystemDef;

// Where the stiffness ∂²U/∂x² goes. Each call adds a dense symmetric part over a short list of distinct
// vertices; those of obstacles carry no unknowns and are left out.
typedef struct ContactStiffnessSink {
  void *self;
  // S += scale · w wᵀ, w (count, 3).
  void (*add_outer)(void *self, int count, const int *vertices, const double *w, double scale);
  // S += matrix, (3 count, 3 count), symmetric.
  void (*add_dense)(void *self, int count, const int *vertices, const double *matrix);
} ContactStiffnessSink;

// The force between two bodies, or a body and a shape (b = body_count + number of the shape). A body with
// itself (a = b): the force on the element of lower number of each pair; in all it is none.
typedef struct ContactInterface {
  int a, b;         // a < b, or a = b
  double force[3];  // on a [N]; the opposite acts on b
  double volume;    // Σ V_ij [m³]
  int active_count; // pairs with V > 0
} ContactInterface;

// Pairs of meshes by how they were answered.
typedef struct ContactPairCounts {
  long long tried;     // given to the overlap model
  long long enclosed;  // flagged OVERLAP_ENCLOSED
  long long fallbacks; // flagged FALLBACK
  long long by_net;    // flagged NET
  long long blended;   // flagged BLENDED
  long long beyond;    // flagged BEYOND
} ContactPairCounts;

// What struck, since creation; for summary and warnings.
typedef struct ContactCounters {
  long long evaluations; // of the whole system
  ContactPairCounts pairs;
  long long searches;                 // broad phases
  long long resting;                  // pairs within a body left out because they overlap at rest
  long long left_at_rest;             // candidate pairs that evaluations left out (contact_system_hold)
  long long beyond_margin;            // evaluations refused because a vertex left the margin
  double broad_s, overlap_s, force_s; // wall time by phase [s]
} ContactCounters;

struct ContactEvaluation;
struct ContactLayout;
struct ContactStatus;
typedef struct ContactSystem ContactSystem; // opaque: lists, scratch memory and the last evaluation

Status contact_system_create(ContactSystem **system, const ContactSystemDef *def);
void contact_system_destroy(ContactSystem *system);

// After an accepted step (and once before the first evaluation): rebuilds the candidate lists where the
// motion asks for it and chooses the pairs whose onset is watched. `velocities` (vertex, 3) and `step` [s]
// (the next step's expected length) size the margin: as wide as two bodies are apart while no pair is near,
// at most def.margin otherwise, so that nothing passes through anything within one step. `*has_changed` (may
// be NULL): the list of candidates differs from the one before.
Status contact_system_update(ContactSystem *system, double time, const double *positions,
                             const double *velocities, double step, bool *has_changed);

// The next update searches anew: what a run does at its checkpoints, so that nothing depends on older ones.
void contact_system_forget(ContactSystem *system);

// Who is held where it is from now on (bodies, then shapes), NULL: nobody. Two that are held keep the forces,
// covered volumes and energy that they have at these positions (those of the interfaces and of every vertex
// and element stay in the results), and are neither searched nor evaluated; they must not move until the next
// call. All is searched and evaluated anew, and as by an update the onsets to watch are chosen.
Status contact_system_hold(ContactSystem *system, double time, const double *positions,
                           const double *velocities, double step, const bool *is_held);
bool contact_system_is_resting(const ContactSystem *system, int interface);
// Whether any elements of an interface are within the margin of each other, by the last search or by that
// before it was held.
bool contact_system_is_near(const ContactSystem *system, int interface);

// Energy U [J] and, added to `force` (vertex_count, 3) unless NULL, −∂U/∂x [N].
// STATUS_RETRY: a vertex moved beyond the margin since the last update. The result of the last positions is
// kept.
Status contact_system_eval(ContactSystem *system, double time, const double *positions, double *energy,
                           double *force);

// Adds ∂²U/∂x² at those positions to the sink (evaluates first if they are not the last ones).
Status contact_system_stiffness(ContactSystem *system, double time, const double *positions,
                                const ContactStiffnessSink *sink);

// Calls `visit` for every clique of vertices that the stiffness may couple at the last evaluated positions,
// pairs that are apart by less than `reach` [m] included, so that a matrix pattern can be laid out ahead.
Status contact_system_couple(ContactSystem *system, double reach, void *visitor,
                             Status (*visit)(void *visitor, int count, const int *vertices));

// The smallest separation of the pairs watched since the last update [m]: negative once one of them overlaps;
// at most, and without any pair, +margin. Its root is the onset of a new contact; contact/onset.h says which
// pairs are watched (after a root, the next update leaves that pair out). Separation of two tetrahedra is the
// largest over the 44 separating axes of their projections' distance (exactly the distance for face
// contacts).
Status contact_system_gap(ContactSystem *system, double time, const double *positions, double *gap);

// Of the last evaluation. Pointers are the system's, valid until the next call.
const ContactInterface *contact_system_interfaces(const ContactSystem *system, int *count);
const double *contact_system_forces(const ContactSystem *system); // per vertex [N] (vertex_count, 3)
const double *
contact_system_covered(const ContactSystem *system); // Σ over interfaces of W_i [m³]    (tet_count)
int contact_system_active_count(const ContactSystem *system); // pairs with V > 0, those at rest included
// The pairs of the last evaluation with V > 0, as handed to the model (in general position); for audits and
// capture. Owned by the caller (memory_free): pairs (count, 2, 4, 3), tets (count, 2).
Status contact_system_active_pairs(const ContactSystem *system, int *count, double **pairs, int **tets);
// The power that moving shapes put in at the last evaluation [W]: ∂U/∂t at fixed positions.
double contact_system_shape_power(const ContactSystem *system);
const ContactCounters *contact_system_counters(const ContactSystem *system);
// What it holds on the heap [bytes], the overlap model left out.
size_t contact_system_bytes(const ContactSystem *system);
// What laws that build on the potential (friction.h) look at: contact/evaluation.h, contact/layout.h.
// `look` indexes the last evaluation's patches; the result is the system's, valid until the next evaluation.
Status contact_system_look(ContactSystem *system, const struct ContactEvaluation **evaluation);
const struct ContactLayout *contact_system_layout(const ContactSystem *system);
// Σ_a coefficient_a ∇W_a ∇W_aᵀ of the last evaluation to the sink; coefficients by its patches' nodes.
Status contact_system_add_nodes(ContactSystem *system, const double *coefficients,
                                const ContactStiffnessSink *sink);

// Audit: the same configuration with another overlap model: relative differences against `reference`.
// Half-spaces are left out: no model takes part in them. Changes nothing but scratch memory.
typedef struct ContactAudit {
  double volume_error;   // Σ|ΔV| / ΣV over the union of pairs
  double gradient_error; // Σ|Δ∇V| / Σ|∇V|, lengths of all 24 components
  double force_error;    // ‖Δf‖₂/‖f‖₂ of the nodal forces
  double total_error;    // ‖ΔF‖₂/‖F‖₂ of the total forces of all interfaces
  int pair_count;
} ContactAudit;
Status contact_system_audit(ContactSystem *system, double time, const double *positions,
                            const OverlapModel *candidate, const OverlapModel *reference,
                            ContactAudit *audit);

// Which elements overlap, by the system's own model and by `reference` (contact/status.h), at positions that
// the last update covers. The result is the system's, valid until the next call.
Status contact_system_status(ContactSystem *system, double time, const double *positions,
                             const OverlapModel *reference, const struct ContactStatus **status);

#endif
