// SPDX-License-Identifier: GPL-3.0-or-later
// net/: the same weights in PyTorch. Writes networks with what net/ computes of them, then lets
// torch_compare.py compare; exit status 77, "skipped" to CTest, where PyTorch is not installed.
#include "net_suite.h"

#include <errno.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "net/files/safetensors.h"

enum { COUNT = 150, MAX_ENTRIES = 2 * NET_MAX_TENSORS + 16 };

static char directory[64];

static const char *place(const char *name, const char *suffix) {
  static char path[128];
  snprintf(path, sizeof path, "%s/%s.%s.safetensors", directory, name, suffix);
  return path;
}

static NetEntry entry_of(const char *name, NetNumber number, int rows, int columns, const void *data) {
  NetEntry entry = {
      .number = number, .rank = columns ? 2 : 1, .shape = {(size_t)rows, (size_t)columns}, .data = data};
  snprintf(entry.name, sizeof entry.name, "%s", name);
  return entry;
}

static void write_case(const char *name, int count, const NetEntry *entries) {
  NetJson *metadata = net_json_object();
  ck_net_ok(net_safetensors_write(place(name, "case"), count, entries, metadata));
  net_json_destroy(metadata);
}

static const NetCard card = {.normalisation = "none", .range = "random", .provenance = "test"};

// Outputs and input gradients in float.
static void make_single(const char *name, const NetShape *shape) {
  NetModel_f64 wide = net_suite_model(shape, 40);
  NetModel_f32 model = net_suite_narrow(&wide);
  NetWork_f32 work;
  NetWorkDef def = net_work_default();
  ck_net_ok(net_work_create_f32(model.plan, &def, &work));
  ck_net_ok(net_weights_write_f32(place(name, "weights"), &model, &card));
  NetRandom random = net_random_seeded(41, 0);
  int inputs = shape->input_count, outputs = shape->output_count;
  float *x = net_memory_zeroed((size_t)(COUNT * inputs), sizeof *x),
        *gx = net_memory_zeroed((size_t)(COUNT * inputs), 4);
  float *y = net_memory_zeroed((size_t)(COUNT * outputs), 4),
        *c = net_memory_zeroed((size_t)(COUNT * outputs), 4);
  for (int k = 0; k < COUNT * inputs; k++) x[k] = (float)net_random_between(&random, -1, 1);
  for (int k = 0; k < COUNT * outputs; k++) c[k] = (float)net_random_between(&random, -1, 1);
  net_forward_gradient_f32(&work, &model, COUNT, x, c, y, gx);
  NetEntry entries[4] = {
      entry_of("x", NET_FLOAT, COUNT, inputs, x), entry_of("y", NET_FLOAT, COUNT, outputs, y),
      entry_of("c", NET_FLOAT, COUNT, outputs, c), entry_of("gx", NET_FLOAT, COUNT, inputs, gx)};
  write_case(name, 4, entries);
  net_memory_free(x), net_memory_free(gx), net_memory_free(y), net_memory_free(c);
  net_work_destroy_f32(&work);
  net_model_destroy_f32(&model), net_model_destroy_f64(&wide);
}

// The parameters' tensors, or arrays laid out like them, under a prefix.
static int add_tensors(const NetPlan *plan, const char *prefix, const double *array, NetEntry *entries) {
  for (int k = 0; k < plan->tensor_count; k++) {
    char name[NET_ENTRY_NAME];
    snprintf(name, sizeof name, "%s:%s", prefix, plan->tensors[k].name);
    entries[k] = entry_of(name, NET_DOUBLE, plan->tensors[k].rows, plan->tensors[k].columns,
                          array + plan->tensors[k].offset);
  }
  return plan->tensor_count;
}

// In double also the paper's loss, its parameter gradient, and three steps of AdamW.
static void make_double(const char *name, const NetShape *shape) {
  NetModel_f64 model = net_suite_model(shape, 42);
  NetWork_f64 work = net_suite_work(&model, 1, 0, COUNT);
  ck_net_ok(net_weights_write_f64(place(name, "weights"), &model, &card));
  NetRandom random = net_random_seeded(43, 0);
  int inputs = shape->input_count;
  double *x = net_suite_array(&random, COUNT * inputs, 1), *c = net_suite_array(&random, COUNT * 2, 1);
  double *y = net_suite_array(&random, COUNT * 2, 0), *gx = net_suite_array(&random, COUNT * inputs, 0);
  double *later = net_suite_array(&random, COUNT * 2, 0);
  double *labels = net_suite_array(&random, COUNT, 1), *targets = net_suite_array(&random, COUNT, 3);
  double *gradient = net_suite_array(&random, (int)model.plan->parameter_count, 0), *first, gy[COUNT * 2],
         loss = 0;
  first = net_suite_array(&random, (int)model.plan->parameter_count, 0);
  for (int k = 0; k < COUNT; k++) labels[k] = labels[k] > 0, targets[k] = fabs(targets[k]);
  net_forward_gradient_f64(&work, &model, COUNT, x, c, y, gx);
  NetAdam_f64 adam;
  NetAdamDef def = net_adam_default();
  ck_net_ok(net_adam_create_f64(model.plan->parameter_count, &def, &adam));
  for (int step = 0; step < 3; step++) {
    net_gradient_forward_f64(&work, &model, COUNT, 0, x, NULL, later, NULL);
    double value = net_loss_paper_f64(COUNT, later, labels, targets, gy).total;
    net_gradient_backward_f64(&work, &model, COUNT, 0, gy, NULL, gradient);
    if (step == 0) {
      loss = value;
      memcpy(first, gradient, model.plan->parameter_count * sizeof *first);
    }
    net_adam_step_f64(&adam, 1e-3, gradient, model.parameters);
  }
  static NetEntry entries[MAX_ENTRIES];
  int count = 0;
  entries[count++] = entry_of("x", NET_DOUBLE, COUNT, inputs, x);
  entries[count++] = entry_of("y", NET_DOUBLE, COUNT, 2, y);
  entries[count++] = entry_of("c", NET_DOUBLE, COUNT, 2, c);
  entries[count++] = entry_of("gx", NET_DOUBLE, COUNT, inputs, gx);
  entries[count++] = entry_of("labels", NET_DOUBLE, COUNT, 0, labels);
  entries[count++] = entry_of("targets", NET_DOUBLE, COUNT, 0, targets);
  entries[count++] = entry_of("loss", NET_DOUBLE, 1, 0, &loss);
  count += add_tensors(model.plan, "gradient", first, entries + count);
  count += add_tensors(model.plan, "stepped", model.parameters, entries + count);
  write_case(name, count, entries);
  double *arrays[] = {x, c, y, gx, later, labels, targets, gradient, first};
  for (int k = 0; k < 9; k++) net_memory_free(arrays[k]);
  net_adam_destroy_f64(&adam);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}

START_TEST(networks_and_what_they_compute_are_written) {
  NetShape a = net_shape_tpn_a(), b = net_shape_tpn_b(), c = net_shape_tpn_c();
  NetShape wide = net_shape_tpn_backbone(), both = net_shape_tpn_c();
  NetShape smooth = net_shape_tpn_a(), geo = net_shape_mlp(100, 32, 3, 1);
  both.has_one_tetrahedron = false, both.input_count = 24;
  smooth.activation = NET_SILU, smooth.pool = NET_SUM, smooth.tetrahedron_skip = NET_SKIP_NONE;
  make_single("a", &a);
  make_single("b", &b);
  make_single("c", &c);
  make_single("backbone", &wide);
  make_single("smooth", &smooth);
  make_single("geo", &geo);
  make_double("a64", &a);
  make_double("b64", &b);
  make_double("c64", &c);
  make_double("both64", &both);
  make_double("smooth64", &smooth);
}
END_TEST

static void clean(void) {
  static const char *const names[] = {"a",   "b",   "c",   "backbone", "smooth",  "geo",
                                      "a64", "b64", "c64", "both64",   "smooth64"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    unlink(place(names[k], "weights")), unlink(place(names[k], "case"));
  rmdir(directory);
}

int main(void) {
  snprintf(directory, sizeof directory, "/tmp/tetlap_torch_%ld", (long)getpid());
  if (mkdir(directory, 0700) != 0) {
    fprintf(stderr, "%s: %s\n", directory, strerror(errno));
    return EXIT_FAILURE;
  }
  TCase *test_case = tcase_create("net_torch");
  tcase_add_test(test_case, networks_and_what_they_compute_are_written);
  if (suite_run("net_torch", test_case, 60) != EXIT_SUCCESS) return EXIT_FAILURE;
  char command[512];
  snprintf(command, sizeof command, "'%s' '%s/tests/net/torch_compare.py' %s", TETLAP_PYTHON,
           TETLAP_SOURCE_DIR, directory);
  fflush(stdout);
  int status = system(command);
  clean();
  return WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_FAILURE;
}
