// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/argument.h"
#include "app/cli/parse.h"
#include "app/job/job.h"
#include "app/render/movie.h"
#include "app/render/render.h"
#include "app/report/collect.h"
#include "base/log.h"
#include "base/text.h"

enum { LEAST_SIZE = 64, MOST_SIZE = 8192, MOST_FRAME = 10000000 };

typedef struct Options {
  const char *directories[APP_REPORT_MAX_RUNS];
  int directory_count;
  AppRenderOptions render;
  double range[2], view[2];
  bool has_range, has_view, has_frame, has_rate, is_quiet;
} Options;

static void read_picture(struct argp_state *state, void *picture, char *text) {
  if (!app_render_is_picture(text)) argp_error(state, "-o is '%s'; pictures are PNG: give FILE.png", text);
  *(const char **)picture = text;
}

static void read_movie(struct argp_state *state, void *movie, char *text) {
  if (!app_render_movie_is_known(text)) argp_error(state, "--movie is '%s'; give FILE.mp4 or FILE.gif", text);
  *(const char **)movie = text;
}

static void read_theme(struct argp_state *state, void *theme, char *text) {
  if (!text_lists("light dark", text)) argp_error(state, "--theme is '%s'; give light or dark", text);
  *(const char **)theme = text;
}

static void read_size(struct argp_state *state, void *options, char *text) {
  AppRenderOptions *render = options;
  char rest;
  if (sscanf(text, "%dx%d%c", &render->width, &render->height, &rest) == 2 && render->width >= LEAST_SIZE &&
      render->width <= MOST_SIZE && render->height >= LEAST_SIZE && render->height <= MOST_SIZE)
    return;
  argp_error(state, "--size is '%s'; give pixels from %d to %d, as in 1280x720", text, LEAST_SIZE, MOST_SIZE);
}

// "y" or "y:0.3".
static void read_cut(struct argp_state *state, void *options, char *text) {
  AppRenderOptions *render = options;
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
static void read_two(struct argp_state *state, const char *option, char *text, const char *example,
                     double least, double most, double two[2]) {
  const char *words[2];
  if (app_argument_list(state, option, text, example, 2, words) != 2)
    argp_error(state, "--%s needs two numbers, as in %s", option, example);
  for (int k = 0; k < 2; k++) two[k] = app_argument_number(state, option, words[k], least, most);
}

static void read_range(struct argp_state *state, void *member, char *text) {
  double *range = member;
  read_two(state, "range", text, "0,8", -1e300, 1e300, range);
  if (!(range[0] < range[1]))
    argp_error(state, "--range is %g,%g; the second number must be larger", range[0], range[1]);
}

static void read_view(struct argp_state *state, void *member, char *text) {
  double *view = member;
  read_two(state, "view", text, "-58,20", -360, 360, view);
  if (!(fabs(view[1]) < 90))
    argp_error(state, "--view has the elevation %g; give one between -90 and 90 degrees", view[1]);
}

static const AppOption option_table[] = {
    {"output", 'o', "FILE.png", "Write this picture", 0, CLI_OWN, CLI_TO(Options, render.picture),
     .read = read_picture},
    {"frame", 0, "N", "Of this frame, from 0; -1: the last, -2: the one before (default: -1)", 0, CLI_INTEGER,
     CLI_TO(Options, render.frame), -MOST_FRAME, MOST_FRAME, .mark_offset = offsetof(Options, has_frame)},
    {"movie", 0, "FILE", "Write a movie of all frames: FILE.mp4 or FILE.gif", 0, CLI_OWN,
     CLI_TO(Options, render.movie), .read = read_movie},
    {"rate", 0, "N", "Frames a second of the movie (default: 20)", 0, CLI_INTEGER,
     CLI_TO(Options, render.per_second), 1, 120, .mark_offset = offsetof(Options, has_rate)},
    {"size", 0, "WxH", "Pixels (default: 1280x720)", 0, CLI_OWN, CLI_TO(Options, render), .read = read_size},
    {"field", 0, "NAME", "Colour by this array of the frames, such as von_mises or body", 0, CLI_TEXT,
     CLI_TO(Options, render.field)},
    {"range", 0, "LOW,HIGH", "Ends of the colour scale (default: from the values of all frames)", 0, CLI_OWN,
     CLI_TO(Options, range), .read = read_range, .mark_offset = offsetof(Options, has_range)},
    {"view", 0, "AZIMUTH,ELEVATION",
     "Where the camera stands, in degrees: about z from x, and above the ground (default: -58,20)", 0,
     CLI_OWN, CLI_TO(Options, view), .read = read_view, .mark_offset = offsetof(Options, has_view)},
    {"cut", 0, "AXIS[:PLACE]", "Cut open along x, y or z, at 0 … 1 of the bodies' extent (default: .5)", 0,
     CLI_OWN, CLI_TO(Options, render), .read = read_cut},
    {"theme", 0, "light|dark", "Colours (default: light)", 0, CLI_OWN, CLI_TO(Options, render.theme),
     .read = read_theme},
    {"no-edges", 0, NULL, "Without the edges of elements", 0, CLI_FLAG, CLI_TO(Options, render.hides_edges)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static Status render(const Options *options) {
  AppReport report = {0};
  Status status = STATUS_OK;
  for (int k = 0; !status && k < options->directory_count; k++)
    status = app_report_collect(&report, options->directories[k], options->directory_count == 1, 0);
  if (!status && report.verdict)
    status = status_fail(STATUS_INPUT, "%s: has verdicts; give one of the runs in it, as MODEL/SCENE/MODEL",
                         options->directories[0]);
  if (!status) status = app_render(&report, &options->render);
  app_report_destroy(&report);
  if (!status && options->render.picture) log_info("wrote %s", options->render.picture);
  if (!status && options->render.movie) log_info("wrote %s", options->render.movie);
  return status;
}

static void check(struct argp_state *state, void *given) {
  Options *options = given;
  AppRenderOptions *render = &options->render;
  if (options->has_range) render->range = options->range;
  if (options->has_view) render->view = options->view;
  if (!render->picture && !render->movie)
    argp_error(state, "name what to write, as in -o picture.png or --movie run.mp4");
  if (options->has_frame && !render->picture)
    argp_error(state,
               "--frame is of a picture, and a movie has all frames; leave it out, or add -o FILE.png");
  if (options->has_rate && !render->movie)
    argp_error(state, "--rate is of a movie; leave it out, or add --movie FILE.mp4");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.render = {.frame = -1,
                                .per_second = 20,
                                .width = 1280,
                                .height = 720,
                                .theme = "light",
                                .cut_share = 0.5,
                                .stop = app_job_stop_flag()}};
  app_cli_parse(&app_command_render, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  return app_cli_command_end(render(&options));
}

const AppCommand app_command_render = {
    .name = "render",
    .help = "draw runs as a picture or a movie",
    .options = option_table,
    .arguments =
        &(const AppArguments){"DIR…", offsetof(Options, directories), APP_REPORT_MAX_RUNS,
                              offsetof(Options, directory_count),
                              .missing = "name the directory of a run or of a comparison",
                              .excess = "'%s' is one argument too many: a picture shows at most %d runs"},
    .doc =
        "Draw a run, or several side by side, as a picture or a movie.\vDIR is where `tetlap run` or `tetlap "
        "compare` wrote. Pictures are made by Chromium, without a window; movies by ffmpeg from such "
        "pictures.",
    .check = check,
    .run = run_command};
