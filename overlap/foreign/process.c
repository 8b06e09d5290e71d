// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // memfd_create, mremap
#endif
#include "overlap/foreign/process.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/files/data.h"
#include "base/machine/interrupt.h"
#include "base/memory.h"

enum { HELLO = 1, EVALUATE = 2, VERSION = 1, WORDS = 4, PAIR_BYTES = 624, LEAST_CAPACITY = 1024 };
enum { SOCKET_FOR_IT = 3, MEMORY_FOR_IT = 4 };
static const double SECONDS_BETWEEN_LOOKS = 0.1; // whether somebody wants the program to end
static const double SECONDS_TO_END = 2;          // once its socket is closed, and to answer after a signal

typedef struct Process {
  char *name;          // for messages
  const char *missing; // what is told where there is no such program
  pid_t pid;           // 0: the process is not ours
  int socket, memory;
  double limit;  // of a reply [s]
  bool is_known; // it has said what it is
  char *range;   // or NULL
  char *map;
  size_t capacity; // pairs
} Process;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// Whether a process of ours has ended. It is still to be reaped: its group keeps its number until then.
static bool has_ended(const Process *process) {
  siginfo_t info = {0};
  if (process->pid == 0) return false;
  return waitid(P_PID, (id_t)process->pid, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

// Ends what the process has started in its group, then itself.
static void end_group(Process *process, int *how) {
  kill(-process->pid, SIGKILL);
  kill(process->pid, SIGKILL);
  waitpid(process->pid, how, 0);
  process->pid = 0;
}

// Waits until it has ended; false: it has not by then. What it has started ends, too.
static bool reap(Process *process, int *how) {
  for (double end = now() + SECONDS_TO_END; process->pid > 0;) {
    if (has_ended(process)) {
      end_group(process, how);
      return true;
    }
    if (now() > end) return false;
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
  }
  return true;
}

static void stop(Process *process) {
  int how;
  if (process->pid > 0) end_group(process, &how);
}

static void disconnect(Process *process) {
  if (process->socket >= 0) close(process->socket);
  process->socket = -1;
}

static void close_process(void *self) {
  Process *process = self;
  int how;
  if (process->map) munmap(process->map, process->capacity * PAIR_BYTES);
  disconnect(process);
  if (process->memory >= 0) close(process->memory);
  if (!reap(process, &how)) stop(process);
  memory_free(process->name), memory_free(process->range);
  memory_free(process);
}

// What is told where the other side has closed its end.
static Status fail_ended(Process *process) {
  int how = 0;
  const pid_t pid = process->pid;
  if (pid == 0) return status_fail(STATUS_DEVICE, "%s: the process with the model has ended", process->name);
  if (!reap(process, &how)) {
    stop(process);
    return status_fail(STATUS_DEVICE, "%s: the model's process closed its socket", process->name);
  }
  if (WIFSIGNALED(how))
    return status_fail(STATUS_DEVICE, "%s: the model's process was ended by signal %d (%s)", process->name,
                       WTERMSIG(how), strsignal(WTERMSIG(how)));
  if (WEXITSTATUS(how) == 127) return status_fail(STATUS_INPUT, "%s: %s", process->name, process->missing);
  return status_fail(STATUS_DEVICE,
                     "%s: the model's process ended with exit code %d%s; what it said stands above",
                     process->name, WEXITSTATUS(how),
                     process->is_known ? "" : " and without an answer (docs/own_model.md has the protocol)");
}

// A reply that comes after this would be taken for that of the next request: there is none.
static Status fail_late(Process *process) {
  const bool is_ours = process->pid > 0;
  disconnect(process);
  stop(process);
  return status_fail(STATUS_DEVICE,
                     "%s: the model has not answered within %g s%s. Where it needs longer, set "
                     "TETLAP_MODEL_SECONDS",
                     process->name, process->limit, is_ours ? ", so its process was ended" : "");
}

static Status fail_interrupted(Process *process) {
  disconnect(process);
  stop(process);
  return status_fail(STATUS_INTERRUPTED, "%s: interrupted while it was computing", process->name);
}

static Status send_all(Process *process, const void *bytes, size_t size) {
  for (const char *at = bytes; size > 0;) {
    ssize_t sent = send(process->socket, at, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return fail_ended(process);
    at += sent, size -= (size_t)sent;
  }
  return STATUS_OK;
}

// Waits until there is something to receive, or `*end` [s] is reached: false. A signal may be the wish to
// end, which the program sees to once the model has answered; soon, then.
static bool wait_for_answer(const Process *process, double *end, bool *is_signalled) {
  struct pollfd it = {.fd = process->socket, .events = POLLIN};
  int ready = 0;
  while (ready <= 0) {
    if ((ready < 0 || *interrupt_flag()) && !*is_signalled)
      *end = fmin(*end, now() + SECONDS_TO_END), *is_signalled = true;
    const double left = fmin(*end - now(), SECONDS_BETWEEN_LOOKS);
    if (!(left > 0)) return false;
    ready = poll(&it, 1, (int)(1e3 * left) + 1);
    if (ready < 0 && errno != EINTR) return true; // recv says what it is
    // One that it has started may hold the socket open.
    if (ready == 0 && has_ended(process)) shutdown(process->socket, SHUT_RDWR);
  }
  return true;
}

static Status receive_all(Process *process, void *bytes, size_t size, double end) {
  bool is_signalled = false;
  for (char *at = bytes; size > 0;) {
    if (!wait_for_answer(process, &end, &is_signalled))
      return is_signalled ? fail_interrupted(process) : fail_late(process);
    ssize_t got = recv(process->socket, at, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return fail_ended(process);
    at += got, size -= (size_t)got;
  }
  return STATUS_OK;
}

// One request and its reply; `text`, of `size` bytes, gets what fits of the reply's, and a 0.
static Status exchange(Process *process, const uint64_t request[WORDS], uint64_t reply[WORDS], char *text,
                       size_t size) {
  const double end = now() + process->limit;
  char rest[256];
  TRY(send_all(process, request, WORDS * sizeof *request));
  TRY(receive_all(process, reply, WORDS * sizeof *reply, end));
  size_t length = reply[1], taken = length < size ? length : size - 1;
  TRY(receive_all(process, text, taken, end));
  text[taken] = 0;
  for (size_t left = length - taken; left > 0;) {
    size_t part = left < sizeof rest ? left : sizeof rest;
    TRY(receive_all(process, rest, part, end));
    left -= part;
  }
  return STATUS_OK;
}

static Status fail_told(const Process *process, Status code, const char *text) {
  return status_fail(code, "%s: %s", process->name, text[0] ? text : "the model failed, without a reason");
}

// The largest room there can be in a process's part of an address space.
static const size_t MOST_CAPACITY = (size_t)1 << 32;

static Status reserve(Process *process, size_t count) {
  size_t capacity = process->capacity ? process->capacity : LEAST_CAPACITY;
  if (count > MOST_CAPACITY) return status_no_memory("pairs for a model");
  while (capacity < count) capacity *= 2;
  if (capacity == process->capacity) return STATUS_OK;
  const size_t old = process->capacity * PAIR_BYTES, size = capacity * PAIR_BYTES;
  if (posix_fallocate(process->memory, 0, (off_t)size) != 0)
    return status_no_memory("pairs shared with a model's process");
  char *map = process->map ? mremap(process->map, old, size, MREMAP_MAYMOVE)
                           : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, process->memory, 0);
  if (map == MAP_FAILED) return status_no_memory("pairs shared with a model's process");
  process->map = map, process->capacity = capacity;
  return STATUS_OK;
}

// An array of the shared memory.
typedef struct Part {
  size_t place, width; // bytes before it and numbers of it, a pair
} Part;
static const Part VOLUME = {192, 1}, GRADIENT = {200, 24}, CENTROID = {392, 3}, LOGIT = {416, 1},
                  DOUBT = {424, 1}, DOUBT_GRADIENT = {432, 24};

// NaN, so that what the model leaves unwritten is no answer.
static void unset(const Process *process, Part part, size_t count, const double *array) {
  if (array) memset(process->map + part.place * process->capacity, 0xFF, count * part.width * sizeof *array);
}

static void take(const Process *process, Part part, size_t count, double *array) {
  if (array) memcpy(array, process->map + part.place * process->capacity, count * part.width * sizeof *array);
}

static Status ask(void *self, const TetlapModelBatch *batch) {
  Process *process = self;
  char text[4096];
  uint64_t reply[WORDS];
  TRY(reserve(process, batch->count));
  memcpy(process->map, batch->pairs, batch->count * 24 * sizeof *batch->pairs);
  unset(process, VOLUME, batch->count, batch->volume);
  unset(process, GRADIENT, batch->count, batch->gradient);
  unset(process, CENTROID, batch->count, batch->centroid);
  unset(process, LOGIT, batch->count, batch->logit);
  unset(process, DOUBT, batch->count, batch->doubt);
  unset(process, DOUBT_GRADIENT, batch->count, batch->doubt_gradient);
  const uint64_t wants = (batch->gradient ? TETLAP_MODEL_GRADIENT : 0u) |
                         (batch->centroid ? TETLAP_MODEL_CENTROID : 0u) |
                         (batch->logit ? TETLAP_MODEL_LOGIT : 0u) | (batch->doubt ? TETLAP_MODEL_DOUBT : 0u) |
                         (batch->doubt_gradient ? TETLAP_MODEL_DOUBT_GRADIENT : 0u);
  const uint64_t request[WORDS] = {EVALUATE, batch->count, process->capacity, wants};
  TRY(exchange(process, request, reply, text, sizeof text));
  if (reply[0]) return fail_told(process, STATUS_SOLVER, text);
  take(process, VOLUME, batch->count, batch->volume);
  take(process, GRADIENT, batch->count, batch->gradient);
  take(process, CENTROID, batch->count, batch->centroid);
  take(process, LOGIT, batch->count, batch->logit);
  take(process, DOUBT, batch->count, batch->doubt);
  take(process, DOUBT_GRADIENT, batch->count, batch->doubt_gradient);
  return STATUS_OK;
}

// What the protocol knows of a model.
static const uint32_t ARRAYS_OF_IT = TETLAP_MODEL_GRADIENT | TETLAP_MODEL_CENTROID | TETLAP_MODEL_LOGIT |
                                     TETLAP_MODEL_DOUBT | TETLAP_MODEL_DISJOINT | TETLAP_MODEL_DOUBT_GRADIENT;

static Status greet(Process *process, OverlapForeignPort *port) {
  const uint64_t request[WORDS] = {HELLO, VERSION, process->capacity, 0};
  uint64_t reply[WORDS];
  char text[4096];
  TRY(exchange(process, request, reply, text, sizeof text));
  if (reply[0]) return fail_told(process, STATUS_INPUT, text);
  process->is_known = true;
  const char *range = strstr(text, "\nradius ");
  if (range && !(process->range = memory_copy(range + 1, strlen(range), 1)))
    return status_no_memory("a model's process");
  *port = (OverlapForeignPort){.self = process,
                               .gives = (uint32_t)reply[2] & ARRAYS_OF_IT,
                               .range = process->range,
                               .ask = ask,
                               .close = close_process};
  return STATUS_OK;
}

static Status create(Process **created, const char *name) {
  Process *process = *created = memory_zeroed(1, sizeof *process);
  if (!process) return status_no_memory("a model's process");
  char *end = "";
  const char *limit = getenv("TETLAP_MODEL_SECONDS");
  process->socket = process->memory = -1;
  process->limit = limit ? strtod(limit, &end) : 300;
  process->name = memory_copy(name, strlen(name) + 1, 1);
  Status status = process->name ? STATUS_OK : status_no_memory("a model's process");
  if (!status && (*end || !(process->limit > 0)))
    status = status_fail(STATUS_USAGE, "TETLAP_MODEL_SECONDS is '%s'; it must be a number of seconds", limit);
  if (status) close_process(process);
  return status;
}

// In the new process, before the other program: only what may be called there.
static void become(int socket, int memory, char *const arguments[], bool dies_with_us) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  setpgid(0, 0); // a Ctrl-C is the program's, which ends the model when it ends
  if (dies_with_us) prctl(PR_SET_PDEATHSIG, SIGKILL);
  int nothing = open("/dev/null", O_RDONLY);
  // Neither of the two may be overwritten before it is moved.
  socket = fcntl(socket, F_DUPFD, 10), memory = fcntl(memory, F_DUPFD, 10);
  if (dup2(nothing, 0) < 0 || dup2(2, 1) < 0 || dup2(socket, SOCKET_FOR_IT) < 0 ||
      dup2(memory, MEMORY_FOR_IT) < 0)
    _exit(126);
  close_range(MEMORY_FOR_IT + 1, ~0u, 0);
  execvp(arguments[0], arguments);
  _exit(127);
}

static Status start(Process *process, char *const arguments[]) {
  int ends[2];
  process->memory = memfd_create("tetlap-model", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (process->memory < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return status_fail(STATUS_IO, "%s: no socket or memory to share with the model: %s", process->name,
                       strerror(errno));
  process->socket = ends[0];
  fcntl(process->memory, F_ADD_SEALS, F_SEAL_SHRINK); // what is mapped here cannot be cut off there
  TRY(reserve(process, 1));
  fflush(NULL);
  // The kernel ties a process's end to the thread that started it; others than the first may end earlier.
  const bool dies_with_us = gettid() == getpid();
  pid_t pid = fork();
  if (pid == 0) become(ends[1], process->memory, arguments, dies_with_us);
  close(ends[1]);
  if (pid < 0)
    return status_fail(STATUS_IO, "%s: no process for the model: %s", process->name, strerror(errno));
  setpgid(pid, pid);
  process->pid = pid;
  return STATUS_OK;
}

static Status launch(OverlapForeignPort *port, const char *name, const char *missing,
                     char *const arguments[]) {
  Process *process;
  TRY(create(&process, name));
  process->missing = missing;
  Status status = start(process, arguments);
  if (!status) status = greet(process, port);
  if (status) close_process(process);
  return status;
}

Status overlap_foreign_process_open(OverlapForeignPort *port, const char *command) {
  char shell[] = "sh", option[] = "-c", line[8192];
  if (command[strspn(command, " ")] == 0)
    return status_fail(STATUS_INPUT, "exec: a command is missing behind it, as in exec:./model");
  if (snprintf(line, sizeof line, "exec %s", command) >= (int)sizeof line)
    return status_fail(STATUS_INPUT, "exec: the command is too long");
  char *const arguments[] = {shell, option, line, NULL};
  return launch(port, command, "the command was not found: look at its spelling and at PATH", arguments);
}

Status overlap_foreign_process_open_python(OverlapForeignPort *port, const char *word) {
  const char *chosen = getenv("TETLAP_PYTHON");
  char python[PATH_MAX], script[PATH_MAX], file[PATH_MAX];
  if (snprintf(python, sizeof python, "%s", chosen && *chosen ? chosen : "python3") >= (int)sizeof python ||
      snprintf(file, sizeof file, "%s", word) >= (int)sizeof file)
    return status_fail(STATUS_INPUT, "%.200s: the path is too long", word);
  TRY(data_find("python/tetlap/serve.py", script, sizeof script));
  char *const arguments[] = {python, script, file, NULL};
  return launch(port, word, "there is no Python to run it: set TETLAP_PYTHON to one that has NumPy",
                arguments);
}

// The descriptors of a word, with these flags from now on, and where its name begins.
static Status find_channel(const char *word, int flags, int ends[2], const char **name) {
  int used = 0;
  if (sscanf(word, "channel:%d:%d:%n", &ends[0], &ends[1], &used) != 2 || used == 0 || !word[used])
    return status_fail(STATUS_INPUT, "%s: expected channel:SOCKET:MEMORY:NAME, two descriptors", word);
  *name = word + used;
  for (int e = 0; e < 2; e++)
    if (fcntl(ends[e], F_SETFD, flags) < 0)
      return status_fail(STATUS_INPUT,
                         "%s: the program that has this function did not start this run: start it there",
                         *name);
  return STATUS_OK;
}

Status overlap_foreign_process_hand_on(const char *word) {
  int ends[2];
  const char *name;
  return find_channel(word, 0, ends, &name);
}

Status overlap_foreign_process_attach(OverlapForeignPort *port, const char *word) {
  int ends[2];
  const char *name = word;
  TRY(find_channel(word, FD_CLOEXEC, ends, &name));
  Process *process;
  TRY(create(&process, name));
  process->socket = fcntl(ends[0], F_DUPFD_CLOEXEC, 0);
  process->memory = fcntl(ends[1], F_DUPFD_CLOEXEC, 0);
  Status status = process->socket < 0 || process->memory < 0
                      ? status_fail(STATUS_IO, "%s: no descriptor: %s", process->name, strerror(errno))
                      : reserve(process, 1);
  if (!status) status = greet(process, port);
  if (status) close_process(process);
  return status;
}
