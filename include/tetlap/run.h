/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libtetlap-run: a run of tetlap in the hands of the program that embeds it. GPL-3.0-or-later; programs that
 * must not be reach the same through the Python package, which runs it in a process of its own.
 *
 *   TetlapRun *run;
 *   if (tetlap_run_open(&run, "gripper.yaml", NULL)) die(tetlap_run_message());
 *   while (tetlap_run_time(run) < 2) {
 *     TetlapRunContact contact = TETLAP_RUN_CONTACT_INIT;
 *     double to[3] = {0, 0, 0};
 *     tetlap_run_contact(run, "finger", "ball", &contact);
 *     to[2] = target(contact.force);
 *     tetlap_run_drive(run, "finger", to, TETLAP_RUN_NEXT_ADVANCE);
 *     if (tetlap_run_advance(run, tetlap_run_time(run) + 0.01)) die(tetlap_run_message());
 *   }
 *   tetlap_run_close(run);
 *
 * Every function that can fail returns 0 or the exit code that the program `tetlap` would have
 * (docs/output.md), and leaves a message. Nothing is printed, no process ended. Units: SI. Of a run that is
 * NULL, counts are 0, arrays NULL, the time NaN, and all else fails.
 *
 * A run belongs to one thread at a time: functions that take a run that is not const refuse another, a fork
 * of the process, and, but for tetlap_run_forces, the run's own on_step. Numbers of threads, and the level
 * of the log, are the process's: the scene opened last sets them.
 *
 * Compatibility: structs carry their size, set by the ..._INIT macros.
 */
#ifndef TETLAP_RUN_H
#define TETLAP_RUN_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define TETLAP_RUN_API __attribute__((visibility("default")))
#else
#define TETLAP_RUN_API
#endif

typedef struct TetlapRun TetlapRun;

/* What went wrong in this thread's last call that failed; "" if none did. */
TETLAP_RUN_API const char *tetlap_run_message(void);

typedef struct TetlapRunOptions {
  size_t size;            /* sizeof(TetlapRunOptions) */
  const char *overlap;    /* in place of the scene's overlap model; NULL: that */
  const char *const *set; /* "contact.stiffness=1e6" ...: what to change in the scene (set_count) */
  int set_count;
  int threads; /* 0: the scene's, else all */
  /* After every step, at its state, to read it. Other than 0 ends the advance there, without failure. NULL:
   * nobody is told. */
  int (*on_step)(void *user, TetlapRun *run);
  void *user;
} TetlapRunOptions;
#define TETLAP_RUN_OPTIONS_INIT                                                                              \
  { sizeof(TetlapRunOptions), NULL, NULL, 0, 0, NULL, NULL }

/* Opens a scene file at its first state. `options` NULL: all as the scene says. On failure *run is NULL. */
TETLAP_RUN_API int tetlap_run_open(TetlapRun **run, const char *scene, const TetlapRunOptions *options);
TETLAP_RUN_API void tetlap_run_close(TetlapRun *run); /* NULL is fine */

TETLAP_RUN_API double tetlap_run_time(const TetlapRun *run); /* [s] */

/* Steps to that time [s]. A static scene goes from equilibrium to equilibrium, whose parameter time is. */
TETLAP_RUN_API int tetlap_run_advance(TetlapRun *run, double until);

/* ---- What there is */

/* A body, or an obstacle with a mesh, and which vertices and tetrahedra are its. */
typedef struct TetlapRunBody {
  size_t size;      /* sizeof(TetlapRunBody), set before the call */
  const char *name; /* valid as long as the run */
  int vertex_begin, vertex_end, tet_begin, tet_end;
  int is_obstacle;
} TetlapRunBody;
#define TETLAP_RUN_BODY_INIT                                                                                 \
  { sizeof(TetlapRunBody), NULL, 0, 0, 0, 0, 0 }

TETLAP_RUN_API int tetlap_run_body_count(const TetlapRun *run);
TETLAP_RUN_API int tetlap_run_body(const TetlapRun *run, int number, TetlapRunBody *body);
TETLAP_RUN_API int tetlap_run_vertex_count(const TetlapRun *run);
TETLAP_RUN_API int tetlap_run_tet_count(const TetlapRun *run);
TETLAP_RUN_API const int *tetlap_run_tets(const TetlapRun *run); /* vertices (tet_count, 4) */

/* Of all vertices, at the present time; the run's, valid until the next call that is not const. */
TETLAP_RUN_API const double *tetlap_run_points(const TetlapRun *run);     /* [m]   (vertex_count, 3) */
TETLAP_RUN_API const double *tetlap_run_velocities(const TetlapRun *run); /* [m/s] (vertex_count, 3) */

/* Contact's forces on all vertices, friction included [N] (vertex_count, 3), and the pressure at the surface
 * [Pa] (vertex_count), NULL where the contact law has none. Likewise valid. Both NULL: no contact. */
TETLAP_RUN_API int tetlap_run_forces(TetlapRun *run, const double **forces, const double **pressure);
/* Cauchy stress of all tetrahedra [Pa], xx yy zz xy yz xz, into (tet_count, 6). */
TETLAP_RUN_API int tetlap_run_stress(const TetlapRun *run, double *stress);

/* ---- Contact */

typedef struct TetlapRunContact {
  size_t size;       /* sizeof(TetlapRunContact), set before the call */
  const char *a, *b; /* bodies or obstacles; valid as long as the run */
  double force[3];   /* on a, friction included; the opposite acts on b [N] */
  double moment[3];  /* of it about the origin [N m] */
  double centre[3];  /* of pressure [m]; NaN: nothing presses */
  double area;       /* of contact [m2] */
  double pressure;   /* force without friction over area [Pa] */
  double slip;       /* share of the area that slides; NaN: no friction, or no contact */
  double impulse[3]; /* of the force since the run began [N s] */
  double volume;     /* of overlap [m3] */
} TetlapRunContact;
#define TETLAP_RUN_CONTACT_INIT                                                                              \
  { sizeof(TetlapRunContact), NULL, NULL, {0}, {0}, {0}, 0, 0, 0, {0}, 0 }

TETLAP_RUN_API int tetlap_run_contact_count(const TetlapRun *run);
TETLAP_RUN_API int tetlap_run_contact_at(const TetlapRun *run, int number, TetlapRunContact *contact);
/* Between two by name, in either order; the force is on the one that is named first. */
TETLAP_RUN_API int tetlap_run_contact(const TetlapRun *run, const char *a, const char *b,
                                      TetlapRunContact *contact);

/* ---- What is set from outside: groups that the scene declares `external: true` */

/* A ramp that ends where the next advance does. */
#define TETLAP_RUN_NEXT_ADVANCE (-1.0)

/* Moves a driven group to a displacement from rest [m], in `ramp` seconds. */
TETLAP_RUN_API int tetlap_run_drive(TetlapRun *run, const char *name, const double to[3], double ramp);
/* Changes a load in `ramp` seconds, 0: at once. 3 values: a force [N], shared evenly; 6: force and moment
 * about the mean of the group's vertices [N m]; 3 for each of them: forces [N]. */
TETLAP_RUN_API int tetlap_run_load(TetlapRun *run, const char *name, const double *values, int count,
                                   double ramp);

/* Writes what was set so far, for `tetlap run --replay`. */
TETLAP_RUN_API int tetlap_run_record(const TetlapRun *run, const char *path);

/* ---- States */

typedef struct TetlapRunState TetlapRunState;

/* Keeps the present state. The run's integrator begins anew there, as that of every run that is restored to
 * it: both go on to the same bits. */
TETLAP_RUN_API int tetlap_run_keep(TetlapRun *run, TetlapRunState **state);
TETLAP_RUN_API int tetlap_run_restore(TetlapRun *run, const TetlapRunState *state);
TETLAP_RUN_API void tetlap_run_state_free(TetlapRunState *state); /* NULL is fine */

/* To a file, and back into a run of the same scene, here or in another process. */
TETLAP_RUN_API int tetlap_run_state_write(const TetlapRun *run, const TetlapRunState *state,
                                          const char *path);
TETLAP_RUN_API int tetlap_run_state_read(const TetlapRun *run, TetlapRunState **state, const char *path);

#ifdef __cplusplus
}
#endif

#endif
