// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between the versions of SUNDIALS that we are compiled with: 6.4 in Debian 12, 7.1 in
// Debian 13. All else calls both alike, by the names of the later one.
#ifndef TETLAP_FEM_TIME_SUNDIALS_H
#define TETLAP_FEM_TIME_SUNDIALS_H

#include <stdbool.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>

#if SUNDIALS_VERSION_MAJOR < 7

// What a callback answers when it succeeded; 6.4 has a name for it in each module.
enum { SUN_SUCCESS = 0 };
// What a linear solver answers when it failed for good.
#define SUN_ERR_EXT_FAIL SUNLS_PACKAGE_FAIL_UNREC

static inline void fem_sundials_ignore(int code, const char *module, const char *function, char *message,
                                       void *self) {
  (void)code, (void)module, (void)function, (void)message, (void)self;
}

// For one process: the program itself divides the work over ranks. Nothing is printed by what is created in
// it, once FEM_SUNDIALS_SILENCE was applied to that. False: no memory.
static inline bool fem_sundials_create(SUNContext *context) {
  return SUNContext_Create(NULL, context) == 0;
}

// (IDA, memory) or (KIN, memory): true if the integrator or solver prints nothing from now on.
#define FEM_SUNDIALS_SILENCE(package, memory)                                                                \
  (package##SetErrHandlerFn((memory), fem_sundials_ignore, NULL) == 0)

#else

static inline bool fem_sundials_create(SUNContext *context) {
  return SUNContext_Create(SUN_COMM_NULL, context) == 0 && SUNContext_ClearErrHandlers(*context) == 0;
}

// Messages are the context's.
#define FEM_SUNDIALS_SILENCE(package, memory) true

#endif
#endif
