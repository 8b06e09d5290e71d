// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/all.h"

#include "app/stress/pairs/pairs.h"
#include "app/stress/scenes.h"

Status app_stress_all_run(const AppStressOptions *options, AppStress *stress) {
  *stress = (AppStress){0};
  if (options->has_pairs) TRY(app_stress_pairs_run(options, stress));
  if (options->has_scenes) TRY(app_stress_scenes_run(options, stress));
  if (stress->count > 0) return STATUS_OK;
  if (options->only && options->models)
    return status_fail(STATUS_USAGE, "no case with '%s' in its name has a model of '%s'", options->only,
                       options->models);
  if (options->only) return status_fail(STATUS_USAGE, "no case has '%s' in its name", options->only);
  return status_fail(STATUS_USAGE, "no case has a model of '%s'", options->models ? options->models : "");
}
