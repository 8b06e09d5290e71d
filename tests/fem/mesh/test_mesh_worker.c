// SPDX-License-Identifier: GPL-3.0-or-later
// Reading meshes in a process of its own: readers that crash, and the subcommand.
#include "mesh_files.h"

#include <errno.h>
#include <omp.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/command/commands.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/mesh/reader/gmsh_library.h"
#include "fem/mesh/reader/worker.h"

START_TEST(reading_leaves_threads_signals_and_output_alone) {
  struct sigaction before, after;
  omp_set_num_threads(3);
  ck_assert_int_eq(sigaction(SIGINT, NULL, &before), 0);
  fflush(stdout), fflush(stderr);
  int saved_out = dup(STDOUT_FILENO), saved_error = dup(STDERR_FILENO);
  FILE *catcher = fopen(scratch("out"), "w+");
  dup2(fileno(catcher), STDOUT_FILENO), dup2(fileno(catcher), STDERR_FILENO);
  FemMesh mesh;
  put("a.geo", "Printf(\"shouting\"); Merge \"nothing.stl\"; "
               "Point(1)={0,0,0};\n");
  Status refused = fem_mesh_read(&mesh, scratch("a.geo"), NULL, NULL);
  Status read = fem_mesh_read(&mesh, DATA "box.geo", NULL, NULL);
  fflush(stdout), fflush(stderr);
  dup2(saved_out, STDOUT_FILENO), dup2(saved_error, STDERR_FILENO);
  close(saved_out), close(saved_error);
  ck_assert_int_eq(refused, STATUS_INPUT);
  ck_assert_ok(read);
  fseek(catcher, 0, SEEK_END);
  ck_assert_int_eq(ftell(catcher), 0);
  fclose(catcher);
  ck_assert_int_eq(omp_get_max_threads(), 3);
  ck_assert_int_eq(sigaction(SIGINT, NULL, &after), 0);
  ck_assert(before.sa_handler == after.sa_handler);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Readers that do what gmsh has been seen to do.
static Status read_and_crash(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  raise(SIGSEGV);
  return STATUS_OK;
}
static Status read_and_exit(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  _exit(3);
}
static Status read_for_ever(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  while (pause() < 0) continue;
  return STATUS_OK;
}
static Status read_and_be_interrupted(FemMeshSource *source, const char *path,
                                      const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  raise(SIGINT);
  return STATUS_OK;
}
static Status read_too_much(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  char *block = malloc((size_t)1 << 28);
  if (!block) return status_fail(STATUS_INPUT, "no room for a quarter of a gigabyte");
  memset(block, 1, (size_t)1 << 28);
  free(block);
  return status_fail(STATUS_INPUT, "there was room");
}

// The address sanitizer's allocator does not survive a limit.
#ifdef __SANITIZE_ADDRESS__
enum { CAN_LIMIT_MEMORY = 0 };
#else
enum { CAN_LIMIT_MEMORY = 1 };
#endif

START_TEST(a_reader_that_wants_too_much_memory_gets_none) {
  FemMeshSource source;
  if (!CAN_LIMIT_MEMORY) {
    suite_skip("the address sanitizer's allocator does not survive a limit of memory");
    return;
  }
  ck_assert_int_eq(fem_mesh_worker_run(read_too_much, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "there was room"));
  ck_assert_int_eq(fem_mesh_worker_run(read_too_much, &source, "x", NULL, 1 << 20), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "no room"));
}
END_TEST

START_TEST(a_reader_that_crashes_is_a_message) {
  FemMeshSource source;
  ck_assert_int_eq(fem_mesh_worker_run(read_and_crash, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "crashed"));
  ck_assert_int_eq(fem_mesh_worker_run(read_and_exit, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "exit code 3"));
  ck_assert_int_eq(fem_mesh_worker_run(read_and_be_interrupted, &source, "x", NULL, 0), STATUS_INTERRUPTED);
  // No child is left behind.
  ck_assert_int_eq(waitpid(-1, NULL, WNOHANG), -1);
  ck_assert_int_eq(errno, ECHILD);
}
END_TEST

static volatile sig_atomic_t alarm_count;
static void count_alarm(int number) {
  (void)number;
  alarm_count = alarm_count + 1;
}

START_TEST(a_signal_that_we_handle_ends_a_reader_that_runs_on) {
  struct sigaction action = {.sa_handler = count_alarm};
  sigaction(SIGALRM, &action, NULL);
  // Repeated, so that one that comes before the wait begins is not the only one.
  timer_t timer;
  ck_assert_int_eq(timer_create(CLOCK_MONOTONIC, NULL, &timer), 0);
  timer_settime(timer, 0, &(struct itimerspec){{0, 50000000}, {0, 50000000}}, NULL);
  FemMeshSource source;
  Status status = fem_mesh_worker_run(read_for_ever, &source, "x", NULL, 0);
  timer_delete(timer);
  ck_assert_int_gt(alarm_count, 0);
  ck_assert_int_eq(status, STATUS_INTERRUPTED);
  ck_assert_int_eq(waitpid(-1, NULL, WNOHANG), -1);
}
END_TEST

// Runs the subcommand with its output in a file; `*text` is owned by the caller.
static int run_command(int count, char **arguments, char **text) {
  fflush(stdout);
  int saved = dup(STDOUT_FILENO);
  FILE *catcher = fopen(scratch("out"), "w");
  dup2(fileno(catcher), STDOUT_FILENO);
  int code = app_command_mesh.run(count, arguments);
  fflush(stdout);
  dup2(saved, STDOUT_FILENO);
  close(saved), fclose(catcher);
  size_t size;
  ck_assert_ok(file_read(scratch("out"), text, &size));
  return code;
}

START_TEST(the_command_says_what_a_mesh_holds) {
  char *text;
  char *plain[] = {"tetlap mesh", MESHES "block.msh", NULL},
       *json[] = {"tetlap mesh", "--json", MESHES "block.msh", NULL};
  ck_assert_int_eq(run_command(2, plain, &text), 0);
  const char *words[] = {"vertices     145", "tetrahedra   399", "0.008 m³",        "dihedral",
                         "min det",          "bottom (31)",      "nothing is wrong"};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    ck_assert_msg(strstr(text, words[k]) != NULL, "'%s' lacks '%s'", text, words[k]);
  memory_free(text);
  ck_assert_int_eq(run_command(3, json, &text), 0);
  const char *keys[] = {"\"vertices\": 145", "\"tetrahedra\": 399", "\"min_dihedral_degrees\"",
                        "\"remarks\": []"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
    ck_assert_msg(strstr(text, keys[k]) != NULL, "'%s' lacks '%s'", text, keys[k]);
  memory_free(text);
}
END_TEST

START_TEST(the_command_says_what_is_wrong) {
  put("a.ele", "1 4 0\n1 1 3 2 4\n");
  char path[160], *text, *plain[] = {"tetlap mesh", path, NULL};
  snprintf(path, sizeof path, "%s",
           put("a.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 .2 .2 .02\n5 9 9 9\n"));
  ck_assert_int_eq(run_command(2, plain, &text), 0);
  ck_assert_ptr_nonnull(strstr(text, "orientation was corrected: 1"));
  ck_assert_ptr_nonnull(strstr(text, "smallest dihedral angle is"));
  ck_assert_ptr_nonnull(strstr(text, "have been left out: 1"));
  memory_free(text);
  char *missing[] = {"tetlap mesh", "/no/such.msh", NULL};
  ck_assert_int_eq(run_command(2, missing, &text), 74);
  memory_free(text);
}
END_TEST

// gmsh's library is not installed while this is set (--wrap in tests/CMakeLists.txt).
static bool gmsh_is_missing;
void *__real_dlopen(const char *name, int flags);
void *__wrap_dlopen(const char *name, int flags);
char *__real_dlerror(void);
char *__wrap_dlerror(void);

void *__wrap_dlopen(const char *name, int flags) {
  return gmsh_is_missing ? NULL : __real_dlopen(name, flags);
}

char *__wrap_dlerror(void) {
  static char reason[] = "libgmsh.so: no such file";
  return gmsh_is_missing ? reason : __real_dlerror();
}

START_TEST(without_gmsh_a_message_says_what_to_install_and_tetgen_files_are_read) {
  FemMesh mesh;
  gmsh_is_missing = true;
  ck_assert_int_eq(fem_mesh_read(&mesh, TETLAP_SOURCE_DIR "/meshes/block.msh", NULL, NULL), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(),
                               "block.msh: gmsh, which reads this, cannot be loaded "
                               "(libgmsh.so: no such file); install gmsh's library, version 4."));
  put("a.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"), put("a.ele", "1 4 0\n1 1 2 3 4\n");
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL));
  fem_mesh_destroy(&mesh);
  gmsh_is_missing = false;
  ck_assert_ok(fem_mesh_read(&mesh, TETLAP_SOURCE_DIR "/meshes/block.msh", NULL, NULL));
  fem_mesh_destroy(&mesh);
}
END_TEST

int main(void) {
  // Loaded once for all tests, each of which reads in a process of its own.
  FemMeshGmshLibrary gmsh;
  if (fem_mesh_gmsh_library_load(&gmsh) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("mesh_worker");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_test(cases, reading_leaves_threads_signals_and_output_alone);
  tcase_add_test(cases, a_reader_that_crashes_is_a_message);
  tcase_add_test(cases, a_reader_that_wants_too_much_memory_gets_none);
  tcase_add_test(cases, a_signal_that_we_handle_ends_a_reader_that_runs_on);
  tcase_add_test(cases, without_gmsh_a_message_says_what_to_install_and_tetgen_files_are_read);
  tcase_add_test(cases, the_command_says_what_a_mesh_holds);
  tcase_add_test(cases, the_command_says_what_is_wrong);
  return suite_run("mesh_worker", cases, 60);
}
