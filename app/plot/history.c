// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/plot/gnuplot.h"
#include "base/memory.h"

enum { MAX_COLUMNS = 256, MAX_FORCES = 5, MAX_NAME = 160, PANEL_WIDTH = 470, LETTER_WIDTH = 7, HEIGHT = 620 };

static const char peak_title[] = "largest since the last row";

typedef struct History {
  char names[MAX_COLUMNS][MAX_NAME];
  double largest[MAX_COLUMNS]; // absolute value
  int count;
  int row_count;
} History;

static const char *const hues[] = {"#2f6fc4", "#d2691e", "#2a8f78", "#8a56b8", "#b8487a", "#8a7a1f"};

static void read_names(History *history, const char *line, size_t length) {
  for (const char *end = line + length; line < end && history->count < MAX_COLUMNS; line++) {
    size_t size = strcspn(line, ",\r\n");
    snprintf(history->names[history->count++], MAX_NAME, "%.*s", (int)(size < MAX_NAME ? size : MAX_NAME - 1),
             line);
    line += size;
  }
}

// A row has a number in every column: nan, inf and nothing at all count as numbers that are not there.
static Status read_row(History *history, const char *line, const char *directory) {
  const int number = history->row_count + 2; // in the file, the first is that of the names
  for (int k = 0; k < history->count; k++) {
    char *end;
    const char *expected = k + 1 < history->count ? "," : history->count < MAX_COLUMNS ? "\r\n" : ",\r\n";
    double value = fabs(strtod(line, &end));
    size_t size = strcspn(line, ",\r\n");
    if (end < line || (size_t)(end - line) != size)
      return status_fail(STATUS_INPUT, "%s/history.csv:%d: %s is '%.*s'; expected a number", directory,
                         number, history->names[k], (int)(size < 40 ? size : 40), line);
    if (!*end || !strchr(expected, *end))
      return status_fail(STATUS_INPUT, "%s/history.csv:%d: %s columns than the %d of the first line",
                         directory, number, *end == ',' ? "more" : "fewer", history->count);
    if (isfinite(value)) history->largest[k] = fmax(history->largest[k], value);
    line = end + 1;
  }
  history->row_count++;
  return STATUS_OK;
}

static Status read_history(History *history, const AppReportRun *run) {
  const char *text = run->history;
  if (!text || !strchr(text, '\n'))
    return status_fail(STATUS_INPUT, "%s: has no history.csv to plot", run->directory);
  read_names(history, text, strcspn(text, "\n"));
  for (text = strchr(text, '\n'); text[1]; text = strchr(text + 1, '\n')) {
    if (!strchr(text + 1, '\n'))
      return status_fail(STATUS_INPUT, "%s/history.csv:%d: the line does not end; the file is cut short",
                         run->directory, history->row_count + 2);
    TRY(read_row(history, text + 1, run->directory));
  }
  return STATUS_OK;
}

static int find(const History *history, const char *name) {
  for (int k = 0; k < history->count; k++)
    if (strcmp(history->names[k], name) == 0) return k;
  return -1;
}

static bool is_alive(const History *history, const char *name) {
  int k = find(history, name);
  return k >= 0 && history->largest[k] > 0;
}

// One curve. `column` is gnuplot's expression of it.
static void add_curve(FILE *script, int *count, int run, int run_count, const char *column, const char *title,
                      const char *label) {
  const char *hue = hues[*count / run_count % (int)(sizeof hues / sizeof *hues)];
  fprintf(script, "%s$run%d using (column('time_s')):(%s) with lines lw 1.5 lc rgb '%s' dt %s title ",
          *count ? ", \\\n  " : "plot ", run, column, hue, run ? "(6,4)" : "1");
  char text[2 * MAX_NAME];
  snprintf(text, sizeof text, run_count > 1 ? "%s, %s" : "%s", title, label);
  app_gnuplot_quote(script, text);
  ++*count;
}

// The pair of a column "force_PAIR_x_N", in `pair`; false: another column.
static bool find_pair(const char *name, char *pair) {
  size_t length = strlen(name);
  if (strncmp(name, "force_", 6) != 0 || length < 11 || strcmp(name + length - 4, "_x_N") != 0) return false;
  snprintf(pair, MAX_NAME, "%.*s", (int)(length - 10), name + 6);
  return true;
}

static bool has_force(const History *history, const char *pair) {
  bool is_there = false;
  for (const char *axis = "xyz"; *axis; axis++) {
    char name[MAX_NAME + 16];
    snprintf(name, sizeof name, "force_%s_%c_N", pair, *axis);
    is_there = is_there || is_alive(history, name);
  }
  return is_there;
}

// What rows a frame miss: the largest force between any two after any step since the row before. Where every
// step has its row there is nothing to miss.
static int write_peaks(FILE *script, const History *histories, int run_count, const char *const *labels) {
  static const char column[] = "contact_force_peak_N";
  int count = MAX_FORCES * run_count; // the hue after those of the forces
  for (int r = 0; r < run_count; r++) {
    int steps = find(&histories[r], "steps");
    bool misses = steps >= 0 && histories[r].largest[steps] > histories[r].row_count;
    if (misses && is_alive(&histories[r], column))
      add_curve(script, &count, r, run_count, "column('contact_force_peak_N')", peak_title, labels[r]);
  }
  return count - MAX_FORCES * run_count;
}

static int write_forces(FILE *script, const History *histories, int run_count, const char *const *labels) {
  int count = 0;
  for (int k = 0; k < histories[0].count && count < MAX_FORCES * run_count; k++) {
    char pair[MAX_NAME], column[4 * MAX_NAME];
    if (!find_pair(histories[0].names[k], pair) || !has_force(&histories[0], pair)) continue;
    snprintf(column, sizeof column,
             "sqrt(column('force_%s_x_N')**2+column('force_%s_y_N')**2+column('force_%s_z_N')**2)", pair,
             pair, pair);
    for (int r = 0; r < run_count; r++)
      if (r == 0 || has_force(&histories[r], pair))
        add_curve(script, &count, r, run_count, column, pair, labels[r]);
      else
        count++; // keeps the hues in step
  }
  return count + (count > 0 ? write_peaks(script, histories, run_count, labels) : 0);
}

static int write_energies(FILE *script, const History *histories, int run_count, const char *const *labels) {
  static const char *const names[] = {"kinetic", "elastic", "contact", "dissipated"};
  int count = 0;
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char name[32], column[48];
    snprintf(name, sizeof name, "%s_J", names[k]);
    snprintf(column, sizeof column, "column('%s')", name);
    bool is_shown = false;
    for (int r = 0; r < run_count; r++) is_shown = is_shown || is_alive(&histories[r], name);
    for (int r = 0; is_shown && r < run_count; r++)
      if (find(&histories[r], name) >= 0)
        add_curve(script, &count, r, run_count, column, names[k], labels[r]);
      else
        count++;
  }
  return count;
}

// A static run has no steps of time.
static bool has_steps(const History *histories, int run_count) {
  bool has = false;
  for (int r = 0; r < run_count; r++) has = has || is_alive(&histories[r], "step_s");
  return has;
}

static void write_steps(FILE *script, const History *histories, int run_count, const char *const *labels) {
  int count = 0;
  for (int r = 0; r < run_count; r++)
    if (is_alive(&histories[r], "step_s"))
      add_curve(script, &count, r, run_count, "column('step_s') > 0 ? column('step_s') : NaN", "step",
                labels[r]);
}

// A panel without a curve: gnuplot ends with an error where it has no number to draw.
static void write_nothing(FILE *script) {
  fputs("plot $run0 using (column('time_s')):(0) with lines lc rgb 'white' notitle", script);
}

static void write_data(FILE *script, const AppReportRun *runs, int run_count) {
  for (int r = 0; r < run_count; r++) {
    size_t length = strlen(runs[r].history);
    fprintf(script, "$run%d << END\n%s%sEND\n", r, runs[r].history,
            length && runs[r].history[length - 1] == '\n' ? "" : "\n");
  }
}

static void write_panels(FILE *script, const History *histories, int run_count, const char *const *labels) {
  static const char time[] = "\nset xlabel 'time [s]'\n";
  const bool moves = has_steps(histories, run_count);
  fprintf(script, "set multiplot layout %d,1\nset ylabel 'contact force [N]'\n", moves ? 3 : 2);
  if (write_forces(script, histories, run_count, labels) == 0) write_nothing(script);
  fprintf(script, "\nset ylabel 'energy [J]'%s", moves ? "\n" : time);
  if (write_energies(script, histories, run_count, labels) == 0) write_nothing(script);
  if (moves) {
    fprintf(script, "\nset ylabel 'step [s]'%sset logscale y\nset format y '10^{%%T}'\n", time);
    write_steps(script, histories, run_count, labels);
  }
  fputs("\nunset multiplot\n", script);
}

// Characters that the longest entry of a key may have, the forces' own titles among them.
static int longest_title(const History *histories, int run_count, const char *const *labels) {
  size_t title = strlen(peak_title), label = 0;
  for (int k = 0; k < histories[0].count; k++) {
    char pair[MAX_NAME];
    if (find_pair(histories[0].names[k], pair) && strlen(pair) > title) title = strlen(pair);
  }
  for (int r = 0; run_count > 1 && r < run_count; r++)
    if (strlen(labels[r]) + 2 > label) label = strlen(labels[r]) + 2;
  return (int)(title + label);
}

Status app_plot_history(FILE *script, const char *picture, const AppReportRun *runs, int run_count,
                        const char *const *labels) {
  History *histories = memory_zeroed((size_t)run_count, sizeof *histories);
  Status status = histories ? STATUS_OK : status_no_memory("the histories");
  for (int r = 0; !status && r < run_count; r++) status = read_history(&histories[r], &runs[r]);
  // The key stands beside the panels, in letters of three quarters of the size that margins are measured in.
  int margin = status ? 0 : 6 + 3 * longest_title(histories, run_count, labels) / 4;
  if (!status) {
    fputs("# gnuplot script; run it again with: gnuplot THIS_FILE\nset datafile separator ','\n", script);
    write_data(script, runs, run_count);
    status = app_gnuplot_open(script, picture, PANEL_WIDTH + LETTER_WIDTH * margin, HEIGHT);
  }
  if (!status) {
    fprintf(script,
            "set border 3\nset tics nomirror\nset grid lc rgb '#e4e4e4' lt 1 lw 0.5\n"
            "set key at graph 1.03,1 left top Left reverse noenhanced font small samplen 2\n"
            "set lmargin 13\nset rmargin %d\n",
            margin);
    write_panels(script, histories, run_count, labels);
  }
  memory_free(histories);
  return status;
}
