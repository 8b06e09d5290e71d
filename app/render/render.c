// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/render/render.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/render/browser.h"
#include "app/render/movie.h"
#include "base/files/file.h"
#include "base/files/temporary.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/text.h"

bool app_render_is_picture(const char *path) {
  return strncmp(path, "/dev/", 5) == 0 || text_ends_in(path, ".png");
}

static Status check_stop(const AppRenderOptions *options) {
  return *options->stop ? status_fail(STATUS_INTERRUPTED, "interrupted") : STATUS_OK;
}

// The page says when it is ready, or that it cannot be.
static Status wait_until_ready(AppRenderBrowser *browser, const AppRenderOptions *options) {
  static const struct timespec pause = {.tv_nsec = 50 * 1000 * 1000};
  enum { ATTEMPTS = 6000 };
  for (int k = 0; k < ATTEMPTS; k++) {
    char *state;
    TRY(check_stop(options));
    TRY(app_render_browser_run(browser, "document.documentElement.dataset.ready ?? ''", &state));
    bool is_ready = state && strcmp(state, "yes") == 0, has_failed = state && strcmp(state, "failed") == 0;
    memory_free(state);
    if (is_ready) return STATUS_OK;
    if (has_failed) break;
    nanosleep(&pause, NULL);
  }
  return status_fail(STATUS_IO, "the page of this run could not be shown by Chromium");
}

// Fits the page to the picture; returns how many frames there are.
static Status present(AppRenderBrowser *browser, const AppRenderOptions *options, int *frame_count) {
  Record *wishes = record_new();
  if (options->field) record_text(wishes, "field", options->field);
  if (options->cut) {
    record_text(wishes, "cut", options->cut);
    record_number(wishes, "share", options->cut_share);
  }
  if (options->range) {
    record_number(wishes, "low", options->range[0]);
    record_number(wishes, "high", options->range[1]);
  }
  if (options->view) {
    record_number(wishes, "azimuth", options->view[0]);
    record_number(wishes, "elevation", options->view[1]);
  }
  if (options->theme) record_text(wishes, "theme", options->theme);
  if (options->hides_edges) record_bool(wishes, "edges", false);
  char *text = wishes ? record_text_of(wishes) : NULL, *script = NULL, *count = NULL;
  record_destroy(wishes);
  size_t size = text ? strlen(text) + 64 : 0;
  if (text) script = memory_zeroed(size, 1);
  Status status = script ? STATUS_OK : status_no_memory("a script");
  if (!status) {
    snprintf(script, size, "tetlap.present(tetlap, %s)", text);
    status = app_render_browser_run(browser, script, &count);
    // the page's own words where it has no such field
    if (status == STATUS_IO && options->field && strstr(status_message(), "there is no field"))
      status = status_prefix(STATUS_USAGE, "--field");
  }
  *frame_count = count ? atoi(count) : 0;
  memory_free(count);
  memory_free(script);
  memory_free(text);
  return status;
}

static Status draw(AppRenderBrowser *browser, int frame, unsigned char **png, size_t *size) {
  char script[64];
  snprintf(script, sizeof script, "tetlap.showFrame(tetlap, %d)", frame);
  TRY(app_render_browser_run(browser, script, NULL));
  return app_render_browser_capture(browser, png, size);
}

static Status draw_picture(AppRenderBrowser *browser, const AppRenderOptions *options, int frame_count) {
  unsigned char *png;
  size_t size;
  FileWriter writer;
  if (options->frame >= frame_count || options->frame < -frame_count)
    return status_fail(STATUS_USAGE,
                       "--frame: there is no frame %d; there are %d, from 0 to %d, or from the end -1 to -%d",
                       options->frame, frame_count, frame_count - 1, frame_count);
  TRY(draw(browser, options->frame, &png, &size));
  Status status = file_begin(&writer, options->picture);
  if (!status) {
    fwrite(png, 1, size, writer.stream);
    status = file_commit(&writer);
  }
  memory_free(png);
  return status;
}

static Status add_frames(AppRenderBrowser *browser, const AppRenderOptions *options, int frame_count,
                         AppRenderMovie *movie) {
  for (int frame = 0; frame < frame_count; frame++) {
    unsigned char *png;
    size_t size;
    TRY(check_stop(options));
    log_progress("frame %d of %d", frame + 1, frame_count);
    TRY(draw(browser, frame, &png, &size));
    Status status = app_render_movie_add(movie, png, size);
    memory_free(png);
    TRY(status);
  }
  return app_render_movie_end(movie);
}

static Status draw_movie(AppRenderBrowser *browser, const AppRenderOptions *options, int frame_count) {
  AppRenderMovie movie;
  Status status = app_render_movie_begin(&movie, options->movie, options->per_second);
  if (!status) status = add_frames(browser, options, frame_count, &movie);
  log_progress_end();
  app_render_movie_abandon(&movie);
  return status;
}

static Status draw_all(AppRenderBrowser *browser, const AppRenderOptions *options) {
  int frame_count;
  TRY(wait_until_ready(browser, options));
  TRY(present(browser, options, &frame_count));
  if (options->picture) TRY(draw_picture(browser, options, frame_count));
  return options->movie ? draw_movie(browser, options, frame_count) : STATUS_OK;
}

static Status show(const char *page, const AppRenderOptions *options) {
  static const double PATIENCE_S = 300; // a large run, drawn by a processor
  char url[PATH_MAX + 8], absolute[PATH_MAX];
  AppRenderBrowser browser;
  if (!realpath(page, absolute)) return status_fail(STATUS_IO, "%s: %s", page, strerror(errno));
  snprintf(url, sizeof url, "file://%s", absolute);
  Status status = app_render_browser_start(&browser, url, options->width, options->height, PATIENCE_S);
  if (!status) status = draw_all(&browser, options);
  app_render_browser_stop(&browser);
  return status;
}

Status app_render(AppReport *report, const AppRenderOptions *options) {
  char *page;
  TRY(temporary_file("page", ".html", &page));
  Status status = app_report_write(report, page);
  if (!status) status = show(page, options);
  temporary_remove(page);
  // Where a signal has cut a call short, that is the reason.
  return status && *options->stop ? check_stop(options) : status;
}
