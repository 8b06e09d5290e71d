// SPDX-License-Identifier: GPL-3.0-or-later
// What a verdict asks of a model: commands of this program, each a process that leaves one file in the
// model's folder. What is there already is not asked again.
//
//   contract.json  stress --pairs       symmetries, bounds, balance, derivatives on every class of hard pairs
//   paths.json     eval --paths         jumps of V and of its gradient
//   paper.json     eval --law paper-test
//   pairs.json     eval --law scene     pairs of pressed meshes, a fifth of them near misses
//   unseen.json    bench unseen         forces and closed paths on bodies that no training saw, an object a
//   line SCENE/compare.json  compare         a run beside the one of `clip`, for each of examples/verdict
//   (`clip` itself beside
//                               `clip-scalar`)
#ifndef TETLAP_APP_VERDICT_TASKS_H
#define TETLAP_APP_VERDICT_TASKS_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

#include "app/cli/model_names.h"
#include "base/status.h"

enum { APP_VERDICT_SCENES = 12, APP_VERDICT_TASKS = 5 + APP_VERDICT_SCENES, APP_VERDICT_WORDS = 24 };

typedef struct AppVerdictScene {
  const char *name; // examples/verdict/NAME.yaml
  const char *kind; // what it is for, in words
  bool is_quick;    // part of --quick
} AppVerdictScene;

extern const AppVerdictScene app_verdict_scenes[APP_VERDICT_SCENES];

typedef struct AppVerdictPlan {
  const char *directory; // of all models
  const char *source;    // the model's word
  AppModelName name;     // its folder in `directory`
  uint64_t seed;
  bool is_quick;
  int threads; // of each process
} AppVerdictPlan;

typedef struct AppVerdictTask {
  const char *name;      // for messages
  char output[PATH_MAX]; // there when it is done
  char log[PATH_MAX];    // what the process prints; becomes `output` where `is_printed`
  bool is_printed;
  char part[PATH_MAX]; // of a file that grows: what becomes `output` when the process has ended; "": nothing
  char texts[6][PATH_MAX]; // words that are made
  const char *words[APP_VERDICT_WORDS];
} AppVerdictTask;

// Task `index` of a plan; false: --quick leaves it out. STATUS_INPUT, STATUS_IO: a path is too long, or the
// scenes are not where the program's data are.
Status app_verdict_task(const AppVerdictPlan *plan, int index, AppVerdictTask *task, bool *is_wanted);

#endif
