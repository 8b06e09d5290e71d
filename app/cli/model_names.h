// SPDX-License-Identifier: GPL-3.0-or-later
// What overlap models are called in folders, tables, pages and messages. A model of the program has its own
// name; one from a file has the shortest end of its path, without ".safetensors", ".so" or ".py", that no
// other model has:
//
//   clip                      clip
//   out/a/net.safetensors     a/net
//   out/b/net.safetensors     b/net
//   hybrid=out/my.safetensors hybrid=my
//   out/a/mine.py:volume      mine:volume
//   exec:out/mine --fast      mine
//   channel:5:6:volume        volume
//
// A name is the path of the model's folder below that of a comparison, too.
#ifndef TETLAP_APP_CLI_MODEL_NAMES_H
#define TETLAP_APP_CLI_MODEL_NAMES_H

#include <limits.h>
#include <stdbool.h>

#include "base/status.h"

enum { APP_MODEL_NAME = 240 };
typedef char AppModelName[APP_MODEL_NAME];

// The names of several models. A source is what a command line or a scene says (overlap/source.h). STATUS_USAGE: two sources are one model, or a name is too long.
Status app_model_names_find(int count, const char *const *sources, AppModelName *names);

// The same of one model; too long a name is cut.
void app_model_names_find_one(const char *source, AppModelName name);

// The absolute path of the source's file, without "." and "..", and of a Python file what follows it. False: it
// names no file.
bool app_model_names_locate(const char *source, char path[PATH_MAX]);

// The same behind what stands before it in the source, as in `hybrid=`.
bool app_model_names_settle(const char *source, char word[PATH_MAX]);

#endif
