// SPDX-License-Identifier: GPL-3.0-or-later
// MPI's profiling interface: every function is also there as PMPI_…, and one of our own under its name takes
// its place in all libraries.
#include "dist/inside.h"

#include <mpi.h>
#include <time.h>

static double inside_s, entered_s;

double dist_inside_s(void) {
  return inside_s;
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

#define CALL(name, parameters, ...)                                                                          \
  int MPI_##name parameters {                                                                                \
    entered_s = now();                                                                                       \
    int code = PMPI_##name(__VA_ARGS__);                                                                     \
    inside_s += now() - entered_s;                                                                           \
    return code;                                                                                             \
  }

#define TYPE MPI_Datatype
#define COMM MPI_Comm
#define REQUEST MPI_Request
#define STATE MPI_Status

CALL(Wait, (REQUEST * r, STATE *s), r, s)
CALL(Waitall, (int n, REQUEST r[], STATE s[]), n, r, s)
CALL(Waitany, (int n, REQUEST r[], int *i, STATE *s), n, r, i, s)
CALL(Waitsome, (int n, REQUEST r[], int *m, int i[], STATE s[]), n, r, m, i, s)
CALL(Test, (REQUEST * r, int *f, STATE *s), r, f, s)
CALL(Testall, (int n, REQUEST r[], int *f, STATE s[]), n, r, f, s)
CALL(Probe, (int a, int b, COMM c, STATE *s), a, b, c, s)
CALL(Iprobe, (int a, int b, COMM c, int *f, STATE *s), a, b, c, f, s)
CALL(Startall, (int n, REQUEST r[]), n, r)
CALL(Send, (const void *x, int n, TYPE t, int a, int b, COMM c), x, n, t, a, b, c)
CALL(Recv, (void *x, int n, TYPE t, int a, int b, COMM c, STATE *s), x, n, t, a, b, c, s)
CALL(Isend, (const void *x, int n, TYPE t, int a, int b, COMM c, REQUEST *r), x, n, t, a, b, c, r)
CALL(Irecv, (void *x, int n, TYPE t, int a, int b, COMM c, REQUEST *r), x, n, t, a, b, c, r)
CALL(Sendrecv,
     (const void *x, int n, TYPE t, int a, int b, void *y, int m, TYPE u, int d, int e, COMM c, STATE *s), x,
     n, t, a, b, y, m, u, d, e, c, s)
CALL(Barrier, (COMM c), c)
CALL(Bcast, (void *x, int n, TYPE t, int root, COMM c), x, n, t, root, c)
CALL(Reduce, (const void *x, void *y, int n, TYPE t, MPI_Op o, int root, COMM c), x, y, n, t, o, root, c)
CALL(Allreduce, (const void *x, void *y, int n, TYPE t, MPI_Op o, COMM c), x, y, n, t, o, c)
CALL(Scan, (const void *x, void *y, int n, TYPE t, MPI_Op o, COMM c), x, y, n, t, o, c)
CALL(Exscan, (const void *x, void *y, int n, TYPE t, MPI_Op o, COMM c), x, y, n, t, o, c)
CALL(Allgather, (const void *x, int n, TYPE t, void *y, int m, TYPE u, COMM c), x, n, t, y, m, u, c)
CALL(Allgatherv, (const void *x, int n, TYPE t, void *y, const int m[], const int at[], TYPE u, COMM c), x, n,
     t, y, m, at, u, c)
CALL(Alltoall, (const void *x, int n, TYPE t, void *y, int m, TYPE u, COMM c), x, n, t, y, m, u, c)
