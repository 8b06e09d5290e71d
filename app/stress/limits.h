// SPDX-License-Identifier: GPL-3.0-or-later
// The known limits: each with its measured size, its physical or numerical reason and the counter of
// summary.json that shows it in a run. A case that meets its requirement in spite of a limit says so; one
// that is worse than its limit fails.
#ifndef TETLAP_APP_STRESS_LIMITS_H
#define TETLAP_APP_STRESS_LIMITS_H

typedef struct AppStressLimit {
  const char *name;    // of the case; "flat slabs*": of every case that begins so
  const char *models;  // separated by spaces; NULL: every model
  const char *measure; // of the case
  double worst;        // what is excused, about 1.5 times what was measured
  const char *reason;
  const char *counter; // NULL: none
} AppStressLimit;

// The first line that fits; NULL: none is known.
const AppStressLimit *app_stress_limits_find(const char *name, const char *model, const char *measure);

#endif
