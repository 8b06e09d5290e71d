// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // pipe2
#endif
#include "app/render/browser.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"

enum { TO_BROWSER = 3, FROM_BROWSER = 4 }; // the descriptors at which Chromium expects the pipes

static const char *const names[] = {"chromium", "chromium-browser", "google-chrome"};

// In the child: the pipes to their places (above all others first, so that neither is overwritten).
static void become(int commands, int answers, const char *profile) {
  char user_data[512];
  snprintf(user_data, sizeof user_data, "--user-data-dir=%s", profile);
  int in = fcntl(commands, F_DUPFD, 10), out = fcntl(answers, F_DUPFD, 10);
  int nothing = open("/dev/null", O_RDWR);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
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

static Status make_profile(AppRenderBrowser *browser) {
  const char *folder = getenv("TMPDIR");
  char name[256];
  snprintf(name, sizeof name, "%s/tetlap-render-XXXXXX", folder ? folder : "/tmp");
  if (!mkdtemp(name)) return status_fail(STATUS_IO, "%s: no folder can be made there", name);
  browser->profile = memory_copy(name, strlen(name) + 1, 1);
  return browser->profile ? STATUS_OK : status_no_memory("a file name");
}

static Status start(AppRenderBrowser *browser) {
  int commands[2], answers[2];
  TRY(make_profile(browser));
  signal(SIGPIPE, SIG_IGN); // a browser that is gone shows as a failed call
  if (pipe2(commands, O_CLOEXEC) != 0 || pipe2(answers, O_CLOEXEC) != 0)
    return status_fail(STATUS_IO, "no pipe can be made");
  browser->process = fork();
  if (browser->process == 0) become(commands[0], answers[1], browser->profile);
  close(commands[0]), close(answers[1]);
  browser->to = commands[1];
  browser->from = fdopen(answers[0], "r");
  return browser->process > 0 && browser->from ? STATUS_OK
                                               : status_fail(STATUS_IO, "no process can be started");
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
  char *line = NULL;
  size_t room = 0;
  Status status = STATUS_OK;
  for (ssize_t length; !status && !*answer && (length = getdelim(&line, &room, 0, browser->from)) > 0;) {
    Record *one;
    status = record_parse(&one, line, (size_t)length - (line[length - 1] == 0), "Chromium");
    if (!status && (int)record_find_number(one, "id") == id)
      *answer = one;
    else if (!status)
      record_destroy(one);
  }
  free(line); // by getdelim
  if (status) return status;
  if (!*answer) return fail_gone();
  const char *error = record_find_text(record_find(*answer, "error"), "message");
  if (!error) return STATUS_OK;
  status = status_fail(STATUS_IO, "Chromium, %s: %s", method, error);
  record_destroy(*answer);
  *answer = NULL;
  return status;
}

// A call whose answer says nothing.
static Status tell(AppRenderBrowser *browser, const char *method, Record *params) {
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
  return tell(browser, "Page.navigate", params);
}

static Status set_size(AppRenderBrowser *browser, int width, int height) {
  Record *params = record_new();
  record_integer(params, "width", width);
  record_integer(params, "height", height);
  record_number(params, "deviceScaleFactor", 1);
  record_bool(params, "mobile", false);
  return tell(browser, "Emulation.setDeviceMetricsOverride", params);
}

Status app_render_browser_start(AppRenderBrowser *browser, const char *url, int width, int height) {
  *browser = (AppRenderBrowser){.to = -1};
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

static void remove_profile(const char *profile) {
  pid_t child = fork();
  if (child == 0) {
    execlp("rm", "rm", "-rf", "--", profile, (char *)NULL);
    _exit(127);
  }
  if (child > 0) waitpid(child, NULL, 0);
}

void app_render_browser_stop(AppRenderBrowser *browser) {
  if (browser->process > 0) end(browser->process);
  if (browser->to >= 0) close(browser->to);
  if (browser->from) fclose(browser->from);
  if (browser->profile) remove_profile(browser->profile);
  memory_free(browser->profile);
  memory_free(browser->session);
  *browser = (AppRenderBrowser){.to = -1};
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
