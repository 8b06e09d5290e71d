// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/closing.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/text.h"
#include "fem/run/result/run_result.h"

// The lines of a text, the first of them behind a label ("": none).
static void print_block(const char *label, const char *text) {
  while (text) {
    const char *end = strchr(text, '\n');
    log_info("%-12s %.*s", label, end ? (int)(end - text) : (int)strlen(text), text);
    label = "";
    text = end ? end + 1 : NULL;
  }
}

static void print_line(const char *label, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void print_line(const char *label, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  print_block(label, text);
}

// Of a static scene: what went in, and what of it is found again.
static void print_work(const FemAudit *audit, bool has_fallen) {
  double lost = fabs(fem_audit_lost(audit));
  print_line("energy:", "%.3g J in the scene (the largest of its parts)", audit->scale);
  print_line("", "%.3g J of work was done on the bodies", audit->work);
  print_line("", "%.3g J of it went into friction and plasticity", audit->dissipated);
  print_line("", "%.3g J (%.2g %%) is the difference of work and energy", lost, 100 * lost / audit->scale);
  if (audit->open > 0)
    print_line("", "the work may be wrong by %.3g J: shorter load steps reduce that", audit->open);
  if (has_fallen) print_line("", "bodies have snapped or fallen on the way, which lost energy");
}

// What was lost, apart into what was asked for and the integrator's own.
static void print_energy(const FemAudit *audit, const FemAuditBounds *bounds, bool has_risen) {
  double lost = fem_audit_lost(audit);
  const bool is_bound = lost > 0 && audit->uncertain > 0.1 * lost;
  print_line("energy:", "%.3g J in the scene (the largest of its parts)", audit->scale);
  print_line("", "%.3g J went into damping, friction and plasticity", audit->dissipated);
  print_line("", "%.3g J (%.2g %%) %s by the integrator%s", fabs(lost), 100 * fabs(lost) / audit->scale,
             lost < 0 ? "gained" : "lost", is_bound ? ", at most" : "");
  print_line("", "%.2g %% is the largest rise of the total, %.2g %% is allowed",
             100 * audit->gain / audit->scale, 100 * bounds->run);
  if (has_risen && audit->gain <= bounds->run * audit->scale)
    print_line("", "while there was less energy in the scene, a rise was a larger share: see trouble");
}

// Who answered the pairs, where a network took part.
static void print_network(const ContactPairCounts *pairs) {
  if (pairs->by_net == 0 && pairs->beyond == 0) return;
  double share = 100.0 / (double)pairs->tried;
  print_line("network:", "%lld pairs were asked for", pairs->tried);
  print_line("", "%.1f %% were answered by the network", share * (double)(pairs->by_net - pairs->blended));
  if (pairs->fallbacks > 0) print_line("", "%.1f %% by the exact model", share * (double)pairs->fallbacks);
  if (pairs->blended > 0) print_line("", "%.1f %% by both together", share * (double)pairs->blended);
  print_line("", "%lld pairs are beyond the range of its training", pairs->beyond);
}

static void print_files(const AppJob *job) {
  print_line("files:", "%s: %s%ssummary.json, manifest.json", job->directory,
             job->scene.write_vtu ? "frames.pvd (ParaView), " : "",
             job->scene.history == FEM_HISTORY_NONE ? "" : "history.csv, ");
  if (job->scene.checkpoint_frames != 0) print_line("", "end.h5, from which another scene may start");
  print_line("", "`tetlap report %s` makes a web page of them", job->directory);
}

void app_closing_print(const AppJob *job, const FemRunResult *result) {
  char text[4096];
  print_line("reached:", "t = %g s in %.2f s of computing", result->end_time, result->cost.wall_s);
  print_line("steps:", "%lld", result->integrator.steps);
  print_line("", "factorisations of the matrix: %lld", result->matrix.solver.factorisations);
  if (job->scene.contact.is_on)
    print_line("overlaps:", "%d pairs of elements at once, at most", result->contact.pairs_max);
  if (result->contact.is_on && !result->contact.asks_model)
    print_line("", "contact is with obstacles without elements only: its forces use no overlap model");
  for (int i = 0; i < result->account.contact_count; i++)
    print_block("contact:", result->account.contacts[i]);
  if (job->scene.contact.is_on && !(result->contact.force_max > 0))
    print_line("contact:", "nothing has touched");
  print_network(&result->contact.pairs);
  if (result->is_static)
    print_work(&result->energy.audit, result->equilibrium.relaxation_steps > 0);
  else
    print_energy(&result->energy.audit, &result->energy.bounds,
                 result->trouble.of[FEM_TROUBLE_ENERGY].steps > 0);
  fem_run_describe_statistics(result, text, sizeof text);
  print_block("statistics:", text);
  print_files(job);
  fem_run_describe_trouble(result, &job->model, text, sizeof text);
  print_block("trouble:", text);
}
