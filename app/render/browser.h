// SPDX-License-Identifier: GPL-3.0-or-later
// A headless Chromium, controlled over a pipe (the DevTools protocol): it opens one page, runs scripts in it
// and captures pictures. It has no network.
#ifndef TETLAP_APP_RENDER_BROWSER_H
#define TETLAP_APP_RENDER_BROWSER_H

#include <stddef.h>
#include <sys/types.h>

#include "base/files/record.h"

typedef struct AppRenderBrowser {
  pid_t process; // 0: none
  int to, from;  // descriptors: for commands, of answers; −1: none
  char *profile; // its folder, owned; removed at the end
  char *session; // of the page, owned
  char *text;    // what has come and is not yet read (text_size), owned
  size_t text_size, text_room;
  double patience_s; // for an answer
  int last_call;
} AppRenderBrowser;

// Starts it with a page of so many pixels. STATUS_IO: there is no Chromium (the message names the package),
// or, as in every call, it has not answered for `patience_s`. Stop it always.
Status app_render_browser_start(AppRenderBrowser *browser, const char *url, int width, int height,
                                double patience_s);
void app_render_browser_stop(AppRenderBrowser *browser);

// Evaluates a script, waits for what it promises; `text` is what comes out if that is a text (owned by the
// caller; else NULL; may be NULL). STATUS_IO: the script failed.
Status app_render_browser_run(AppRenderBrowser *browser, const char *script, char **text);

// The page as a PNG in memory, owned by the caller (memory_free).
Status app_render_browser_capture(AppRenderBrowser *browser, unsigned char **png, size_t *size);

#endif
