// SPDX-License-Identifier: GPL-3.0-or-later
// Part of every program of the presets asan and tsan: what the sanitizers shall not take for an error of ours.
#include <stddef.h>

const char *__asan_default_options(void);
const char *__lsan_default_suppressions(void);
int dlclose(void *handle);

// A test asks for more memory than there is: an error that is told, not one to stop at.
const char *__asan_default_options(void) {
  return "allocator_may_return_null=1";
}

// Open MPI keeps what it allocates at its start; its asprintf, which nothing of ours calls, hides who called it.
const char *__lsan_default_suppressions(void) {
  return "leak:libmpi\nleak:libopen-pal\nleak:libopen-rte\nleak:libhwloc\nleak:libpmix\nleak:openmpi\nleak:pmix\n"
         "leak:libevent\nleak:libucp\nleak:libucs\nleak:libfabric\n"
         "leak:__vasprintf_internal\n";
}

// A library that is closed has no name in a report, so no suppression would find it.
int dlclose(void *handle) {
  (void)handle;
  return 0;
}
