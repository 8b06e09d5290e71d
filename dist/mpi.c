// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // memfd_create, on_exit
#endif
#include "dist/mpi.h"

#include <fcntl.h>
#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "app/cli/ranks.h"
#include "base/machine/clock.h"
#include "base/ranks.h"
#include "base/status.h"
#include "dist/division.h"
#include "dist/inside.h"
#include "overlap/foreign/guard.h"

enum { MESSAGE_SIZE = 2048, POLL_NS = 2000000 };
// A rank that failed and finds the others elsewhere ends the run after this time [s]; later ones wait longer,
// so that one is heard.
static const double PATIENCE = 1.5, PATIENCE_A_RANK = 0.05;

static MPI_Comm world, leaving;
static Ranks table;
static RanksStats stats;
static void (*close_libraries)(void);
static int heard = -1;   // standard error of a rank that is not heard: the real one
static Status agreed;    // the fatal state that all have been told of
static double entered_s; // a call that waits for others
static int piece_counts[RANKS_MOST];

static void enter(long long *calls) {
  ++*calls;
  entered_s = clock_wall_s();
}

static void leave(double bytes) {
  stats.bytes += (long long)bytes;
  stats.waiting_s += clock_wall_s() - entered_s;
}

// MPI counts by int.
static void reduce(double *values, size_t count, MPI_Op operation) {
  enum { PIECE = 1 << 24 };
  for (size_t at = 0; at < count; at += PIECE) {
    int piece = count - at < PIECE ? (int)(count - at) : PIECE;
    MPI_Allreduce(MPI_IN_PLACE, values + at, piece, MPI_DOUBLE, operation, world);
  }
}

// All ranks know that the run ends: what they would still say to each other is said.
static bool is_over(void) {
  return agreed != STATUS_OK;
}

static void sum(double *values, size_t count) {
  if (is_over()) return;
  enter(&stats.sums);
  reduce(values, count, MPI_SUM);
  leave((double)(count * sizeof *values));
}

static void most(double *values, size_t count) {
  if (is_over()) return;
  enter(&stats.decisions);
  reduce(values, count, MPI_MAX);
  leave((double)(count * sizeof *values));
}

static void join(void *items, size_t size, const int *begin) {
  if (is_over()) return;
  enter(&stats.pieces);
  for (int r = 0; r < table.count; r++) piece_counts[r] = begin[r + 1] - begin[r];
  MPI_Datatype item;
  MPI_Type_contiguous((int)size, MPI_BYTE, &item);
  MPI_Type_commit(&item);
  MPI_Allgatherv(MPI_IN_PLACE, 0, item, items, piece_counts, begin, item, world);
  MPI_Type_free(&item);
  leave((double)size * piece_counts[table.number]);
}

static void tell(void *bytes, size_t size) {
  enum { PIECE = 1 << 28 };
  char *at = bytes;
  if (is_over()) return;
  enter(&stats.pieces);
  for (size_t left = size; left > 0;) {
    int piece = left < PIECE ? (int)left : PIECE;
    MPI_Bcast(at, piece, MPI_BYTE, 0, world);
    at += piece, left -= (size_t)piece;
  }
  leave(table.number == 0 ? (double)size : 0);
}

static Status worst(Status status) {
  if (is_over()) return agreed;
  struct {
    int severity, rank;
  } mine = {status == STATUS_OK ? 0 : status > 0 ? 1 : 1 - (int)status, table.number};
  enter(&stats.decisions);
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_2INT, MPI_MAXLOC, world);
  leave(sizeof mine);
  if (mine.severity == 0) return STATUS_OK;
  char message[MESSAGE_SIZE];
  snprintf(message, sizeof message, "%s", status_message());
  MPI_Bcast(message, sizeof message, MPI_CHAR, mine.rank, world);
  Status code = mine.severity == 1 ? STATUS_RETRY : (Status)(1 - mine.severity);
  if (code < 0) agreed = code;
  return status_fail(code, "%s", message);
}

static const RanksStats *get_stats(void) {
  stats.inside_s = dist_inside_s();
  return &stats;
}

// What a rank that is not heard has said of its first error, to standard error.
static void speak(void) {
  if (heard < 0) return;
  fflush(stderr);
  FILE *said = fdopen(dup(STDERR_FILENO), "r"), *aloud = fdopen(heard, "w");
  char line[2 * MESSAGE_SIZE];
  if (!said || !aloud) return;
  rewind(said);
  bool is_told = false;
  while (fgets(line, sizeof line, said) && !is_told) {
    is_told = strstr(line, "error: ") != NULL;
    if (is_told || strncmp(line, "tetlap", 6) == 0) fputs(line, aloud);
  }
  fflush(aloud);
}

static void sleep_a_little(void) {
  nanosleep(&(struct timespec){.tv_nsec = POLL_NS}, NULL);
}

// Whether all ranks have come here with what they exit with; *first: the lowest that failed, or INT_MAX.
static int meet(int exit_code, double patience, int *first) {
  static int failed, lowest; // may be written to after a rank has given up waiting
  MPI_Request request;
  int is_there = 0;
  failed = exit_code ? table.number : INT_MAX;
  MPI_Iallreduce(&failed, &lowest, 1, MPI_INT, MPI_MIN, leaving, &request);
  double began = clock_wall_s();
  for (;;) {
    MPI_Test(&request, &is_there, MPI_STATUS_IGNORE);
    if (is_there || clock_wall_s() - began > patience) break;
    sleep_a_little();
  }
  *first = lowest;
  return is_there;
}

static void end(int exit_code, void *argument) {
  (void)argument;
  fflush(stdout);
  int is_agreed = exit_code == 0 || (agreed != STATUS_OK && exit_code == status_exit_code(agreed)), first;
  double patience = is_agreed ? 1e30 : PATIENCE + PATIENCE_A_RANK * table.number;
  if (!meet(exit_code, patience, &first)) {
    speak();
    MPI_Abort(world, exit_code);
  }
  if (first == table.number && first > 0) speak();
  if (close_libraries) close_libraries();
  MPI_Finalize();
}

static void end_called(int exit_code) {
  end(exit_code, NULL);
}

// What this rank prints goes nowhere, and its errors are kept.
static void fall_silent(void) {
  int nowhere = open("/dev/null", O_WRONLY), kept = memfd_create("errors", MFD_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
  if (kept < 0) return;
  heard = dup(STDERR_FILENO);
  dup2(kept, STDERR_FILENO);
}

int dist_mpi_is_wanted(void) {
  return app_ranks_started() > 1;
}

void dist_mpi_begin_alone(void) {
  table = *ranks();
  table.divides = true;
  table.divide = dist_division_divide;
  ranks_set(&table);
}

void dist_mpi_begin(int *argument_count, char ***arguments, void (*close)(void)) {
  int provided;
  MPI_Init_thread(argument_count, arguments, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_dup(MPI_COMM_WORLD, &world);
  MPI_Comm_dup(MPI_COMM_WORLD, &leaving);
  table = (Ranks){.sum = sum,
                  .most = most,
                  .join = join,
                  .tell = tell,
                  .worst = worst,
                  .divides = true,
                  .divide = dist_division_divide,
                  .stats = get_stats};
  MPI_Comm_rank(world, &table.number);
  MPI_Comm_size(world, &table.count);
  close_libraries = close;
  if (table.count > RANKS_MOST) {
    if (table.number == 0)
      fprintf(stderr, "error: %d ranks; at most %d are possible\n", table.count, RANKS_MOST);
    MPI_Abort(world, status_exit_code(STATUS_USAGE));
  }
  ranks_set(table.count > 1 ? &table : NULL);
  on_exit(end, NULL);
  overlap_foreign_guard_set_end(end_called);
  if (table.number > 0) fall_silent();
}
