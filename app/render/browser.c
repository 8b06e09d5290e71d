// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // pipe2
#endif
#include "app/render/browser.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/files/temporary.h"
#include "base/machine/clock.h"
#include "base/memory.h"

enum { TO_BROWSER = 3, FROM_BROWSER = 4 }; // the descriptors at which Chromium expects the pipes

static const char *const names[] = {"chromium", "chromium-browser", "google-chrome"};

// In the child: the pipes to their places (above all others first, so that neither is overwritten).
static void become(int commands, int answers, const char *profile) {
  char user_data[512];
  snprintf(user_data, sizeof user_data, "--user-data-dir=%s", profile);
  int in = fcntl(commands, F_DUPFD_CLOEXEC, 10), out = fcntl(answers, F_DUPFD_CLOEXEC, 10);
  int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  setpgid(0, 0); // a Ctrl-C of the terminal is the parent's to answer
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setenv("TMPDIR", profile, 1); // its own folders would be left where it is killed
  dup2(nothing, STDIN_FILENO), dup2(nothing, STDOUT_FILENO), dup2(nothing, STDERR_FILENO);
  if (dup2(in, TO_BROWSER) < 0 || dup2(out, FROM_BROWSER) < 0) _exit(127);
  const char *sandbox = geteuid() == 0 ? "--no-sandbox" : "--no-first-run"; // root has none
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    execlp(names[k], names[k], "--headless=new", "--remote-debugging-pipe", "--no-first-run",
           "--disable-extensions", "--disable-background-networking", "--disable-dev-shm-usage",
           "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--host-resolver-rules=MAP * ~NOTFOUND", sandbox, user_data, "about:blank", (char *)NULL);
  _exit(127);
}

// Our ends go to the browser's struct, which closes them; the other two are closed here.
static Status start(AppRenderBrowser *browser) {
  int commands[2], answers[2];
  TRY(temporary_directory("render", &browser->profile));
  signal(SIGPIPE, SIG_IGN); // a browser that is gone shows as a failed call
  if (pipe2(commands, O_CLOEXEC) != 0)
    return status_fail(STATUS_IO, "no pipe can be made: %s", strerror(errno));
  browser->to = commands[1];
  int reason = pipe2(answers, O_CLOEXEC) != 0 ? errno : 0;
  if (reason) {
    close(commands[0]);
    return status_fail(STATUS_IO, "no pipe can be made: %s", strerror(reason));
  }
  browser->from = answers[0];
  browser->process = fork();
  if (browser->process == 0) become(commands[0], answers[1], browser->profile);
  reason = errno;
  close(commands[0]), close(answers[1]);
  if (browser->process > 0) return STATUS_OK;
  browser->process = 0;
  return status_fail(STATUS_IO, "no process can be started: %s", strerror(reason));
}

static Status fail_gone(void) {
  return status_fail(STATUS_IO, "pictures are made by Chromium, which is not there or has ended; install it "
                                "(Debian: chromium)");
}

static bool send(int to, const char *text, size_t size) {
  for (ssize_t sent; size > 0; text += sent, size -= (size_t)sent)
    if ((sent = write(to, text, size)) <= 0) return false;
  return true;
}

// Reads until `text` holds a whole message, which ends with a 0, or `until_s` on the clock.
static Status receive(AppRenderBrowser *browser, double until_s) {
  enum { PIECE = 1 << 16 };
  while (browser->text_size == 0 || !memchr(browser->text, 0, browser->text_size)) {
    double left_s = until_s - clock_wall_s();
    struct pollfd ready = {.fd = browser->from, .events = POLLIN};
    int found = left_s > 0 ? poll(&ready, 1, (int)fmin(1000 * left_s + 1, 1e9)) : 0;
    if (found < 0)
      return status_fail(STATUS_IO, "waiting for Chromium: %s", strerror(errno)); // a signal, as by Ctrl-C
    if (found == 0)
      return status_fail(
          STATUS_IO, "Chromium has not answered for %g s; try a smaller --size, or a run with fewer frames",
          browser->patience_s);
    if (!memory_reserve((void **)&browser->text, &browser->text_room, browser->text_size + PIECE, 1))
      return status_no_memory("an answer of the browser");
    ssize_t got = read(browser->from, browser->text + browser->text_size, PIECE);
    if (got <= 0) return fail_gone();
    browser->text_size += (size_t)got;
  }
  return STATUS_OK;
}

// The next message as a record, owned by the caller.
static Status next_message(AppRenderBrowser *browser, double until_s, Record **message) {
  TRY(receive(browser, until_s));
  size_t length = strlen(browser->text);
  Status status = record_parse(message, browser->text, length, "Chromium");
  browser->text_size -= length + 1;
  memmove(browser->text, browser->text + length + 1, browser->text_size);
  return status;
}

// The answer to the call `id`; what comes before are events.
static Status wait_for_answer(AppRenderBrowser *browser, int id, Record **answer) {
  double until_s = clock_wall_s() + browser->patience_s;
  TRY(next_message(browser, until_s, answer));
  while (record_find_number(*answer, "id") != id) {
    record_destroy(*answer);
    *answer = NULL;
    TRY(next_message(browser, until_s, answer));
  }
  return STATUS_OK;
}

// Sends {id, method, params, sessionId} and gives the answer, which the caller owns; what comes between are
// events. `params` goes over.
static Status call(AppRenderBrowser *browser, const char *method, Record *params, Record **answer) {
  *answer = NULL;
  Record *message = record_new();
  int id = ++browser->last_call;
  record_integer(message, "id", id);
  record_text(message, "method", method);
  if (browser->session) record_text(message, "sessionId", browser->session);
  record_adopt(message, "params", params);
  char *text = message ? record_text_of(message) : NULL;
  record_destroy(message);
  if (!text) return status_no_memory("a message to the browser");
  bool is_sent = send(browser->to, text, strlen(text) + 1); // with the 0 that ends it
  memory_free(text);
  if (!is_sent) return fail_gone();
  TRY(wait_for_answer(browser, id, answer));
  const char *error = record_find_text(record_find(*answer, "error"), "message");
  if (!error) return STATUS_OK;
  Status status = status_fail(STATUS_IO, "Chromium, %s: %s", method, error);
  record_destroy(*answer);
  *answer = NULL;
  return status;
}

// A call whose answer has no content.
static Status command_browser(AppRenderBrowser *browser, const char *method, Record *params) {
  Record *answer;
  TRY(call(browser, method, params, &answer));
  record_destroy(answer);
  return STATUS_OK;
}

static Status open_page(AppRenderBrowser *browser, const char *url) {
  Record *params = record_new(), *answer;
  record_text(params, "url", "about:blank");
  TRY(call(browser, "Target.createTarget", params, &answer));
  const char *target = record_find_text(record_find(answer, "result"), "targetId");
  params = record_new();
  record_text(params, "targetId", target ? target : "");
  record_bool(params, "flatten", true);
  record_destroy(answer);
  TRY(call(browser, "Target.attachToTarget", params, &answer));
  const char *session = record_find_text(record_find(answer, "result"), "sessionId");
  browser->session = session ? memory_copy(session, strlen(session) + 1, 1) : NULL;
  record_destroy(answer);
  if (!browser->session) return fail_gone();
  params = record_new();
  record_text(params, "url", url);
  return command_browser(browser, "Page.navigate", params);
}

static Status set_size(AppRenderBrowser *browser, int width, int height) {
  Record *params = record_new();
  record_integer(params, "width", width);
  record_integer(params, "height", height);
  record_number(params, "deviceScaleFactor", 1);
  record_bool(params, "mobile", false);
  return command_browser(browser, "Emulation.setDeviceMetricsOverride", params);
}

Status app_render_browser_start(AppRenderBrowser *browser, const char *url, int width, int height,
                                double patience_s) {
  *browser = (AppRenderBrowser){.to = -1, .from = -1, .patience_s = patience_s};
  TRY(start(browser));
  TRY(open_page(browser, url));
  return set_size(browser, width, height);
}

// In order if it can, within two seconds.
static void end(pid_t process) {
  static const struct timespec pause = {.tv_nsec = 20 * 1000 * 1000};
  kill(process, SIGTERM);
  for (int k = 0; k < 100; k++) {
    if (waitpid(process, NULL, WNOHANG) == process) return;
    nanosleep(&pause, NULL);
  }
  kill(process, SIGKILL);
  waitpid(process, NULL, 0);
}

void app_render_browser_stop(AppRenderBrowser *browser) {
  if (browser->process > 0) end(browser->process);
  if (browser->to >= 0) close(browser->to);
  if (browser->from >= 0) close(browser->from);
  temporary_remove(browser->profile);
  memory_free(browser->text);
  memory_free(browser->session);
  *browser = (AppRenderBrowser){.to = -1, .from = -1};
}

Status app_render_browser_run(AppRenderBrowser *browser, const char *script, char **text) {
  Record *params = record_new(), *answer;
  if (text) *text = NULL;
  record_text(params, "expression", script);
  record_bool(params, "awaitPromise", true);
  record_bool(params, "returnByValue", true);
  TRY(call(browser, "Runtime.evaluate", params, &answer));
  const Record *result = record_find(answer, "result"), *failure = record_find(result, "exceptionDetails");
  const char *value = record_find_text(record_find(result, "result"), "value");
  Status status = STATUS_OK;
  if (failure) {
    const char *why = record_find_text(record_find(failure, "exception"), "description");
    if (why && strncmp(why, "Error: ", 7) == 0) why += 7;
    status = status_fail(STATUS_IO, "%.*s", why ? (int)strcspn(why, "\n") : 27,
                         why ? why : "a script of the page failed");
  } else if (text && value && !(*text = memory_copy(value, strlen(value) + 1, 1)))
    status = status_no_memory("what the page says");
  record_destroy(answer);
  return status;
}

static int digit_of(char letter) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const char *at = letter ? strchr(digits, letter) : NULL;
  return at ? (int)(at - digits) : -1;
}

// Base64 (RFC 4648) in place of the text; returns how many bytes there are.
static size_t decode(const char *text, unsigned char *bytes) {
  size_t count = 0;
  unsigned int bits = 0, held = 0;
  for (int digit; (digit = digit_of(*text)) >= 0; text++) {
    bits = (bits << 6 | (unsigned int)digit) & 0xffff;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes[count++] = (unsigned char)(bits >> held);
  }
  return count;
}

Status app_render_browser_capture(AppRenderBrowser *browser, unsigned char **png, size_t *size) {
  Record *params = record_new(), *answer;
  record_text(params, "format", "png");
  TRY(call(browser, "Page.captureScreenshot", params, &answer));
  const char *data = record_find_text(record_find(answer, "result"), "data");
  *png = data ? memory_zeroed(strlen(data) + 1, 1) : NULL;
  if (*png) *size = decode(data, *png);
  record_destroy(answer);
  return *png ? STATUS_OK : status_fail(STATUS_IO, "Chromium gave no picture");
}
