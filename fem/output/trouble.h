// SPDX-License-Identifier: GPL-3.0-or-later
// Faults in a run that do not end it: inverted elements, elements wholly covered by another body, contact
// forces that pull, a gain of energy, bodies that passed through each other. Found in every accepted state,
// marked by element and vertex in the frames, counted in history.csv, summary.json and the run's last line.
#ifndef TETLAP_FEM_OUTPUT_TROUBLE_H
#define TETLAP_FEM_OUTPUT_TROUBLE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/files/record.h"
#include "fem/model/model.h"

// Marks of an element; bits.
enum {
  FEM_TROUBLE_MARK_INVERTED = 1 << 0, // det F ≤ 0
  FEM_TROUBLE_MARK_ENCLOSED = 1 << 1, // at least 99.9 % of its current volume lie in other bodies
};

typedef enum FemTroubleKind {
  FEM_TROUBLE_INVERTED, // an element
  FEM_TROUBLE_ENCLOSED, // an element: what is inside has no surface that contact could push out
  // A vertex of a body's surface that contact pulls outwards: f·n > ½ |f|, n the outward normal. Contact only
  // presses; a pull means that the nearest way out of the overlap leads deeper in, as in a body that was
  // pierced: an element there is half covered, at least. In a body of one element across a pull alone says
  // nothing, since its elements carry the pressure on one face to all their vertices. Forces below a
  // thousandth of the largest are not looked at.
  FEM_TROUBLE_WRONG_WAY,
  FEM_TROUBLE_ENERGY, // the audited energy rose by more than a run may gain (fem/time/audit.h)
  FEM_TROUBLE_PASSED, // an element left another body on the side opposite to where it came in
                      // (contact/passage/passage.h)
} FemTroubleKind;
enum { FEM_TROUBLE_KIND_COUNT = 5 };

// One state: how many elements or vertices, and the first of them; −1: none. Of energy: 1 or 0.
typedef struct FemTroubleState {
  int count[FEM_TROUBLE_KIND_COUNT];
  int first[FEM_TROUBLE_KIND_COUNT];
  int passed[2]; // the bodies, or a body and a shape (as in ContactInterface), that passed through each other
} FemTroubleState;

// A run.
typedef struct FemTrouble {
  struct {
    long long steps;   // accepted states that have it
    long long events;  // of them, those whose predecessor does not have it
    int most;          // elements or vertices in one state
    double first_time; // [s]
    int first;         // the first element or vertex
  } of[FEM_TROUBLE_KIND_COUNT];
  FemTroubleState last;
  int passed[2];    // as in FemTroubleState, of the first time
  int sliver_count; // elements with 6 V / (longest edge)³ < 1e-3 at rest (a regular one has 0.71)
  int worst_sliver;
  double worst_shape;   // that element's
  double smallest_step; // [s]; INFINITY: none yet
} FemTrouble;

// What finding trouble in a model needs.
typedef struct FemTroubleWatch {
  const FemModel *model; // borrowed
  int (*triangles)[3];   // surface of all bodies, outwards     (triangle_count); none without contact
  int triangle_count;
  double *normals;  // scratch: of vertices, by area         (vertex_count, 3)
  int *marks;       // of the last state                     (tet_count)
  int *is_wrongway; // likewise                              (vertex_count)
  // Of quadratic elements with the potential `field`: pressure leaves next to nothing there, and of either
  // sign.
  bool *is_corner; //                                        (vertex_count)
  bool *is_deep;   // of an element that is half covered     (vertex_count)
} FemTroubleWatch;

Status fem_trouble_watch_create(FemTroubleWatch *watch, const FemModel *model);
void fem_trouble_watch_destroy(FemTroubleWatch *watch); // also of a zeroed one

// Finds the trouble of a state: positions and contact forces (vertex_count, 3), det F and covered share of
// the rest volume (tet_count); `force` NULL: no contact.
void fem_trouble_find(FemTroubleWatch *watch, const double *positions, const double *force,
                      const double *det_F, const double *overlap, FemTroubleState *state);

FemTrouble fem_trouble_begin(const FemModel *model);
// Adds an accepted state. Returns whether it has a kind of trouble that the state before it has not.
bool fem_trouble_add(FemTrouble *trouble, double time, const FemTroubleState *state);

// What a kind of trouble is, and what to do against it; of inverted elements by the law of the first one.
const char *fem_trouble_what(FemTroubleKind kind);
const char *fem_trouble_advice(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind);
// When and where it began: "first at t = 0.1 s, vertex 12 of body 'ball'; 3 at once at most, in 7 steps".
void fem_trouble_place(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind, char *text,
                       size_t size);
// All three on one line: "what: place (advice)".
void fem_trouble_describe(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind, char *text,
                          size_t size);
// Why a step in which bodies pass is not accepted, and what to write instead, on one line. `found`: in the
// state that is refused; `stiffness`: the pair's [Pa/m], 0: it has a law.
void fem_trouble_describe_refusal(const FemTrouble *trouble, const FemModel *model,
                                  const FemTroubleState *found, double stiffness, char *text, size_t size);
void fem_trouble_record(const FemTrouble *trouble, Record *record);

#endif
