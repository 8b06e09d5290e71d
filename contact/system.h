// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of many bodies by a penalty on overlap volumes: positions in; energy, forces, stiffness out. It
// knows no mechanics: bodies are ranges of vertices and tetrahedra, obstacles are bodies without unknowns or
// shapes without elements.
//
// clang-format off
//     candidates (contact/search/candidates.h: kept until two parties have come nearer by their margin)
//         │ gather (n, 2, 4, 3)
//         ▼
//     overlap model ──► V_ij, x̄_ij ──► forces by the depth field (contact/pressure/field.h)
//                   or  V_ij, ∇V_ij ──► forces by volumes alone (contact/volume/volume.h)
// clang-format on
//
// An interface is an unordered pair of bodies, or a body and itself. W_i, the volume that is covered of an
// element i, is kept per interface, so a third body does not change the pressure between two. In a body that
// meets itself, W_i is what other elements of the body cover of i. Each pair counts once for either of its
// elements, and both sides have the weight ½, as between two bodies. So two halves of a body that are not
// connected press each other as two bodies would.
//
// The overlap models see bodies in general position (contact/search/layout.h), so that planes of regular
// meshes do not coincide. Evaluation changes no list: an integrator may try a step, reject it and try again.
#ifndef TETLAP_CONTACT_SYSTEM_H
#define TETLAP_CONTACT_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "contact/audit.h"
#include "contact/def.h"
#include "contact/evaluation.h"
#include "contact/pressure/trace.h"
#include "contact/status.h"
#include "contact/stiffness.h"
#include "contact/surface/stars.h"

// Counts and times since creation, for summary and warnings.
typedef struct ContactCounters {
  long long evaluations; // of the whole system
  ContactPairCounts pairs;
  long long searches;                 // broad phases
  long long resting;                  // pairs within a body left out because they overlap at rest
  long long left_at_rest;             // candidate pairs that evaluations left out (contact_system_hold)
  long long beyond_margin;            // evaluations refused because a vertex left the margin
  double update_s;                    // wall time of contact_system_update, searches left out [s]
  double broad_s, overlap_s, force_s; // of searches, and of evaluations by phase [s]
} ContactCounters;

typedef struct ContactSystem ContactSystem; // opaque: lists, scratch memory and one evaluation

Status contact_system_create(ContactSystem **system, const ContactSystemDef *def);
// Takes the system back to what it was after its creation: lists, counters and what is at rest are forgotten.
void contact_system_start_over(ContactSystem *system);
void contact_system_destroy(ContactSystem *system);

// Rebuilds the candidate lists where the motion asks for it: to be called after each accepted step, and once
// before the first evaluation. `velocities` (vertex_count, 3) [m/s] and `step`, the expected length of the
// next one [s], size the margin. It is as wide as two bodies are apart while no pair is near, and at most
// def.margin otherwise, so that nothing passes through anything within one step.
Status contact_system_update(ContactSystem *system, double time, const double *positions,
                             const double *velocities, double step);

// Keeps a copy of the list of candidates, if the last update made it. An update that finds everything the
// same again, to the last bit, takes that copy and does not search. One list is kept at a time.
Status contact_system_keep(ContactSystem *system);

// At the positions of an update all elements nearer to each other than this are candidates [m].
double contact_system_least_reach(const ContactSystem *system);

// How long the next step may be [s]. At the speeds of the last update no vertex moves beyond the margin
// within it.
double contact_system_longest_step(const ContactSystem *system);

// Makes the next update search anew. A run does so where it begins and at its checkpoints: what follows does
// not depend on earlier lists.
void contact_system_forget(ContactSystem *system);

// Sets which parties (bodies, then shapes) are held in place from now on; NULL: none. Held parties must not
// move until the next call. The interface of two held parties is at rest: it is neither searched nor
// evaluated, and its forces, covered volumes and energy at these positions stay in the results. This call
// searches and evaluates everything anew.
Status contact_system_hold(ContactSystem *system, double time, const double *positions,
                           const double *velocities, double step, const bool *is_held);
bool contact_system_is_resting(const ContactSystem *system, int interface);
// Whether any two elements of an interface are within the margin of each other, by the last search; of an
// interface at rest, by the search before it was held.
bool contact_system_is_near(const ContactSystem *system, int interface);

// Contact at a time [s] and positions (vertex_count, 3) [m]. `version` is a number for these two. The last
// evaluation is returned again where it has the same number; 0: always evaluate. The evaluation belongs to
// the system and is valid until the next call and until contact_system_hold.
// STATUS_RETRY: a vertex moved beyond the margin since the last update; the evaluation before is kept.
Status contact_evaluate(ContactSystem *system, long long version, double time, const double *positions,
                        const ContactEvaluation **evaluation);

// All below that takes an evaluation takes one of this system.

// Adds −∂U/∂x [N] to `force` (vertex_count, 3), that of interfaces at rest left out.
void contact_system_add_force(const ContactSystem *system, const ContactEvaluation *evaluation,
                              double *force);
// Adds the forces of interfaces at rest [N].
void contact_system_add_resting(const ContactSystem *system, double *force);

// Adds ∂²U/∂x² to the sink.
Status contact_system_stiffness(ContactSystem *system, const ContactEvaluation *evaluation,
                                const ContactStiffnessSink *sink);

// The areas of contact (contact/pressure/patch/area.h), those at rest included [m²]. (interface_count)
void contact_system_areas(const ContactSystem *system, const ContactEvaluation *evaluation, double *areas);

// Adds −∂f/∂x of an interface, or CONTACT_ALL_INTERFACES, exactly: by the overlap model's own derivatives,
// which it must have (overlap/slopes.h), with a law by differences (contact/pressure/field.h). The matrices
// are not symmetric. With the potential `field` only; laws only with a model that clips.
Status contact_system_turn(ContactSystem *system, const ContactEvaluation *evaluation, int interface,
                           const ContactStiffnessSink *sink);
// ∂V/∂x and ∂x̄/∂x of the evaluation's pairs of meshes (mesh_pair_count, 4, 24), by the overlap model, or by
// clipping where it has none. They are found once and belong to the system. With the potential `field` only.
Status contact_system_slopes(ContactSystem *system, const ContactEvaluation *evaluation,
                             const double **slopes);

// Adds to `answers` (mesh_pair_count, 4) the derivatives of λ · f by V and x̄ of the pairs of meshes. f are
// the forces of an interface, or CONTACT_ALL_INTERFACES, and λ = weight · forces (vertex_count, 3). Only with
// a model that has slopes.
Status contact_system_pull(ContactSystem *system, const ContactEvaluation *evaluation, int interface,
                           const double *forces, double weight, double *answers);

// Forces (added to vertex_count, 3) [N] and energy [J] of one interface that is not at rest.
void contact_system_add_force_of(const ContactSystem *system, const ContactEvaluation *evaluation,
                                 int interface, double *force);
double contact_system_energy_of(const ContactEvaluation *evaluation, int interface);

// Calls `visit` for every clique of vertices that the stiffness may couple. Pairs that are apart by less than
// `reach` [m] are included, so that a matrix pattern can be laid out ahead; elements that are `coupled` are
// left out (contact/stiffness.h).
Status contact_system_couple(ContactSystem *system, const ContactEvaluation *evaluation, double reach,
                             ContactCoupled *coupled, void *visitor,
                             Status (*visit)(void *visitor, int count, const int *vertices));

// Pressure, depth and traction at the surface (contact/pressure/trace.h). Interfaces at rest are included,
// without their friction. `pulls`: friction on side 0 of each pair of the evaluation [N] (pair_count); NULL:
// none. With the potential `nodal` all are 0.
Status contact_system_trace(ContactSystem *system, const ContactEvaluation *evaluation,
                            const double (*pulls)[3], const ContactTraceResult *result);
// How far the vertices of the definition that are at a surface are from what they may touch
// (contact/search/gap.h) [m]. INFINITY: nothing is near, or what is near is at rest. With the potential
// `nodal` all are INFINITY.
void contact_system_gaps(ContactSystem *system, const ContactEvaluation *evaluation, double *gaps);

// The power that moving shapes put in [W]: ∂U/∂t at fixed positions.
double contact_system_shape_power(const ContactSystem *system, const ContactEvaluation *evaluation);
// For audits, the pairs of meshes with V > 0 as handed to the model (in general position): pairs (count, 2,
// 4, 3) [m] and tets (count, 2). Owned by the caller (memory_free).
Status contact_system_active_pairs(const ContactSystem *system, const ContactEvaluation *evaluation,
                                   int *count, double **pairs, int **tets);
// Likewise the pairs whose boxes meet, with V > 0 or not, at positions that the last update covers (else
// STATUS_RETRY). Changes nothing but scratch memory. `pairs` (count, 2, 4, 3) belongs to the system and is
// valid until the next call.
Status contact_system_near_pairs(ContactSystem *system, double time, const double *positions, int *count,
                                 const double **pairs);

// The number that the definition gives an element of the contact mesh (`origin`, contact/surface/stars.h).
int contact_system_origin(const ContactSystem *system, int tet);
const ContactCounters *contact_system_counters(const ContactSystem *system);
// The pair (2, 4, 3) [m] that the overlap model failed at in the last evaluation; NULL: it did not.
const double *contact_system_blamed(const ContactSystem *system);
// What the system holds on the heap, without the overlap model [bytes].
size_t contact_system_bytes(const ContactSystem *system);
// The bodies, interfaces and cells; the system's.
const ContactLayout *contact_system_layout(const ContactSystem *system);
// The next five convert between the vertices of the definition and those of the layout. They are the same
// unless elements are quadratic or smooth surfaces have points of their own: then the contact mesh has
// vertices of its own (contact/surface/stars.h). A law converts positions by `place`, velocities by `spread`,
// forces by contact_stars_push, stiffness by the sink that `sink` returns, and lists of vertices by
// `carriers`. Results belong to the system and are valid until the next call.
const double *contact_system_place(ContactSystem *system, const double *positions);
const double *contact_system_spread(ContactSystem *system, const double *velocities);
const ContactStars *contact_system_stars(const ContactSystem *system);
const ContactStiffnessSink *contact_system_sink(ContactSystem *system, const ContactStiffnessSink *sink);
void contact_system_carriers(ContactSystem *system, int *count, const int **vertices);

// Whether any two bodies can meet, or a body itself. If not, there are shapes alone, and no overlap model is
// asked.
bool contact_system_asks_model(const ContactSystem *system);

// Compares two overlap models at positions that the last update covers (else STATUS_RETRY): differences of
// `candidate` from `reference`. Shapes are left out, since no model takes part in them. Changes nothing but
// scratch memory.
Status contact_system_audit(ContactSystem *system, double time, const double *positions,
                            const OverlapModel *candidate, const OverlapModel *reference,
                            ContactAudit *audit);

// Which elements overlap by the system's own model and by `reference` (contact/status.h), at positions that
// the last update covers (else STATUS_RETRY). The result belongs to the system and is valid until the next
// call.
Status contact_system_status(ContactSystem *system, double time, const double *positions,
                             const OverlapModel *reference, const ContactStatus **status);

#endif
