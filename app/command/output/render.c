// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/output/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/argument.h"
#include "app/job/job.h"
#include "app/render/movie.h"
#include "app/render/render.h"
#include "app/report/collect.h"
#include "base/log.h"

enum {
  KEY_FRAME = 256,
  KEY_MOVIE,
  KEY_FIELD,
  KEY_CUT,
  KEY_THEME,
  KEY_SIZE,
  KEY_RATE,
  KEY_EDGES,
  KEY_RANGE,
  KEY_VIEW
};
enum { LEAST_SIZE = 64, MOST_SIZE = 8192, MOST_FRAME = 10000000 };

typedef struct Options {
  const char *directories[APP_REPORT_MAX_RUNS];
  int directory_count;
  AppRenderOptions render;
  double range[2], view[2];
  bool has_frame, has_rate, is_quiet;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE.png", 0, "Write this picture", 0},
    {"frame", KEY_FRAME, "N", 0, "Of this frame, from 0; -1: the last, -2: the one before (default: -1)", 0},
    {"movie", KEY_MOVIE, "FILE", 0, "Write a movie of all frames: FILE.mp4 or FILE.gif", 0},
    {"rate", KEY_RATE, "N", 0, "Frames a second of the movie (default: 20)", 0},
    {"size", KEY_SIZE, "WxH", 0, "Pixels (default: 1280x720)", 0},
    {"field", KEY_FIELD, "NAME", 0, "Colour by this array of the frames, such as von_mises or body", 0},
    {"range", KEY_RANGE, "LOW,HIGH", 0, "Ends of the colour scale (default: from the values of all frames)",
     0},
    {"view", KEY_VIEW, "AZIMUTH,ELEVATION", 0,
     "Where the camera stands, in degrees: about z from x, and above the ground (default: -58,20)", 0},
    {"cut", KEY_CUT, "AXIS[:PLACE]", 0,
     "Cut open along x, y or z, at 0 … 1 of the bodies' extent (default: .5)", 0},
    {"theme", KEY_THEME, "light|dark", 0, "Colours (default: light)", 0},
    {"no-edges", KEY_EDGES, NULL, 0, "Without the edges of elements", 0},
    {"quiet", 'q', NULL, 0, "Say errors only", 0},
    {0},
};

static void read_size(struct argp_state *state, const char *text, AppRenderOptions *render) {
  char rest;
  if (sscanf(text, "%dx%d%c", &render->width, &render->height, &rest) == 2 && render->width >= LEAST_SIZE &&
      render->width <= MOST_SIZE && render->height >= LEAST_SIZE && render->height <= MOST_SIZE)
    return;
  argp_error(state, "--size is '%s'; give pixels from %d to %d, as in 1280x720", text, LEAST_SIZE, MOST_SIZE);
}

// "y" or "y:0.3".
static void read_cut(struct argp_state *state, char *text, AppRenderOptions *render) {
  char *colon = strchr(text, ':');
  if (colon) {
    *colon = 0;
    render->cut_share = app_argument_number(state, "cut", colon + 1, 0, 1);
  }
  if (strlen(text) != 1 || !strchr("xyz", text[0]))
    argp_error(state, "--cut is '%s'; give x, y or z, or a place as well, as in y:0.5", text);
  render->cut = text;
}

// "A,B", each from `least` to `most`.
static const double *read_two(struct argp_state *state, const char *option, char *text, const char *example,
                              double least, double most, double two[2]) {
  const char *words[2];
  if (app_argument_list(state, option, text, example, 2, words) != 2)
    argp_error(state, "--%s needs two numbers, as in %s", option, example);
  for (int k = 0; k < 2; k++) two[k] = app_argument_number(state, option, words[k], least, most);
  return two;
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  AppRenderOptions *render = &options->render;
  switch (key) {
  case 'o':
    if (!app_render_is_picture(text)) argp_error(state, "-o is '%s'; pictures are PNG: give FILE.png", text);
    render->picture = text;
    return 0;
  case KEY_FRAME:
    render->frame = (int)app_argument_integer(state, "frame", text, -MOST_FRAME, MOST_FRAME);
    options->has_frame = true;
    return 0;
  case KEY_MOVIE:
    if (!app_render_movie_is_known(text))
      argp_error(state, "--movie is '%s'; give FILE.mp4 or FILE.gif", text);
    render->movie = text;
    return 0;
  case KEY_RATE:
    render->per_second = (int)app_argument_integer(state, "rate", text, 1, 120);
    options->has_rate = true;
    return 0;
  case KEY_SIZE:
    read_size(state, text, render);
    return 0;
  case KEY_FIELD:
    render->field = text;
    return 0;
  case KEY_CUT:
    read_cut(state, text, render);
    return 0;
  case KEY_RANGE:
    render->range = read_two(state, "range", text, "0,8", -1e300, 1e300, options->range);
    if (!(render->range[0] < render->range[1]))
      argp_error(state, "--range is %g,%g; the second number must be larger", render->range[0],
                 render->range[1]);
    return 0;
  case KEY_VIEW:
    render->view = read_two(state, "view", text, "-58,20", -360, 360, options->view);
    if (!(fabs(render->view[1]) < 90))
      argp_error(state, "--view has the elevation %g; give one between -90 and 90 degrees", render->view[1]);
    return 0;
  case KEY_THEME:
    if (strcmp(text, "light") != 0 && strcmp(text, "dark") != 0)
      argp_error(state, "--theme is '%s'; give light or dark", text);
    render->theme = text;
    return 0;
  case KEY_EDGES:
    render->hides_edges = true;
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->directory_count == APP_REPORT_MAX_RUNS)
      argp_error(state, "'%s' is one argument too many: a picture shows at most %d runs", text,
                 APP_REPORT_MAX_RUNS);
    options->directories[options->directory_count++] = text;
    return 0;
  case ARGP_KEY_END:
    if (options->directory_count == 0) argp_error(state, "name the directory of a run or of a comparison");
    if (!render->picture && !render->movie)
      argp_error(state, "name what to write, as in -o picture.png or --movie run.mp4");
    if (options->has_frame && !render->picture)
      argp_error(state,
                 "--frame is of a picture, and a movie has all frames; leave it out, or add -o FILE.png");
    if (options->has_rate && !render->movie)
      argp_error(state, "--rate is of a movie; leave it out, or add --movie FILE.mp4");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status render(const Options *options) {
  AppReport report = {0};
  Status status = STATUS_OK;
  for (int k = 0; !status && k < options->directory_count; k++)
    status = app_report_collect(&report, options->directories[k], options->directory_count == 1, 0);
  if (!status) status = app_render(&report, &options->render);
  app_report_destroy(&report);
  if (!status && options->render.picture) log_info("wrote %s", options->render.picture);
  if (!status && options->render.movie) log_info("wrote %s", options->render.movie);
  return status;
}

static const struct argp argp = {
    option_table,
    parse,
    "DIR…",
    "Draw a run, or several side by side, as a picture or a movie.\vDIR is where `tetlap run` or `tetlap "
    "compare` wrote. Pictures are made by Chromium, without a window; movies by ffmpeg from such pictures.",
    NULL,
    NULL,
    NULL};

static int run_command(int argument_count, char **arguments) {
  Options options = {.render = {.frame = -1,
                                .per_second = 20,
                                .width = 1280,
                                .height = 720,
                                .theme = "light",
                                .cut_share = 0.5,
                                .stop = app_job_stop_flag()}};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  return app_cli_command_end(render(&options));
}

const AppCommand app_command_render = {
    .name = "render", .help = "draw runs as a picture or a movie", .argp = &argp, .run = run_command};
