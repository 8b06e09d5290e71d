// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <limits.h>
#include <omp.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/job/job.h"
#include "app/poses/poses.h"
#include "app/scene/read.h"
#include "base/files/file.h"
#include "base/log.h"
#include "fem/model/build.h"

typedef struct Options {
  const char *scene, *file, *body, *device, *output;
  const char *overrides[APP_MAX_OVERRIDES];
  int override_count, random_count, threads;
  bool has_seed, has_shift, has_turn; // how --random draws is said
  uint64_t seed;
  double shift, turn; // shift < 0: a tenth of the body's length
} Options;

static const AppOption option_table[] = {
    {"poses", 0, "FILE",
     "Poses, a line of 12 numbers each: a rotation R row by row, then a shift t, for x' = R x + t", 1,
     CLI_TEXT, CLI_TO(Options, file)},
    {"random", 0, "N", "N random poses around that of the scene", 1, CLI_INTEGER,
     CLI_TO(Options, random_count), 1, INT_MAX / 16},
    {"body", 0, "NAME", "The body or obstacle that is posed (default: the first)", 1, CLI_TEXT,
     CLI_TO(Options, body)},
    {"shift", 0, "LENGTH",
     "With --random: largest shift in each coordinate [m] (default: a tenth of the smallest body)", 2,
     CLI_NUMBER, CLI_TO(Options, shift), 0, 1e300, .mark_offset = offsetof(Options, has_shift)},
    {"turn", 0, "ANGLE", "With --random: largest rotation [rad] (default: 0.2)", 2, CLI_NUMBER,
     CLI_TO(Options, turn), 0, 1e3, .mark_offset = offsetof(Options, has_turn)},
    {"seed", 0, "N", "With --random: seed of the random numbers (default: 1)", 2, CLI_SEED,
     CLI_TO(Options, seed), .mark_offset = offsetof(Options, has_seed)},
    {"device", 'D', "NAME",
     "host, opencl, cuda or auto, or with a number (opencl:1); default: this processor's vectors. The "
     "answers are "
     "the same to the bit",
     3, CLI_TEXT, CLI_TO(Options, device)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene; may be repeated", 3, CLI_REPEATED,
     CLI_TO(Options, overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(Options, override_count)},
    {"threads", 't', "N", "Use N threads (default: all)", 3, CLI_INTEGER, CLI_TO(Options, threads), 1,
     APP_CLI_MOST_THREADS},
    {"output", 'o', "FILE", "Write the table there (default: standard output)", 3, CLI_TEXT,
     CLI_TO(Options, output)},
    {0},
};

static Status find_body(const FemModel *model, const char *name, int *body) {
  char known[1024];
  size_t used = 0;
  known[0] = 0;
  *body = 0;
  for (int b = 0; b < model->body_count; b++) {
    if (!name || strcmp(model->bodies[b].name, name) == 0) {
      *body = b;
      return STATUS_OK;
    }
    used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", b ? ", " : "", model->bodies[b].name);
    if (used >= sizeof known) break;
  }
  return status_fail(STATUS_USAGE, "--body: the scene has no body '%s' with a mesh; it has %s", name, known);
}

static void print_table(const AppPosesResult *result, int count, FILE *stream) {
  fputs("pose,V,fx,fy,fz,mx,my,mz\n", stream);
  for (int i = 0; i < count; i++) {
    const double *sum = result->sums + DEVICE_POSE_SUMS * (size_t)i;
    fprintf(stream, "%d", i);
    for (int k = 0; k < DEVICE_POSE_SUMS; k++) fprintf(stream, ",%.17g", sum[k]);
    fputc('\n', stream);
  }
}

static Status write_table(const AppPosesResult *result, int count, const char *path) {
  FileWriter writer;
  if (!path) {
    print_table(result, count, stdout);
    return fflush(stdout) == 0 ? STATUS_OK : status_fail(STATUS_IO, "standard output cannot be written");
  }
  TRY(file_begin(&writer, path));
  print_table(result, count, writer.stream);
  Status status = file_commit(&writer);
  file_abandon(&writer);
  return status;
}

static void log_result(const AppPosesResult *result, int count, const Device *device) {
  const double pairs = (double)result->pair_count;
  log_info("%d poses of %.4g pairs by %s: %.3g s, %.3g poses/s, %.3g pairs/s (%.3g a processor second)",
           count, pairs / count, device ? device->info.name : "this processor's vectors", result->eval_s,
           count / result->eval_s, pairs / result->eval_s, pairs / result->eval_cpu_s);
  log_info("%.3g s to find the pairs", result->find_s);
  if (result->handed_on > 0)
    log_info("%lld pairs were doubtful and left to this processor", result->handed_on);
}

static Status make_list(const Options *options, const FemModel *model, int body, AppPosesList *list) {
  double centre[3];
  if (options->file) return app_poses_list_read(list, options->file);
  app_poses_centre(model, body, centre);
  const double shift = options->shift < 0 ? 0.1 * model->length : options->shift;
  return app_poses_list_draw(list, options->random_count, options->seed, centre, shift, options->turn);
}

static Status run_model(const Options *options, const FemModel *model, const Device *device) {
  AppPosesList list = {0};
  AppPosesResult result = {0};
  int body;
  TRY(find_body(model, options->body, &body));
  if (model->body_count < 2)
    return status_fail(STATUS_INPUT, "%s: a second body or obstacle with a mesh is needed to overlap with",
                       options->scene);
  TRY(make_list(options, model, body, &list));
  Status status = app_poses_run(&result, model, body, &list, device);
  if (!status) status = write_table(&result, list.count, options->output);
  if (!status) log_result(&result, list.count, device);
  app_poses_destroy(&result);
  app_poses_list_destroy(&list);
  return status;
}

static Status run_scene(const Options *options, const FemSceneDef *scene) {
  FemModel model;
  Device device = {0};
  TRY(fem_model_create(&model, scene));
  Status status = options->device ? device_open(&device, options->device) : STATUS_OK;
  if (!status) status = run_model(options, &model, options->device ? &device : NULL);
  device_close(&device);
  fem_model_destroy(&model);
  return status;
}

static Status run(const Options *options) {
  FemSceneDef scene;
  if (options->threads) omp_set_num_threads(options->threads);
  TRY(app_scene_read(options->scene, options->overrides, options->override_count, &scene));
  Status status = run_scene(options, &scene);
  fem_scene_destroy(&scene);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  const char *drawing = options->has_turn    ? "turn"
                        : options->has_shift ? "shift"
                        : options->has_seed  ? "seed"
                                             : NULL;
  if (!options->file == !options->random_count) argp_error(state, "give either --poses FILE or --random N");
  if (drawing && !options->random_count)
    argp_error(
        state,
        "--%s is of random poses, and those of --poses are as in its file; leave it out, or give --random N",
        drawing);
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.seed = 1, .shift = -1, .turn = 0.2};
  app_cli_parse(&app_command_poses, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand app_command_poses = {
    .name = "poses",
    .help = "overlap volume and wrench of many poses of a body",
    .options = option_table,
    .arguments =
        &(const AppArguments){"SCENE", offsetof(Options, scene), 1,
                              .missing =
                                  "name a scene, as in tetlap poses examples/02_two_blocks.yaml --random 100",
                              .excess = "'%s' is one argument too many: poses takes one scene"},
    .doc = "Evaluate many rigid poses of one of a scene's bodies against all others: a line a pose with the "
           "overlap volume V [m³], the force f = −∂V/∂t [m²] and the moment m [m³] about the body's centre "
           "that a pressure of 1 Pa would exert on it. Obstacles without elements are left out. "
           "See docs/devices.md.",
    .check = check,
    .run = run_command,
    .has_threads = true};
