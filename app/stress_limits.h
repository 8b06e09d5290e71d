// SPDX-License-Identifier: GPL-3.0-or-later
// What is known not to hold: each limit with its physical or numerical reason and the counter of summary.json
// that makes it visible in a run. A case that is better than its limit says so.
#ifndef TETLAP_APP_STRESS_LIMITS_H
#define TETLAP_APP_STRESS_LIMITS_H

typedef struct AppStressLimit {
  const char *name;    // of the case
  const char *model;   // NULL: every model
  const char *measure; // of the case
  const char *reason;
  const char *counter; // NULL: none
} AppStressLimit;

// NULL: none is known.
const AppStressLimit *app_stress_limits_find(const char *name, const char *model, const char *measure);

#endif
