// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // pipe2
#endif
#include "app/render/movie.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/text.h"

enum { NOT_FOUND = 127 };

bool app_render_movie_is_known(const char *path) {
  return text_ends_in(path, ".mp4") || text_ends_in(path, ".gif");
}

// `url`: "file:…", so that no name is taken for an option or a protocol.
static void become(int pictures, const char *url, const char *rate, bool is_gif) {
  // A palette for the whole movie; and what every player can show: even sizes, colours at half resolution.
  const char *gif =
      "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4";
  const char *mp4 = "scale=trunc(iw/2)*2:trunc(ih/2)*2,format=yuv420p";
  int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  setpgid(0, 0); // a Ctrl-C of the terminal is the parent's to answer
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(pictures, STDIN_FILENO), dup2(nothing, STDOUT_FILENO), dup2(nothing, STDERR_FILENO);
  execlp("ffmpeg", "ffmpeg", "-y", "-loglevel", "error", "-f", "image2pipe", "-c:v", "png", "-framerate",
         rate, "-i", "-", "-vf", is_gif ? gif : mp4, "-f", is_gif ? "gif" : "mp4", url, (char *)NULL);
  _exit(NOT_FOUND);
}

// The one end goes to the child, the other becomes the stream.
static Status start(AppRenderMovie *movie, const char *path, const char *url, const char *rate) {
  int ends[2];
  signal(SIGPIPE, SIG_IGN); // ffmpeg that is gone shows as a failed write
  if (pipe2(ends, O_CLOEXEC) != 0) return status_fail(STATUS_IO, "no pipe can be made: %s", strerror(errno));
  movie->process = fork();
  if (movie->process == 0) become(ends[0], url, rate, text_ends_in(path, ".gif"));
  int reason = errno;
  close(ends[0]);
  movie->stream = movie->process > 0 ? fdopen(ends[1], "w") : NULL;
  if (movie->stream) return STATUS_OK;
  close(ends[1]);
  return status_fail(STATUS_IO, "no process can be started: %s", strerror(reason));
}

Status app_render_movie_begin(AppRenderMovie *movie, const char *path, int per_second) {
  *movie = (AppRenderMovie){0};
  char rate[16];
  snprintf(rate, sizeof rate, "%d", per_second);
  TRY(file_begin(&movie->file, path));
  size_t size = strlen(movie->file.temporary) + sizeof "file:";
  char *url = memory_zeroed(size, 1);
  if (!url) return status_no_memory("a file name");
  snprintf(url, size, "file:%s", movie->file.temporary);
  Status status = start(movie, path, url, rate);
  memory_free(url);
  return status;
}

Status app_render_movie_add(AppRenderMovie *movie, const unsigned char *png, size_t size) {
  if (fwrite(png, 1, size, movie->stream) == size && fflush(movie->stream) == 0) return STATUS_OK;
  return app_render_movie_end(movie); // which knows why
}

Status app_render_movie_end(AppRenderMovie *movie) {
  int state = 0;
  bool is_written = fclose(movie->stream) == 0;
  movie->stream = NULL;
  waitpid(movie->process, &state, 0);
  movie->process = 0;
  int code = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  if (code == NOT_FOUND)
    return status_fail(STATUS_IO,
                       "movies are made by ffmpeg, which is not there; install it (Debian: ffmpeg)");
  if (code == 0 && is_written) return file_commit(&movie->file);
  return status_fail(STATUS_IO, "%s: ffmpeg could not write it (exit code %d)", movie->file.path, code);
}

void app_render_movie_abandon(AppRenderMovie *movie) {
  if (movie->stream) fclose(movie->stream);
  if (movie->process > 0) {
    kill(movie->process, SIGKILL);
    waitpid(movie->process, NULL, 0);
  }
  file_abandon(&movie->file);
  *movie = (AppRenderMovie){0};
}
