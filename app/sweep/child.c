// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/machine/clock.h"

static const struct timespec PAUSE = {.tv_nsec = 10 * 1000 * 1000};

// In the child; what fails here shows as exit code 127.
static void become(char *const *arguments, int log, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (getppid() != parent || nothing < 0) _exit(127); // the parent has gone meanwhile
  if (dup2(nothing, STDIN_FILENO) < 0 || dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0)
    _exit(127);
  execv("/proc/self/exe", arguments);
  _exit(127);
}

Status app_sweep_child_start(char *const *arguments, const char *log, pid_t *child) {
  int file = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0) return status_fail(STATUS_IO, "%s: cannot be written: %s", log, strerror(errno));
  pid_t parent = getpid();
  *child = fork();
  if (*child == 0) become(arguments, file, parent);
  int error = errno;
  close(file);
  if (*child > 0) return STATUS_OK;
  return status_fail(STATUS_IO, "no process can be started: %s", strerror(error));
}

bool app_sweep_child_has_ended(pid_t child, int *exit_code) {
  int state;
  pid_t ended = waitpid(child, &state, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  *exit_code = ended < 0 ? 127 : WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
  return true;
}

static void signal_all(const pid_t *children, const bool *has_ended, int count, int number) {
  for (int k = 0; k < count; k++)
    if (children[k] > 0 && !has_ended[k]) kill(children[k], number);
}

static bool have_ended(const pid_t *children, bool *has_ended, int count) {
  bool all = true;
  int code;
  for (int k = 0; k < count; k++) {
    if (children[k] > 0 && !has_ended[k]) has_ended[k] = app_sweep_child_has_ended(children[k], &code);
    all = all && (children[k] <= 0 || has_ended[k]);
  }
  return all;
}

void app_sweep_child_stop(const pid_t *children, int count, double patience_s) {
  bool has_ended[APP_SWEEP_MAX_JOBS] = {false};
  if (count > APP_SWEEP_MAX_JOBS) count = APP_SWEEP_MAX_JOBS;
  signal_all(children, has_ended, count, SIGTERM);
  double asked_s = clock_wall_s();
  while (!have_ended(children, has_ended, count) && clock_wall_s() - asked_s < patience_s)
    nanosleep(&PAUSE, NULL);
  signal_all(children, has_ended, count, SIGKILL);
  while (!have_ended(children, has_ended, count)) nanosleep(&PAUSE, NULL);
}
