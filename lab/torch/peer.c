// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/torch/peer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/data.h"
#include "base/files/temporary.h"

extern char **environ;

enum { NOT_INSTALLED = 77, NO_DEVICE = 78 }; // exit statuses of the script

static Status write_inputs(LabTorchPeer *peer, const void *inputs, size_t size) {
  TRY(temporary_file("inputs", "", &peer->inputs));
  FILE *stream = fopen(peer->inputs, "wb");
  size_t written = stream ? fwrite(inputs, 1, size, stream) : 0;
  if (!stream || fclose(stream) != 0 || written != size)
    return status_fail(STATUS_IO, "%s: cannot be written", peer->inputs);
  return STATUS_OK;
}

// The child reads from `to` and writes to `from`; what it prints for people is not shown.
static int spawn(LabTorchPeer *peer, char *script, const LabTorchDef *def, const int to[2],
                 const int from[2]) {
  static const char *const names[] = {"float", "double", "bf16"};
  char python[] = "python3", path[1024], number[16], precision[8], device[16];
  snprintf(path, sizeof path, "%s", def->weights);
  snprintf(number, sizeof number, "%d", def->threads);
  snprintf(precision, sizeof precision, "%s", names[def->precision]);
  snprintf(device, sizeof device, "%s", def->device);
  char *arguments[] = {python, script, path, precision, peer->inputs, number, device, NULL};
  posix_spawn_file_actions_t actions;
  if (posix_spawn_file_actions_init(&actions) != 0) return ENOMEM;
  int failed = posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
  if (!failed) failed = posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
  if (!failed) failed = posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  if (!failed) failed = posix_spawnp(&peer->child, python, &actions, NULL, arguments, environ);
  if (failed) peer->child = 0;
  posix_spawn_file_actions_destroy(&actions);
  return failed;
}

// Its ends are not handed on to the child, which would then hold its own input open.
static Status open_pipe(int ends[2]) {
  if (pipe(ends) != 0) return status_fail(STATUS_IO, "no pipe: %s", strerror(errno));
  for (int e = 0; e < 2; e++) fcntl(ends[e], F_SETFD, FD_CLOEXEC);
  return STATUS_OK;
}

static Status launch(LabTorchPeer *peer, char *script, const LabTorchDef *def) {
  int to[2], from[2];
  TRY(open_pipe(to));
  Status status = open_pipe(from);
  if (status) {
    close(to[0]), close(to[1]);
    return status;
  }
  int failed = spawn(peer, script, def, to, from);
  close(to[0]), close(from[1]);
  peer->to = fdopen(to[1], "w"), peer->from = fdopen(from[0], "r");
  if (!peer->to) close(to[1]);
  if (!peer->from) close(from[0]);
  if (failed) return status_fail(STATUS_IO, "python3 cannot be run: %s", strerror(failed));
  return peer->to && peer->from ? STATUS_OK : status_no_memory("a pipe");
}

static Status read_version(LabTorchPeer *peer) {
  int ended;
  char line[48];
  if (fgets(line, sizeof line, peer->from)) {
    snprintf(peer->name, sizeof peer->name, "PyTorch %.*s", (int)strcspn(line, "\n"), line);
    return STATUS_OK;
  }
  if (waitpid(peer->child, &ended, 0) == peer->child) peer->child = 0;
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == NOT_INSTALLED)
    return status_fail(STATUS_IO, "it is not installed (Debian: python3-torch)");
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == NO_DEVICE)
    return status_fail(STATUS_IO, "it finds no device of that kind");
  return status_fail(STATUS_IO, "tools/torch_bench.py failed; run it by hand to see why");
}

Status lab_torch_peer_start(LabTorchPeer *peer, const LabTorchDef *def) {
  char script[PATH_MAX];
  *peer = (LabTorchPeer){0};
  TRY(data_find("tools/torch_bench.py", script, sizeof script));
  TRY(write_inputs(peer, def->inputs, def->size));
  TRY(launch(peer, script, def));
  return read_version(peer);
}

void lab_torch_peer_stop(LabTorchPeer *peer) {
  if (peer->to) fclose(peer->to); // the child's input ends, and so does the child
  if (peer->from) fclose(peer->from);
  if (peer->child) {
    while (waitpid(peer->child, NULL, 0) < 0 && errno == EINTR) continue;
  }
  temporary_remove(peer->inputs);
  *peer = (LabTorchPeer){0};
}

Status lab_torch_peer_time(LabTorchPeer *peer, const char *what, int batch, int calls, LabTorchTime *time) {
  char line[128];
  void (*before)(int) = signal(SIGPIPE, SIG_IGN); // a child that is gone is an answer that does not come
  fprintf(peer->to, "%s %d %d\n", what, batch, calls);
  fflush(peer->to);
  signal(SIGPIPE, before);
  if (!fgets(line, sizeof line, peer->from) ||
      sscanf(line, "%lf %lf %lf", &time->wall_s, &time->cpu_s, &time->check) != 3)
    return status_fail(STATUS_IO, "PyTorch gave up on '%s' with a batch of %d", what, batch);
  return STATUS_OK;
}
