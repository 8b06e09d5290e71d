// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/plot/gnuplot.h"
#include "base/memory.h"
#include "base/text.h"

enum {
  MAX_PANELS = 12,
  MAX_FAMILIES = 12,
  COLUMNS = 2,
  PANEL_WIDTH = 520,
  PANEL_HEIGHT = 380,
  LEFT = 70, // of a panel's axes within it, in pixels
  RIGHT = 16,
  TOP = 30,
  BOTTOM = 50,
  LETTER_WIDTH = 6, // of a label
  LETTER_HEIGHT = 12,
  MAX_REACH = 16, // of a label from its point, in steps
};

typedef struct Point {
  const char *name, *family; // borrowed
  double x, y;               // time [s] and error; an error of 0 stands below the others
  double cpu;                // processor time [s]; 0: of a device, or not measured
  bool is_exact, is_frontier, is_placed;
  double px, py; // on the picture, from the panel's lower left corner [pixels]
  double lx, ly; // where its label begins, and the label's middle [pixels]
} Point;

typedef struct Panel {
  const char *quantity, *set; // borrowed
  Point *points;              // (count), owned
  int count;
  bool is_cpu; // x are processor times
  double x_low, x_high, y_low, y_high;
} Panel;

typedef struct Frontier {
  Panel panels[MAX_PANELS];
  int panel_count;
  const char *families[MAX_FAMILIES]; // borrowed
  int family_count;
} Frontier;

static const char *const hues[MAX_FAMILIES] = {"#2f6fc4", "#d2691e", "#2a8f78", "#8a56b8",
                                               "#b8487a", "#8a7a1f", "#5b6770", "#1d4e89",
                                               "#9e3324", "#417a6a", "#6f568a", "#7d7336"};

static bool is_wanted(const char *quantities, const char *quantity) {
  return !quantities || text_lists(quantities, quantity);
}

static Panel *find_panel(Frontier *frontier, const char *quantity, const char *set) {
  for (int p = 0; p < frontier->panel_count; p++)
    if (strcmp(frontier->panels[p].quantity, quantity) == 0 && strcmp(frontier->panels[p].set, set) == 0)
      return &frontier->panels[p];
  if (frontier->panel_count == MAX_PANELS) return NULL;
  Panel *panel = &frontier->panels[frontier->panel_count++];
  *panel = (Panel){.quantity = quantity, .set = set};
  return panel;
}

static int family_of(Frontier *frontier, const char *family) {
  int f = 0;
  while (f < frontier->family_count && strcmp(frontier->families[f], family) != 0) f++;
  if (f == frontier->family_count && f < MAX_FAMILIES) frontier->families[frontier->family_count++] = family;
  return f < MAX_FAMILIES ? f : MAX_FAMILIES - 1;
}

static Status add_point(Frontier *frontier, const Record *row, const char *quantities, int room) {
  const char *quantity = record_find_text(row, "quantity"), *set = record_find_text(row, "set"),
             *name = record_find_text(row, "model"), *family = record_find_text(row, "family");
  double seconds = record_find_number(row, "seconds_per_pair"), error = record_find_number(row, "error");
  if (!quantity || !set || !name || !family || !(seconds > 0) || !(error >= 0) || !isfinite(error))
    return STATUS_OK; // not measured
  Panel *panel = is_wanted(quantities, quantity) ? find_panel(frontier, quantity, set) : NULL;
  if (!panel) return STATUS_OK;
  if (!panel->points) panel->points = memory_zeroed((size_t)room, sizeof *panel->points);
  if (!panel->points) return status_no_memory("the frontier");
  const char *device = record_find_text(row, "device");
  const double cpu = record_find_number(row, "cpu_seconds_per_pair");
  family_of(frontier, family);
  panel->points[panel->count++] = (Point){.name = name,
                                          .family = family,
                                          .x = seconds,
                                          .y = error,
                                          .cpu = cpu > 0 && !(device && *device) ? cpu : 0,
                                          .is_exact = error == 0};
  return STATUS_OK;
}

// On one thread processor time says more than the clock, which other load on the machine slows.
static void choose_time(Panel *panel, bool is_single) {
  panel->is_cpu = is_single;
  for (int i = 0; i < panel->count; i++) panel->is_cpu = panel->is_cpu && panel->points[i].cpu > 0;
  for (int i = 0; i < panel->count && panel->is_cpu; i++) panel->points[i].x = panel->points[i].cpu;
}

// Nothing else is as fast and as accurate, and better in one of both.
static void mark_frontier(Panel *panel) {
  for (int i = 0; i < panel->count; i++) {
    Point *a = &panel->points[i];
    a->is_frontier = true;
    for (int j = 0; j < panel->count; j++) {
      const Point *b = &panel->points[j];
      if (b->x <= a->x && b->y <= a->y && (b->x < a->x || b->y < a->y)) a->is_frontier = false;
    }
  }
}

static int compare(const void *left, const void *right) {
  const Point *a = left, *b = right;
  return (a->x > b->x) - (a->x < b->x);
}

// Ranges with some air, places of the points on the picture.
static void lay_out(Panel *panel) {
  double x_low = INFINITY, x_high = 0, y_low = INFINITY, y_high = 0;
  for (int i = 0; i < panel->count; i++) {
    const Point *point = &panel->points[i];
    x_low = fmin(x_low, point->x), x_high = fmax(x_high, point->x);
    if (!point->is_exact) y_low = fmin(y_low, point->y), y_high = fmax(y_high, point->y);
  }
  if (!(y_high > 0)) y_low = y_high = 1e-16;
  for (int i = 0; i < panel->count; i++)
    if (panel->points[i].is_exact) panel->points[i].y = y_low / 100;
  panel->x_low = x_low / 2, panel->x_high = x_high * 3;
  panel->y_low = y_low / 1000, panel->y_high = fmin(y_high * 30, 1e6);
  for (int i = 0; i < panel->count; i++) {
    Point *point = &panel->points[i];
    point->px = LEFT + (PANEL_WIDTH - LEFT - RIGHT) * log(point->x / panel->x_low) /
                           log(panel->x_high / panel->x_low);
    point->py = BOTTOM + (PANEL_HEIGHT - TOP - BOTTOM) * log(point->y / panel->y_low) /
                             log(panel->y_high / panel->y_low);
  }
}

static double width_of(const Point *point) {
  return LETTER_WIDTH * (double)strlen(point->name) + (point->is_exact ? LETTER_WIDTH * 11 : 0);
}

// Whether the label of a point, put at (x, y), meets a point or a label that is there already.
static bool is_free(const Panel *panel, const Point *point, double x, double y) {
  double width = width_of(point);
  if (x < LEFT || x + width > PANEL_WIDTH - 2 || y < BOTTOM + 6 || y > PANEL_HEIGHT - TOP - 6) return false;
  for (int j = 0; j < panel->count; j++) {
    const Point *other = &panel->points[j];
    if (other->px > x - 5 && other->px < x + width + 5 && fabs(other->py - y) < LETTER_HEIGHT / 2 + 4)
      return false;
    if (other->is_placed && other->lx < x + width && x < other->lx + width_of(other) &&
        fabs(other->ly - y) < LETTER_HEIGHT)
      return false;
  }
  return true;
}

// Tries the eight places at that distance from the point.
static void try_places(const Panel *panel, Point *point, int reach) {
  static const int ways[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  for (int k = 0; k < 8 && !point->is_placed; k++) {
    const int *way = ways[k];
    double back = way[0] < 0 ? width_of(point) : way[0] == 0 ? width_of(point) / 2 : 0;
    double x = point->px + way[0] * (1 + 7 * reach) - back;
    double y = point->py + way[1] * (way[0] ? 9 : 14) * reach;
    point->is_placed = is_free(panel, point, x, y);
    if (point->is_placed) point->lx = x, point->ly = y;
  }
}

// First all labels that fit close to their points, then the others farther and farther away.
static void place_labels(Panel *panel) {
  for (int reach = 1; reach <= MAX_REACH; reach++)
    for (int i = 0; i < panel->count; i++)
      if (!panel->points[i].is_placed) try_places(panel, &panel->points[i], reach);
  for (int i = 0; i < panel->count; i++) {
    Point *point = &panel->points[i];
    if (!point->is_placed) point->lx = point->px + 8, point->ly = point->py; // no room at all
  }
}

static const char *words_of(const char *quantity) {
  if (strcmp(quantity, "V") == 0) return "error of V";
  if (strcmp(quantity, "V+grad") == 0) return "error of ∇V";
  return "error of the contact forces";
}

static void write_labels(FILE *script, Frontier *frontier, const Panel *panel, double left, double bottom,
                         double width, double height) {
  fputs("unset label\nunset arrow\n", script);
  for (int i = 0; i < panel->count; i++) {
    const Point *point = &panel->points[i];
    const char *hue = hues[family_of(frontier, point->family)];
    char text[128];
    snprintf(text, sizeof text, "%s%s", point->name, point->is_exact ? " (no error)" : "");
    fputs("set label ", script);
    app_gnuplot_quote(script, text);
    fprintf(script, " at screen %.5f,%.5f noenhanced font small tc rgb '%s' front\n",
            (left + point->lx) / width, (bottom + point->ly) / height, hue);
    double to = fmin(fmax(point->px, point->lx), point->lx + width_of(point));
    if (hypot(to - point->px, point->ly - point->py) > 16)
      fprintf(script, "set arrow from screen %.5f,%.5f to screen %.5f,%.5f nohead lc rgb '%s' lw 0.5\n",
              (left + point->px) / width, (bottom + point->py) / height, (left + to) / width,
              (bottom + point->ly) / height, hue);
  }
}

static void write_data(FILE *script, const Frontier *frontier, const Panel *panel, int p) {
  for (int f = 0; f < frontier->family_count; f++) {
    fprintf(script, "$p%d_%d << END\nNaN NaN NaN\n", p, f);
    for (int i = 0; i < panel->count; i++)
      if (strcmp(panel->points[i].family, frontier->families[f]) == 0)
        fprintf(script, "%.8g %.8g %d\n", panel->points[i].x, panel->points[i].y,
                panel->points[i].is_frontier ? 7 : 6);
    fputs("END\n", script);
  }
  fprintf(script, "$f%d << END\n", p);
  for (int i = 0; i < panel->count; i++)
    if (panel->points[i].is_frontier) fprintf(script, "%.8g %.8g\n", panel->points[i].x, panel->points[i].y);
  fputs("END\n", script);
}

static void write_panel(FILE *script, Frontier *frontier, int p, double width, double height) {
  const Panel *panel = &frontier->panels[p];
  double left = p % COLUMNS * PANEL_WIDTH, bottom = height - (p / COLUMNS + 1) * PANEL_HEIGHT;
  write_labels(script, frontier, panel, left, bottom, width, height);
  fprintf(script,
          "set lmargin at screen %.5f\nset rmargin at screen %.5f\nset bmargin at screen %.5f\nset tmargin "
          "at screen %.5f\n",
          (left + LEFT) / width, (left + PANEL_WIDTH - RIGHT) / width, (bottom + BOTTOM) / height,
          (bottom + PANEL_HEIGHT - TOP) / height);
  fprintf(script, "set xrange [%.8g:%.8g]\nset yrange [%.8g:%.8g]\n", panel->x_low, panel->x_high,
          panel->y_low, panel->y_high);
  fputs("set title ", script);
  char title[192];
  snprintf(title, sizeof title, "%s, %s", panel->quantity, panel->set);
  app_gnuplot_quote(script, title);
  fprintf(script, " noenhanced\nset xlabel '%stime a pair'\nset ylabel ", panel->is_cpu ? "processor " : "");
  app_gnuplot_quote(script, words_of(panel->quantity));
  fprintf(script, "\nplot $f%d using 1:2 with steps lc rgb '#999999' dt 2 notitle", p);
  for (int f = 0; f < frontier->family_count; f++)
    fprintf(script, ", \\\n  $p%d_%d using 1:2:3 with points pt variable ps 0.9 lc rgb '%s' notitle", p, f,
            hues[f]);
  fputc('\n', script);
}

static Status collect(Frontier *frontier, const Record *pareto, const char *quantities) {
  const Record *rows = record_find(pareto, "points");
  int count = record_count(rows);
  for (int k = 0; k < count; k++) TRY(add_point(frontier, record_at(rows, k), quantities, count));
  if (frontier->panel_count == 0)
    return status_fail(STATUS_INPUT, "holds no point%s to plot; expected the pareto.json of tools/measure/frontier",
                       quantities ? " of these quantities" : "");
  for (int p = 0; p < frontier->panel_count; p++) {
    Panel *panel = &frontier->panels[p];
    choose_time(panel, record_find_number(pareto, "threads") == 1);
    mark_frontier(panel);
    qsort(panel->points, (size_t)panel->count, sizeof *panel->points, compare);
    lay_out(panel);
    place_labels(panel);
  }
  return STATUS_OK;
}

static Status write(FILE *script, Frontier *frontier, const char *picture) {
  int columns = frontier->panel_count < COLUMNS ? frontier->panel_count : COLUMNS;
  int width = columns * PANEL_WIDTH, height = (frontier->panel_count + columns - 1) / columns * PANEL_HEIGHT;
  fputs("# gnuplot script; run it again with: gnuplot THIS_FILE\n", script);
  for (int p = 0; p < frontier->panel_count; p++) write_data(script, frontier, &frontier->panels[p], p);
  TRY(app_gnuplot_open(script, picture, width, height));
  fputs("set multiplot\nset logscale xy\nset border 3\nset tics nomirror\nset grid lc rgb '#e4e4e4' lt 1 lw "
        "0.5\n"
        "set format x '%.0s %cs'\nset format y '10^{%T}'\nunset key\nunset "
        "mxtics\nunset mytics\n",
        script);
  for (int p = 0; p < frontier->panel_count; p++) write_panel(script, frontier, p, width, height);
  fputs("unset multiplot\n", script);
  return STATUS_OK;
}

Status app_plot_frontier(FILE *script, const char *picture, const Record *pareto, const char *quantities) {
  Frontier frontier = {0};
  Status status = collect(&frontier, pareto, quantities);
  if (!status) status = write(script, &frontier, picture);
  for (int p = 0; p < frontier.panel_count; p++) memory_free(frontier.panels[p].points);
  return status;
}
