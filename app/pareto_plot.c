// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pareto_plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/gnuplot.h"
#include "base/file.h"
#include "base/memory.h"

enum { MAX_PANELS = 32, MAX_FAMILIES = 32, COLUMNS = 2 };

// Errors of exact arithmetic are drawn here.
static const double FLOOR = 1e-17;

// Learned models lie ten decades above the others: they have a second panel, by themselves.
typedef struct Panel {
  const char *quantity, *set; // borrowed
  bool is_learned;            // shows learned models only
} Panel;

typedef struct Plot {
  Panel panels[MAX_PANELS];
  int panel_count;
  const char *families[MAX_FAMILIES]; // borrowed
  int family_count;
} Plot;

static bool can_be_drawn(const AppParetoPoint *point) {
  return isfinite(point->cost) && isfinite(point->error);
}

static bool is_on(const Panel *panel, const AppParetoPoint *point) {
  return can_be_drawn(point) && (point->parameters > 0 || !panel->is_learned) &&
         strcmp(panel->quantity, point->quantity) == 0 && strcmp(panel->set, point->set) == 0;
}

static void note(Plot *plot, const AppParetoPoint *point) {
  int p = 0, f = 0;
  while (p < plot->panel_count && !is_on(&plot->panels[p], point)) p++;
  if (p == plot->panel_count && p + COLUMNS <= MAX_PANELS)
    for (int column = 0; column < COLUMNS; column++)
      plot->panels[plot->panel_count++] = (Panel){point->quantity, point->set, column > 0};
  while (f < plot->family_count && strcmp(plot->families[f], point->family) != 0) f++;
  if (f == plot->family_count && f < MAX_FAMILIES) plot->families[plot->family_count++] = point->family;
}

static double drawn_error(const AppParetoPoint *point) {
  return fmax(point->error, FLOOR);
}

// Of many sizes of one family only those are labelled that no other size beats.
static bool has_label(const AppPareto *pareto, const Panel *panel, const AppParetoPoint *point) {
  for (size_t i = 0; i < pareto->point_count; i++) {
    const AppParetoPoint *other = &pareto->points[i];
    if (is_on(panel, other) && strcmp(other->family, point->family) == 0 && app_pareto_beats(other, point))
      return false;
  }
  return true;
}

// The points of one family in one panel, with labels: "$d0_1".
static int write_family(FILE *stream, const AppPareto *pareto, const Plot *plot, int p, int f) {
  int count = 0;
  for (size_t i = 0; i < pareto->point_count; i++) {
    const AppParetoPoint *point = &pareto->points[i];
    if (!is_on(&plot->panels[p], point) || strcmp(plot->families[f], point->family) != 0) continue;
    if (count++ == 0) fprintf(stream, "$d%d_%d << END\n", p, f);
    fprintf(stream, "%.6g %.6g \"%s\"\n", point->cost, drawn_error(point),
            has_label(pareto, &plot->panels[p], point) ? point->model : "");
  }
  if (count > 0) fputs("END\n", stream);
  return count;
}

static int compare(const void *a, const void *b) {
  const AppParetoPoint *x = *(const AppParetoPoint *const *)a, *y = *(const AppParetoPoint *const *)b;
  return (x->cost > y->cost) - (x->cost < y->cost);
}

static bool is_best(const AppPareto *pareto, const Panel *panel, const AppParetoPoint *point) {
  for (size_t i = 0; i < pareto->point_count; i++)
    if (is_on(panel, &pareto->points[i]) && app_pareto_beats(&pareto->points[i], point)) return false;
  return true;
}

// The frontier of a panel as steps: nothing is known that lies below and left of it.
static Status write_frontier(FILE *stream, const AppPareto *pareto, const Plot *plot, int p) {
  const AppParetoPoint **front = memory_zeroed(pareto->point_count, sizeof *front);
  size_t count = 0;
  if (!front) return status_no_memory("the frontier");
  for (size_t i = 0; i < pareto->point_count; i++)
    if (is_on(&plot->panels[p], &pareto->points[i]) && is_best(pareto, &plot->panels[p], &pareto->points[i]))
      front[count++] = &pareto->points[i];
  qsort(front, count, sizeof *front, compare);
  fprintf(stream, "$f%d << END\n", p);
  for (size_t i = 0; i < count; i++) fprintf(stream, "%.6g %.6g\n", front[i]->cost, drawn_error(front[i]));
  fputs("END\n", stream);
  memory_free(front);
  return STATUS_OK;
}

static const char *words_of(const char *quantity) {
  if (strcmp(quantity, "V") == 0) return "V: sum of errors over sum of V";
  if (strcmp(quantity, "V+grad") == 0) return "∇V: sum of errors over sum of lengths";
  return "contact forces, relative";
}

static void write_panel(FILE *stream, const Plot *plot, int p, const bool *has_points) {
  const char *range = plot->panels[p].is_learned ? "[*:*]" : "[1e-18:10]",
             *which = plot->panels[p].is_learned ? ", learned models" : "";
  fprintf(stream,
          "  set yrange %s\n  set title \"%s, %s%s\" noenhanced\n  set ylabel \"%s\" noenhanced\n  plot ",
          range, plot->panels[p].quantity, plot->panels[p].set, which, words_of(plot->panels[p].quantity));
  fprintf(stream, "$f%d using 1:2 with steps lc rgb '#999999' dt 2 notitle", p);
  for (int f = 0; f < plot->family_count; f++) {
    if (!has_points[f]) continue;
    fprintf(stream,
            ", \\\n    $d%d_%d using 1:2 with points pt 7 ps 0.7 lc %d title \"%s\", \\\n"
            "    $d%d_%d using 1:2:3 with labels noenhanced font ',7' offset 0.6,0.5 left notitle",
            p, f, f + 1, plot->families[f], p, f);
  }
  fputs("\n", stream);
}

static Status write_script(FILE *stream, const AppPareto *pareto, const char *directory) {
  Plot plot = {0};
  bool has_points[MAX_PANELS][MAX_FAMILIES] = {{0}};
  for (size_t i = 0; i < pareto->point_count; i++)
    if (can_be_drawn(&pareto->points[i])) note(&plot, &pareto->points[i]);
  fputs("# gnuplot script; run it again with: gnuplot THIS_FILE\n", stream);
  for (int p = 0; p < plot.panel_count; p++) {
    for (int f = 0; f < plot.family_count; f++)
      has_points[p][f] = write_family(stream, pareto, &plot, p, f) > 0;
    TRY(write_frontier(stream, pareto, &plot, p));
  }
  int rows = (plot.panel_count + COLUMNS - 1) / COLUMNS;
  fprintf(stream,
          "directory = \"%s\"\n"
          "set logscale xy\nset format '10^{%%T}'\nset grid\nset xlabel 'seconds a pair'\n"
          "set key outside right top noenhanced font ',8'\nset xrange [*:*] noextend\n"
          "set offsets graph 0.05, graph 0.15, 0, 0\n"
          "do for [kind in 'svg png'] {\n"
          "  if (kind eq 'svg') { set terminal svg size 1200,%d dynamic }\n"
          "  if (kind eq 'png') { set terminal pngcairo size 1200,%d }\n"
          "  set output directory.'/pareto.'.kind\n"
          "  set multiplot layout %d,%d\n",
          directory, 480 * rows, 480 * rows, rows, COLUMNS);
  for (int p = 0; p < plot.panel_count; p++) {
    bool is_empty = true;
    for (int f = 0; f < plot.family_count; f++) is_empty = is_empty && !has_points[p][f];
    if (is_empty)
      fputs("  set multiplot next\n", stream);
    else
      write_panel(stream, &plot, p, has_points[p]);
  }
  fputs("  unset multiplot\n  unset output\n}\n", stream);
  return STATUS_OK;
}

static Status write(const AppPareto *pareto, const char *directory, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = write_script(writer.stream, pareto, directory);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

Status app_pareto_plot(const AppPareto *pareto, const char *directory) {
  char *script = file_join(directory, "pareto.gp");
  if (!script) return status_no_memory("the plot");
  Status status = write(pareto, directory, script);
  if (!status) status = app_gnuplot_run(script);
  memory_free(script);
  return status;
}
