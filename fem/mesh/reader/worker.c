// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/worker.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"

// What goes through the pipe: the head, then the message or the arrays in the order of FemMeshSource, then
// for each group its sizes, name, vertices and tetrahedra.
typedef struct Head {
  int status;
  int message_size;
  int vertex_count, tet_count, group_count;
  bool has_vertex_tags, has_tet_tags, has_middles;
} Head;

typedef struct GroupHead {
  int name_size, vertex_count, tet_count;
} GroupHead;

static bool send(int pipe, const void *data, size_t size) {
  for (const char *at = data; size > 0;) {
    ssize_t sent = write(pipe, at, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent, size -= (size_t)sent;
  }
  return true;
}

static bool send_source(int pipe, const FemMeshSource *source) {
  size_t vertices = (size_t)source->vertex_count, tets = (size_t)source->tet_count;
  bool ok = send(pipe, source->positions, vertices * sizeof(double[3])) &&
            send(pipe, source->tets, tets * sizeof(int[4])) &&
            (!source->vertex_tags || send(pipe, source->vertex_tags, vertices * sizeof(long long))) &&
            (!source->tet_tags || send(pipe, source->tet_tags, tets * sizeof(long long))) &&
            (!source->middles || send(pipe, source->middles, tets * sizeof *source->middles));
  for (int g = 0; ok && g < source->group_count; g++) {
    const FemMeshGroup *group = &source->groups[g];
    GroupHead head = {(int)strlen(group->name) + 1, group->vertex_count, group->tet_count};
    ok = send(pipe, &head, sizeof head) && send(pipe, group->name, (size_t)head.name_size) &&
         send(pipe, group->vertices, (size_t)head.vertex_count * sizeof(int)) &&
         send(pipe, group->tets, (size_t)head.tet_count * sizeof(int));
  }
  return ok;
}

// The kernel counts private writable pages, those of this process already included: statm's sixth number.
// Where it cannot be read there is no limit.
static void limit_memory(size_t limit) {
  unsigned long pages = 0;
  FILE *statm = limit ? fopen("/proc/self/statm", "r") : NULL;
  if (!statm) return;
  if (fscanf(statm, "%*u %*u %*u %*u %*u %lu", &pages) == 1) {
    rlim_t bytes = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + limit;
    setrlimit(RLIMIT_DATA, &(struct rlimit){bytes, bytes});
  }
  fclose(statm);
}

// The child: silent, mortal by the usual signals and with its parent, without a core file.
static void be_child(int pipe, FemMeshReader reader, const char *path, const FemMeshOptions *options,
                     size_t memory_limit) {
  static const int signals[] = {SIGINT,  SIGTERM, SIGHUP, SIGPIPE, SIGALRM,
                                SIGSEGV, SIGABRT, SIGBUS, SIGFPE,  SIGILL};
  for (size_t k = 0; k < sizeof signals / sizeof *signals; k++) signal(signals[k], SIG_DFL);
  // A reader that outlives this program would run on unseen.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
  int nowhere = open("/dev/null", O_RDWR);
  if (nowhere >= 0) dup2(nowhere, STDIN_FILENO), dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
  limit_memory(memory_limit);
  FemMeshSource source = {0};
  Status status = reader(&source, path, options);
  Head head = {.status = status};
  if (status == STATUS_OK)
    head = (Head){0,
                  0,
                  source.vertex_count,
                  source.tet_count,
                  source.group_count,
                  source.vertex_tags != NULL,
                  source.tet_tags != NULL,
                  source.middles != NULL};
  else
    head.message_size = (int)strlen(status_message()) + 1;
  bool ok = send(pipe, &head, sizeof head);
  if (ok)
    ok = status == STATUS_OK ? send_source(pipe, &source)
                             : send(pipe, status_message(), (size_t)head.message_size);
  _exit(ok ? 0 : 1);
}

typedef enum Receipt { RECEIVED, BROKEN, INTERRUPTED, NO_MEMORY } Receipt;

static Receipt receive(int pipe, void *data, size_t size) {
  for (char *at = data; size > 0;) {
    ssize_t got = read(pipe, at, size);
    if (got < 0 && errno == EINTR) return INTERRUPTED;
    if (got <= 0) return BROKEN;
    at += got, size -= (size_t)got;
  }
  return RECEIVED;
}

static Receipt receive_array(int pipe, void *array_pointer, size_t count, size_t size) {
  void *array = memory_zeroed(count, size);
  if (!array) return NO_MEMORY;
  memcpy(array_pointer, &array, sizeof array);
  return receive(pipe, array, count * size);
}

static Receipt receive_group(int pipe, FemMeshGroup *group) {
  GroupHead head;
  Receipt receipt = receive(pipe, &head, sizeof head);
  if (receipt == RECEIVED) receipt = receive_array(pipe, &group->name, (size_t)head.name_size, 1);
  if (receipt == RECEIVED)
    receipt = receive_array(pipe, &group->vertices, (size_t)head.vertex_count, sizeof(int));
  if (receipt == RECEIVED) group->vertex_count = head.vertex_count;
  if (receipt == RECEIVED) receipt = receive_array(pipe, &group->tets, (size_t)head.tet_count, sizeof(int));
  if (receipt == RECEIVED) group->tet_count = head.tet_count;
  return receipt;
}

static Receipt receive_source(int pipe, const Head *head, FemMeshSource *source) {
  size_t vertices = (size_t)head->vertex_count, tets = (size_t)head->tet_count;
  source->vertex_count = head->vertex_count, source->tet_count = head->tet_count;
  Receipt receipt = receive_array(pipe, &source->positions, vertices, sizeof(double[3]));
  if (receipt == RECEIVED) receipt = receive_array(pipe, &source->tets, tets, sizeof(int[4]));
  if (receipt == RECEIVED && head->has_vertex_tags)
    receipt = receive_array(pipe, &source->vertex_tags, vertices, sizeof(long long));
  if (receipt == RECEIVED && head->has_tet_tags)
    receipt = receive_array(pipe, &source->tet_tags, tets, sizeof(long long));
  if (receipt == RECEIVED && head->has_middles)
    receipt = receive_array(pipe, &source->middles, tets, sizeof *source->middles);
  if (receipt != RECEIVED) return receipt;
  source->groups = memory_zeroed((size_t)head->group_count, sizeof *source->groups);
  if (!source->groups) return NO_MEMORY;
  for (source->group_count = 0; source->group_count < head->group_count && receipt == RECEIVED;)
    receipt = receive_group(pipe, &source->groups[source->group_count++]);
  return receipt;
}

// Receives the answer; `*status` is the reader's own where it gave one.
static Receipt receive_answer(int pipe, FemMeshSource *source, Status *status) {
  Head head;
  Receipt receipt = receive(pipe, &head, sizeof head);
  if (receipt != RECEIVED) return receipt;
  *status = (Status)head.status;
  if (head.status == STATUS_OK) return receive_source(pipe, &head, source);
  char *message = NULL;
  receipt = receive_array(pipe, &message, (size_t)head.message_size, 1);
  if (receipt == RECEIVED) status_fail(*status, "%s", message);
  memory_free(message);
  return receipt;
}

// Why a child ended without a whole answer.
static Status explain_end(int end) {
  if (!WIFSIGNALED(end))
    return status_fail(STATUS_INPUT,
                       "the reader ended without an answer (exit code %d); the file is probably damaged: "
                       "export it again",
                       WEXITSTATUS(end));
  int cause = WTERMSIG(end);
  if (cause == SIGINT || cause == SIGTERM || cause == SIGHUP)
    return status_fail(STATUS_INTERRUPTED, "interrupted while reading the mesh");
  if (cause == SIGKILL)
    return status_fail(STATUS_MEMORY,
                       "the reader was killed, probably for lack of memory; give a coarser mesh");
  return status_fail(STATUS_INPUT,
                     "the reader crashed on it (%s); the file is probably damaged: export it again",
                     strsignal(cause));
}

static Status finish(pid_t child, Receipt receipt, Status reader_status) {
  if (receipt == INTERRUPTED || receipt == NO_MEMORY) kill(child, SIGKILL);
  int end = 0;
  while (waitpid(child, &end, 0) < 0)
    if (errno != EINTR) return status_fail(STATUS_IO, "the reading process was lost: %s", strerror(errno));
  switch (receipt) {
  case RECEIVED:
    return reader_status;
  case BROKEN:
    return explain_end(end);
  case INTERRUPTED:
    return status_fail(STATUS_INTERRUPTED, "interrupted while reading the mesh");
  case NO_MEMORY:
    break;
  }
  return status_no_memory("a mesh");
}

Status fem_mesh_worker_run(FemMeshReader reader, FemMeshSource *source, const char *path,
                           const FemMeshOptions *options, size_t memory_limit) {
  int ends[2];
  *source = (FemMeshSource){0};
  if (pipe(ends) != 0) return status_fail(STATUS_IO, "no pipe to the reading process: %s", strerror(errno));
  pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    be_child(ends[1], reader, path, options, memory_limit);
  }
  int reason = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return status_fail(STATUS_IO, "no process to read in: %s", strerror(reason));
  }
  Status status = STATUS_OK;
  Receipt receipt = receive_answer(ends[0], source, &status);
  close(ends[0]);
  status = finish(child, receipt, status);
  if (status != STATUS_OK) fem_mesh_source_destroy(source);
  return status;
}
