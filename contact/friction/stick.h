// SPDX-License-Identifier: GPL-3.0-or-later
// Coulomb friction by elastic stick: a spring in the tangent plane, cut at μN. Its stretch is a vector per
// vertex of one of the two bodies, the slave, kept in that body's rest frame (stick_history.h). A force is a
// function of positions and of the last accepted state: nothing creeps, and a step that is refused leaves no
// trace.
//
// Of a pair (i of A, j of B) it needs the force F_ij on A, the area A_ij that it covers and the weights λ at
// the centroid x̄ of the overlap of the mesh vertices of either side. With xⁿ of the last accepted state:
//
//   gap       Δ_ij = Σ_b λ_b x_bⁿ − Σ_a λ_a x_aⁿ     the way of A against B since then: both are at x̄ now
//
// For a vertex a of the slave A, w = λ_a |F_ij|, W = Σ w over its pairs:
//
//   Δ_a = Σ w Δ_ij / W,   F_a = Σ w F_i / W  (deformation gradients),   f_a = Σ λ_a F_ij,   N_a = |f_a|,
//   n_a = f_a / N_a,      k_a = c_t Σ λ_a A_ij,      P = 1 − n nᵀ
//   carried   S_a' = F_a S_a √(E_a / (½ k_a |F_a S_a|²)),  E_a what it stored at the last accepted state
//   trial     s = P (S_a' + Δ_a),   T_a = −k_a s;   where k_a |s| > μ N_a by radial return
//             s ← s μN_a/(k_a |s|)     (Simo and Hughes, Computational Inelasticity, 1.4:
//             a slider and a spring)
//   force     Σ_a (w/W) T_a on the pair, at x̄: by λ on A's vertices, its opposite on B's
//   matrix    D_a ⊗ ω ωᵀ,  ω = Σ (w/W)(λ_A, −λ_B);   D = k P in stick, μN/|s_trial| (P − ŝŝᵀ) in slip
//   weakens   where μ_s > μ, the limit is L = (μ + (μ_s − μ)(1 − w)) N, and w grows by 1/D for each length
//             that is cut off, up to 1 (slip weakening: Ida 1972, J. Geophys. Res. 77; Palmer and Rice 1973):
//             s ← s L(w)/(k_a |s|) with w of the cut itself. D is the law's, but no less than
//             2 (μ_s − μ) N/k_a, so that the force falls no faster than the spring rises: it is one function
//             of positions, without a jump. w ← 0 where the vertex sticks again
//   accepted  S_a ← F_a⁻¹ s;   dissipated += mean of μN_a at the onset of slip and now · length cut off. Both
//             s from S_a' to s_trial and μN_a from then to now are taken as linear; the onset is where
//             k_a |s| exceeds μN_a from there on
//   slid      G_a ← F_a⁻¹ (F_a G_a + s_trial − s), the way of the slave against the other; lengths add up
//
// Δ is zero to rounding in any common rigid motion and telescopes; only increments are averaged. Force and
// torque balance pair by pair. The matrix is positive semidefinite; the derivatives of N, n and the weights
// are left out of it. An area that grows or shrinks while it sticks does no work: the spring keeps its
// energy, not its stretch, so no energy is gained, and an area that grows and shrinks again leaves the spring
// as it was. What turning into another tangent plane and lift-off take of ½ k_a s² is counted as dissipated,
// so that the energies add up.
//
// Either side may be the slave, or, in self-contact, both with half of k and of μ each (weights ½, ½).
#ifndef TETLAP_CONTACT_FRICTION_STICK_H
#define TETLAP_CONTACT_FRICTION_STICK_H

#include <stdbool.h>

#include "contact/friction/stick_history.h"
#include "contact/stiffness.h"
#include "contact/surface/stars.h"

// Fewer pairs take less time than to wake other threads.
enum { CONTACT_STICK_MANY = 2048 };

// A pair of the normal law, as friction needs it; ordered by interface.
typedef struct ContactStickPair {
  int interface;
  int tets[2];         // [1] −1: an obstacle without elements
  double lambda[2][4]; // weights at x̄ of the tetrahedra's vertices; their sum is 1
  double force[3];     // F_ij on side 0 [N]
  double area;         // A_ij [m²]
  double before[3];    // an obstacle's point at x̄, at the last accepted state [m]; bodies have none
} ContactStickPair;

// An interface's law.
typedef struct ContactStickLaw {
  double friction;  // μ, of what slides
  double at_rest;   // μ_s of what sticks; less than μ: as that
  double length;    // D, over which the one becomes the other [m]; 0: chosen
  double stiffness; // c_t [Pa/m]
  double weight[2]; // of each side as slave: 1 and 0, 0 and 1, or ½ and ½
} ContactStickLaw;

// A slave's vertex at the positions of the last evaluation.
typedef struct ContactStickNode {
  int interface, vertex;
  int begin, end;        // of its touches
  double weight;         // W [N]
  double force[3];       // f_a, then T_a [N]
  double normal[3];      // n
  double deformation[9]; // F_a
  double stiffness;      // k_a [N/m]
  double limit;          // μ N_a, or what is left of μ_s N_a [N]
  double excess;         // (μ_s − μ) N_a [N]
  double weak, over;     // w, D [m]
  double gap[3];         // Δ_a, then s_trial [m]
  double trial;          // |s_trial| [m]
  double stretch[3];     // s [m]
  double slid[3];        // F_a G_a, since it was last touched [m]
  double way;            // Σ |s_trial − s| so far [m]
  double work;           // dissipated at it so far [J]
  double kept, spent;    // stored at the last accepted state, dissipated since then [J]
  bool slips;
  bool advances; // the way since the last accepted state goes along s_trial
} ContactStickNode;

// A corner of a pair that is a slave: which node, with which share of it.
typedef struct ContactStickTouch {
  int node;     // −1: nothing presses it
  double share; // w, then w/W
} ContactStickTouch;

// How a slave's tetrahedron has moved at a pair.
typedef struct ContactStickMotion {
  double gap[3];         // Δ since the last accepted state [m]
  double deformation[9]; // F
} ContactStickMotion;

// The last accepted state.
typedef struct ContactStickLast {
  const double *positions; // xⁿ [m], borrowed                      (vertex_count, 3)
  ContactStickHistory history;
} ContactStickLast;

typedef struct ContactStick {
  int vertex_count, interface_count;
  const double *rest;        // borrowed                                (vertex_count, 3)
  const int (*tets)[4];      // borrowed
  const ContactStars *stars; // what carries the vertices; borrowed. NULL, as created: they are as given
  ContactStickLaw *laws;     //                                         (interface_count)
  // The last evaluation.
  ContactStickPair *pairs; // as given, for the caller to fill      (pair_count)
  int pair_count;
  ContactStickNode *nodes; //                                       (node_count)
  int node_count;
  ContactStickTouch (*touches)[2][4]; //                            (pair_count)
  int *order;                         // numbers of touches (8 a pair), node by node
  ContactStickMotion (*motions)[2];   // of sides that are slaves       (pair_count)
  double (*pulls)[3];                 // on side 0 of each pair [N]               (pair_count)
  double (*forces)[3];  // on side 0 of each interface [N]; of one at rest as it was   (interface_count)
  double (*areas)[2];   // that stick and that slide [m²]; likewise                    (interface_count)
  bool *has_left;       // each entry of the history: it has no node   (entry_count)
  double stored, spent; // ½ Σ k s², and dissipated since the last accepted state [J]
  int slip_count;
  // Scratch memory.
  int *node_of_vertex; // −1 between calls                          (vertex_count)
  int *place;          // 0 between calls                           (vertex_count)
  int *clique;
  double *shares, *outer;
  size_t pair_capacity, node_capacity, touch_capacity, order_capacity, pull_capacity, motion_capacity;
  size_t clique_capacity, share_capacity, outer_capacity, left_capacity;
} ContactStick;

// The laws are copied. STATUS_INPUT: a μ, stiffness or weight that makes no sense. A zeroed stick, and one
// whose creation failed, can be destroyed.
Status contact_stick_create(ContactStick *stick, int vertex_count, const double *rest, const int (*tets)[4],
                            int interface_count, const ContactStickLaw *laws);
void contact_stick_destroy(ContactStick *stick);
size_t contact_stick_bytes(const ContactStick *stick); // on the heap

// Room for so many pairs in stick->pairs, which the caller fills before it evaluates.
Status contact_stick_reserve(ContactStick *stick, int pair_count);

// The friction at these positions (vertex_count, 3), from stick->pairs of which there are pair_count.
// `is_resting` (interface_count; NULL: none) marks interfaces at rest, which have no pairs and keep their
// forces and areas.
Status contact_stick_eval(ContactStick *stick, const ContactStickLast *last, int pair_count,
                          const double *positions, const bool *is_resting);

// Whether it counts as sliding, not sticking: its pull is 0.98 of its limit or more.
bool contact_stick_slides(const ContactStickNode *node);

// Of the last evaluation.
// By the vertices as given: (vertex_count, 3) without stars.
void contact_stick_add_force(const ContactStick *stick, double *force);
// That of one interface.
void contact_stick_add_force_of(const ContactStick *stick, int interface, double *force);
// Adds −∂f/∂x, without what comes from N, n and the weights.
Status contact_stick_add_stiffness(ContactStick *stick, const ContactStiffnessSink *sink);
// Visits the vertices that each node couples.
Status contact_stick_couple(ContactStick *stick, void *visitor,
                            Status (*visit)(void *visitor, int count, const int *vertices));

// What history is once the last evaluation, from that last accepted state, is accepted in turn: how many
// numbers, and these.
size_t contact_stick_next_count(const ContactStick *stick, const ContactStickHistory *history,
                                const bool *is_resting);
void contact_stick_advance(const ContactStick *stick, const ContactStickHistory *history,
                           const bool *is_resting, double *values);

#endif
