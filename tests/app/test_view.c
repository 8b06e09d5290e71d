// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap view`: what its server answers, to whom, and what it never gives away; app/job/beacon.h.
#include "folder.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/view/server.h"
#include "base/files/confine.h"
#include "base/files/file.h"
#include "base/files/record.h"
#include "base/memory.h"

static const char secret[] = "the-secret-of-another-folder";
static pid_t server;
static int port;

static void write_text(const char *name, const char *text) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  ck_assert_int_eq(fclose(file), 0);
}

static void make_folder(void) {
  char path[128];
  folder_make();
  snprintf(path, sizeof path, "%s/run", folder);
  ck_assert_int_eq(mkdir(path, 0777), 0);
  write_text("secret.csv", secret);
}

// `tetlap WORDS… FOLDER/run`, its standard output to `out`.
static pid_t start(const char *command, const char *option, const char *value, const char *last, int out) {
  char run[128];
  snprintf(run, sizeof run, "%s/run", folder);
  pid_t child = fork();
  if (child == 0) {
    dup2(out, STDOUT_FILENO);
    freopen("/dev/null", "w", stderr);
    execl(TETLAP_PROGRAM, "tetlap", command, option, value, last ? last : run, last ? "-o" : "-q",
          last ? run : (char *)NULL, (char *)NULL);
    _exit(127);
  }
  ck_assert_int_gt(child, 0);
  return child;
}

static void start_server(void) {
  int ends[2];
  char line[128] = "";
  ck_assert_int_eq(pipe(ends), 0);
  server = start("view", "--port", "0", NULL, ends[1]);
  close(ends[1]);
  FILE *out = fdopen(ends[0], "r");
  ck_assert_ptr_nonnull(fgets(line, sizeof line, out));
  ck_assert_int_eq(sscanf(line, "http://127.0.0.1:%d/", &port), 1);
  fclose(out);
}

static int end(pid_t child) {
  int state;
  ck_assert_int_eq(kill(child, SIGINT), 0);
  ck_assert_int_eq(waitpid(child, &state, 0), child);
  return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

// The whole reply to a request that is sent as it stands; owned by the caller.
static char *talk(const char *request) {
  enum { ROOM = 1 << 23 };
  struct sockaddr_in address = {
      .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  int line = socket(AF_INET, SOCK_STREAM, 0);
  ck_assert_int_eq(connect(line, (struct sockaddr *)&address, sizeof address), 0);
  ck_assert_int_eq(write(line, request, strlen(request)), (int)strlen(request));
  char *reply = memory_zeroed(ROOM, 1);
  size_t used = 0;
  for (ssize_t got; used < ROOM - 1 && (got = read(line, reply + used, ROOM - 1 - used)) > 0;)
    used += (size_t)got;
  close(line);
  return reply;
}

static char *ask(const char *method, const char *path, const char *host, const char *headers) {
  char request[512], own[64];
  snprintf(own, sizeof own, "127.0.0.1:%d", port);
  snprintf(request, sizeof request, "%s %s HTTP/1.1\r\nHost: %s\r\n%sConnection: close\r\n\r\n", method, path,
           host ? host : own, headers ? headers : "");
  return talk(request);
}

static int code_of(const char *reply) {
  int code = 0;
  sscanf(reply, "HTTP/%*s %d", &code);
  return code;
}

static void expect(int code, const char *method, const char *path, const char *host, const char *headers) {
  char *reply = ask(method, path, host, headers);
  ck_assert_msg(code_of(reply) == code, "%s %s, %s, %s: %.60s", method, path, host ? host : "own host",
                headers ? headers : "", reply);
  ck_assert_msg(strstr(reply, secret) == NULL, "%s gave the secret away", path);
  memory_free(reply);
}

static void expect_outcome(const char *outcome) {
  char *reply = ask("GET", "/state", NULL, NULL), wanted[64];
  snprintf(wanted, sizeof wanted, "\"outcome\":\"%s\"", outcome);
  ck_assert_int_eq(code_of(reply), 200);
  ck_assert_msg(strstr(reply, wanted) != NULL, "%s is not in %s", wanted, reply);
  memory_free(reply);
}

START_TEST(it_answers_this_machine_under_its_own_name_only) {
  char host[64];
  start_server();
  expect(200, "GET", "/", NULL, NULL);
  expect(200, "GET", "/state", NULL, NULL);
  snprintf(host, sizeof host, "localhost:%d", port);
  expect(200, "GET", "/state", host, NULL);
  snprintf(host, sizeof host, "attacker.example:%d", port);
  expect(403, "GET", "/", host, NULL); // DNS rebinding
  expect(403, "GET", "/state", "127.0.0.1", NULL);
  expect(403, "GET", "/state", "127.0.0.1:1", NULL);
  expect(403, "GET", "/state", NULL, "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: cors\r\n");
  expect(403, "GET", "/", NULL, "Sec-Fetch-Site: same-site\r\nSec-Fetch-Mode: no-cors\r\n");
  expect(200, "GET", "/", NULL, "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n");
  expect(200, "GET", "/state", NULL, "Sec-Fetch-Site: same-origin\r\n");
  expect(405, "POST", "/state", NULL, "Content-Length: 0\r\n");
  char *nameless = talk("GET / HTTP/1.0\r\n\r\n");
  ck_assert_int_eq(code_of(nameless), 403);
  memory_free(nameless);
  ck_assert_int_eq(end(server), 0);
}
END_TEST

// The table of the kernel: the address that the port is bound to, as hexadecimal 127.0.0.1.
START_TEST(it_listens_on_the_loopback_address_only) {
  char line[256], own[64], any[64];
  bool is_bound = false;
  start_server();
  snprintf(own, sizeof own, ": 0100007F:%04X 00000000:0000 0A", (unsigned)port);
  snprintf(any, sizeof any, ":%04X ", (unsigned)port);
  FILE *table = fopen("/proc/net/tcp", "r");
  ck_assert_ptr_nonnull(table);
  while (fgets(line, sizeof line, table)) is_bound = is_bound || strstr(line, own);
  fclose(table);
  ck_assert(is_bound);
  table = fopen("/proc/net/tcp6", "r");
  while (table && fgets(line, sizeof line, table)) {
    line[45] = 0; // up to the local port
    ck_assert_ptr_null(strstr(line, any));
  }
  if (table) fclose(table);
  ck_assert_int_eq(end(server), 0);
}
END_TEST

START_TEST(no_path_leads_to_a_file) {
  static const char *const paths[] = {"/../secret.csv",          "/%2e%2e/secret.csv",  "/..%2fsecret.csv",
                                      "/run/../../secret.csv",   "//secret.csv",        "/history.csv",
                                      "/../../../../etc/passwd", "/state/../secret.csv"};
  write_text("run/history.csv", "time_s\n0\n");
  start_server();
  for (size_t k = 0; k < sizeof paths / sizeof *paths; k++) {
    char *reply = ask("GET", paths[k], NULL, NULL);
    ck_assert_msg(code_of(reply) == 404 || code_of(reply) == 400, "%s: %.60s", paths[k], reply);
    ck_assert_ptr_null(strstr(reply, secret));
    ck_assert_ptr_null(strstr(reply, "root:"));
    memory_free(reply);
  }
  ck_assert_int_eq(end(server), 0);
}
END_TEST

static void remove_file(const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  ck_assert_int_eq(unlink(path), 0);
}

static void list_frame(const char *name) {
  char text[512];
  snprintf(text, sizeof text,
           "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n"
           "<DataSet timestep=\"0\" part=\"0\" file=\"%s\"/>\n</Collection>\n</VTKFile>\n",
           name);
  write_text("run/frames.pvd", text);
}

static void link_out(const char *name, const char *target) {
  char path[128];
  snprintf(path, sizeof path, "%s/run/%s", folder, name);
  ck_assert_int_eq(symlink(target, path), 0);
}

START_TEST(links_and_lists_that_lead_out_are_not_followed) {
  start_server();
  link_out("history.csv", "../secret.csv");
  expect(403, "GET", "/", NULL, NULL);
  expect(403, "GET", "/state", NULL, NULL);
  remove_file("run/history.csv");
  expect(200, "GET", "/", NULL, NULL);
  link_out("frames", "..");
  static const char *const files[] = {"../secret.csv", "/etc/passwd", "frames/secret.csv", "./../secret.csv",
                                      "frames"};
  for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
    list_frame(files[k]);
    char *reply = ask("GET", "/", NULL, NULL);
    ck_assert_msg(code_of(reply) == 403, "%s: %.60s", files[k], reply);
    ck_assert_ptr_nonnull(strstr(reply, "leads out"));
    ck_assert_ptr_null(strstr(reply, secret));
    ck_assert_ptr_null(strstr(reply, "root:"));
    memory_free(reply);
  }
  ck_assert_int_eq(end(server), 0);
}
END_TEST

// Nobody writes into the pipes: who opened one to read would wait for ever.
START_TEST(a_pipe_is_refused_without_waiting) {
  char path[128];
  start_server();
  list_frame("pipe.vtu");
  snprintf(path, sizeof path, "%s/run/pipe.vtu", folder);
  ck_assert_int_eq(mkfifo(path, 0666), 0);
  expect(403, "GET", "/", NULL, NULL);
  snprintf(path, sizeof path, "%s/run/summary.json", folder);
  ck_assert_int_eq(mkfifo(path, 0666), 0);
  expect(403, "GET", "/state", NULL, NULL);
  ck_assert_int_eq(end(server), 0);
}
END_TEST

START_TEST(what_is_broken_or_gone_is_told_as_such) {
  char path[128];
  start_server();
  write_text("run/summary.json", "{");
  expect(500, "GET", "/state", NULL, NULL);
  list_frame("lost.vtu");
  remove_file("run/summary.json");
  expect(500, "GET", "/", NULL, NULL);
  remove_file("run/frames.pvd");
  snprintf(path, sizeof path, "%s/run", folder);
  ck_assert_int_eq(rmdir(path), 0);
  expect(404, "GET", "/", NULL, NULL);
  expect(404, "GET", "/state", NULL, NULL);
  ck_assert_int_eq(mkdir(path, 0777), 0);
  expect(200, "GET", "/state", NULL, NULL);
  ck_assert_int_eq(end(server), 0);
}
END_TEST

// Browsers leave out the port where it is http's own.
START_TEST(a_host_is_a_name_and_the_port_unless_that_is_80) {
  ck_assert(app_view_server_is_own_host("127.0.0.1:80", 80));
  ck_assert(app_view_server_is_own_host("127.0.0.1", 80));
  ck_assert(app_view_server_is_own_host("localhost", 80));
  ck_assert(!app_view_server_is_own_host("127.0.0.1", 8080));
  ck_assert(!app_view_server_is_own_host("attacker.example", 80));
  ck_assert(!app_view_server_is_own_host(NULL, 80));
}
END_TEST

START_TEST(a_port_that_is_taken_is_told_as_such) {
  char command[256], said[512] = "";
  start_server();
  snprintf(command, sizeof command, "%s view -p %d %s/run 2>&1", TETLAP_PROGRAM, port, folder);
  FILE *out = popen(command, "r");
  ck_assert_ptr_nonnull(fgets(said, sizeof said, out));
  ck_assert_int_eq(WEXITSTATUS(pclose(out)), 74);
  ck_assert_msg(strstr(said, "another program has it") != NULL, "%s", said);
  ck_assert_int_eq(end(server), 0);
}
END_TEST

// The whole machine as the folder: nothing is there to be shown, nothing else is refused.
START_TEST(the_root_is_a_folder_like_others) {
  char *text;
  size_t size;
  ck_assert_ok(confine_begin("/"));
  ck_assert_ok(file_read("/proc/version", &text, &size));
  memory_free(text);
  ck_assert(!confine_has_refused());
  ck_assert_ok(confine_begin("/proc/"));
  ck_assert_int_eq(file_read("/etc/passwd", &text, &size), STATUS_IO);
  ck_assert(confine_has_refused());
  ck_assert_int_eq(file_read("/proc/../etc/passwd", &text, &size), STATUS_IO);
  ck_assert_int_eq(file_read("/procfs", &text, &size), STATUS_IO);
  confine_end();
  ck_assert_ok(file_read("/etc/passwd", &text, &size));
  memory_free(text);
}
END_TEST

START_TEST(it_tells_how_far_a_run_is) {
  char text[256];
  start_server();
  expect_outcome("waiting");
  write_text("run/history.csv", "time_s,steps\n0,0\n");
  snprintf(text, sizeof text, "{\"pid\": %d, \"time\": 0.25, \"end\": 1, \"steps\": 7}", (int)getpid());
  write_text("run/progress.json", text);
  expect_outcome("running");
  char *reply = ask("GET", "/state", NULL, NULL);
  ck_assert_ptr_nonnull(strstr(reply, "0.25"));
  memory_free(reply);
  pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, NULL, 0); // there is no such process any more
  snprintf(text, sizeof text, "{\"pid\": %d, \"time\": 0.25, \"end\": 1, \"steps\": 7}", (int)child);
  write_text("run/progress.json", text);
  expect_outcome("gone");
  snprintf(text, sizeof text, "%s/run/progress.json", folder);
  ck_assert_int_eq(unlink(text), 0);
  write_text("run/summary.json", "{\"format\": 1, \"outcome\": \"finished\"}");
  expect_outcome("finished");
  ck_assert_int_eq(end(server), 0);
}
END_TEST

static bool has(const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s/run/%s", folder, name);
  return file_exists(path);
}

START_TEST(a_run_tells_how_far_it_is_while_it_goes_on) {
  char path[128];
  pid_t run = start("run", "--set", "time.end=50", TETLAP_SOURCE_DIR "/examples/01_drop.yaml", 1);
  for (int k = 0; k < 3000 && !has("progress.json"); k++)
    nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
  Record *progress;
  snprintf(path, sizeof path, "%s/run/progress.json", folder);
  ck_assert_ok(record_read(&progress, path));
  ck_assert_near(record_find_number(progress, "pid"), run, 0);
  ck_assert_near(record_find_number(progress, "end"), 50, 0);
  ck_assert(record_find_number(progress, "time") > 0);
  ck_assert(record_find_number(progress, "steps") >= 1);
  record_destroy(progress);
  ck_assert(has("manifest.json"));
  start_server();
  expect_outcome("running");
  char *page = ask("GET", "/", NULL, NULL);
  ck_assert_int_eq(code_of(page), 200);
  ck_assert_ptr_nonnull(strstr(page, "connect-src 'self'"));
  ck_assert_ptr_nonnull(strstr(page, "run-0-positions"));
  memory_free(page);
  ck_assert_int_eq(end(run), 130);
  ck_assert(!has("progress.json"));
  expect_outcome("interrupted");
  ck_assert_int_eq(end(server), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("view");
  tcase_add_checked_fixture(cases, make_folder, folder_remove);
  tcase_add_test(cases, it_answers_this_machine_under_its_own_name_only);
  tcase_add_test(cases, it_listens_on_the_loopback_address_only);
  tcase_add_test(cases, no_path_leads_to_a_file);
  tcase_add_test(cases, links_and_lists_that_lead_out_are_not_followed);
  tcase_add_test(cases, a_pipe_is_refused_without_waiting);
  tcase_add_test(cases, what_is_broken_or_gone_is_told_as_such);
  tcase_add_test(cases, a_host_is_a_name_and_the_port_unless_that_is_80);
  tcase_add_test(cases, a_port_that_is_taken_is_told_as_such);
  tcase_add_test(cases, the_root_is_a_folder_like_others);
  tcase_add_test(cases, it_tells_how_far_a_run_is);
  tcase_add_test(cases, a_run_tells_how_far_it_is_while_it_goes_on);
  return suite_run("view", cases, 60);
}
