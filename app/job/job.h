// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that is ready to run: read, overridden, its model built; and the options that `run` and `compare`
// share.
#ifndef TETLAP_APP_JOB_JOB_H
#define TETLAP_APP_JOB_JOB_H

#include <stdbool.h>

#include "app/cli/model_names.h"
#include "app/cli/option.h"
#include "base/files/record.h"
#include "base/log.h"
#include "fem/model/model.h"
#include "fem/run/run.h"

enum { APP_MAX_OVERRIDES = 64 };

// What the command line said.
typedef struct AppJobOptions {
  const char *scene_path;
  const char *directory; // -o; NULL: out/NAME of the scene
  const char *overrides[APP_MAX_OVERRIDES];
  int override_count;
  int threads; // 0: the scene's, else all
  bool is_quiet, is_verbose, is_json;
  bool is_progress_json; // progress as a line of JSON each
} AppJobOptions;

// The options -o, --set, --threads, --progress, -q, -v and --json, and the argument SCENE of a command whose
// own struct begins with an AppJobOptions.
extern const AppOption app_job_options[];
extern const AppArguments app_job_scene;

typedef struct AppJob {
  FemSceneDef scene;
  FemModel model;
  char *directory;      // where to write, owned
  AppModelName overlap; // what its overlap model is called; "": the scene has no contact
  Record *inputs;       // digests of what was read when it was opened (app/job/inputs.h), owned
} AppJob;

// Reads and builds. `overlap` (may be NULL) replaces the scene's overlap model; `subdirectory` (may be NULL)
// is appended to the output directory.
Status app_job_open(AppJob *job, const AppJobOptions *options, const char *overlap, const char *subdirectory);
void app_job_close(AppJob *job);

// "out/NAME" and `ending` for a scene …/NAME.yaml: where its results go by default. Owned by the caller;
// NULL: no memory.
char *app_job_default_directory(const char *scene_path, const char *ending);

// Sets the log level from -q and -v, and the flag that Ctrl-C and SIGTERM raise.
void app_job_prepare(const AppJobOptions *options);
const volatile sig_atomic_t *app_job_stop_flag(void);

// What the overlap model is called; NULL: there is none.
const char *app_job_overlap(const AppJob *job);

// A line of the log: the overlap model, its weights file, the potential. Nothing without contact.
void app_job_log_contact(const AppJob *job);

// An observer of fem_run that draws the progress line: time, step, step size, pairs, time left. Where
// standard error is no terminal, lines at the pace of base/log.h; as JSON, an object a line on standard
// error, twice a second.
typedef struct AppProgress {
  double began_s;
  const char *label; // in front; "" for none
  bool is_json;
  LogPace pace;     // of lines
  double told_at_s; // of JSON; 0: never
} AppProgress;
Status app_job_show_progress(void *progress, const FemRunProgress *state);

// Writes summary.json and manifest.json (the resolved scene, digests of meshes and weights, versions,
// processor, command) of a run that ended with `status`.
Status app_job_write_summary(const AppJob *job, const FemRunResult *result, Status status);
Status app_job_write_manifest(const AppJob *job); // the latter alone
// The same summary as a new record, owned by the caller; NULL: no memory.
Record *app_job_summary(const AppJob *job, const FemRunResult *result, Status status);

#endif
