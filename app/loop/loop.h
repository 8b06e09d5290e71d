// SPDX-License-Identifier: GPL-3.0-or-later
// A run that another program steps: a scene opened, what it declares `external: true` set from outside, its
// state read, kept and restored. It is reached by the C API (include/tetlap/run.h) and the channel
// (app/loop/serve.h).
#ifndef TETLAP_APP_LOOP_LOOP_H
#define TETLAP_APP_LOOP_LOOP_H

#include "app/job/job.h"
#include "app/loop/diary.h"
#include "app/loop/groups.h"
#include "fem/output/forces.h"
#include "fem/run/session.h"

// Between two bodies, or a body and an obstacle, at the present time.
typedef struct AppLoopContact {
  const char *a, *b; // names, borrowed; the same: a body and itself
  double force[3];   // on a, friction and viscosity included; the opposite acts on b [N]
  double normal;     // its length without friction [N]
  double moment[3];  // of it about the origin [N m]
  double centre[3];  // of pressure [m]; NaN: nothing presses
  double area;       // of contact [m²]
  double pressure;   // force without friction over area [Pa]; 0: no area
  double slip;       // share of the area that slides; NaN: no friction, or no area
  double impulse[3]; // ∫ force dt since the run began, by the trapezoidal rule over its steps [N s]
  double volume;     // of overlap [m³]
} AppLoopContact;

typedef struct AppLoop {
  AppJob job;
  Record *origin; // what a state must have in common with it (app/job/origin.h), owned
  FemRunOptions options;
  FemRunResult result;
  FemRunSession *session;
  AppLoopGroups groups;
  AppLoopDiary diary; // what was set, and when
  FemForces forces;
  int contact_count;
  AppLoopContact *contacts; // at the present time                               (contact_count)
  double (*moments)[3];     // scratch                                           (contact_count)
  double forces_time;       // of what the impulses hold [s]
  long long readings;       // of contacts, so far: as long as it is the same, nothing has moved
  long long version_read;   // of the state that they are of; 0: none
  bool has_vertex_forces;   // `forces` has those of vertices at the present time
  bool has_areas;           // so have `contacts`
  // After every step, at its state; contacts have areas once app_loop_read_areas is called. A Status other
  // than OK ends the advance with it. NULL: none.
  Status (*on_step)(void *self, struct AppLoop *loop);
  void *on_step_self;
} AppLoop;

typedef struct AppLoopOptions {
  AppJobOptions job;
  const char *overlap;               // in place of the scene's; NULL: that
  const volatile sig_atomic_t *stop; // ends an advance with STATUS_INTERRUPTED; NULL: nothing does
} AppLoopOptions;

// Opens the scene at its first state. After a failure there is nothing to close.
Status app_loop_open(AppLoop *loop, const AppLoopOptions *options);
void app_loop_close(AppLoop *loop);

double app_loop_time(const AppLoop *loop); // [s]
// Reads the contacts at the present state, which has been evaluated anew without a step.
Status app_loop_read(AppLoop *loop);
// Of contacts that have been read, areas and pressures: surfaces are clipped for them. An advance ends so.
Status app_loop_read_areas(AppLoop *loop);
const FemState *app_loop_state(const AppLoop *loop);

// Steps to `until` [s]; to the time itself: nothing. Fails as fem_run_session_advance.
Status app_loop_advance(AppLoop *loop, double until);
// From within on_step: the advance ends here.
void app_loop_stop(AppLoop *loop);

// Sets a group, as app_loop_group_set says.
Status app_loop_set(AppLoop *loop, AppLoopKind kind, const char *name, double ramp, const double *values,
                    int count);

// The two's contact, in either order of the names. STATUS_INPUT names what there is.
Status app_loop_contact(const AppLoop *loop, const char *a, const char *b, int *contact);

// Contact, friction and viscosity on the vertices (vertex_count, 3) [N], and the pressure at the surface
// (vertex_count) [Pa], NULL where the contact law has none. Borrowed until the next advance; both NULL: the
// scene has no contact.
Status app_loop_vertex_forces(AppLoop *loop, const double **forces, const double **pressure);
// Cauchy stress of the tetrahedra (tet_count, 6) [Pa]: xx, yy, zz, xy, yz, xz.
void app_loop_stress(const AppLoop *loop, double *stress);

#endif
