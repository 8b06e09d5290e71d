// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // dladdr1
#endif
#include "overlap/foreign/library.h"

#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "overlap/foreign/elf.h"
#include "overlap/foreign/guard.h"

typedef struct Library {
  void *handle;
  const TetlapModel *model;
  void *self;  // the model's own
  char path[]; // as it was named, for messages
} Library;

static void close_library(void *self) {
  Library *library = self;
  overlap_foreign_guard_begin(library->path);
  if (library->model && library->model->close) library->model->close(library->self);
  if (library->handle) dlclose(library->handle);
  overlap_foreign_guard_end();
  memory_free(library);
}

static Status fail_with(const Library *library, int failed, const char *why) {
  return status_fail(STATUS_SOLVER, "%s: the model failed with %d%s%s", library->path, failed,
                     why[0] ? ": " : "", why);
}

static Status ask(void *self, const TetlapModelBatch *batch) {
  Library *library = self;
  char why[1024] = "";
  overlap_foreign_guard_begin(library->path);
  int failed = library->model->evaluate(library->self, batch, why, sizeof why);
  overlap_foreign_guard_end();
  why[sizeof why - 1] = 0;
  return failed ? fail_with(library, failed, why) : STATUS_OK;
}

static Status pull(void *self, const TetlapModelPull *asked) {
  Library *library = self;
  char why[1024] = "";
  overlap_foreign_guard_begin(library->path);
  int failed = library->model->pull_back(library->self, asked, why, sizeof why);
  overlap_foreign_guard_end();
  why[sizeof why - 1] = 0;
  return failed ? fail_with(library, failed, why) : STATUS_OK;
}

// A struct of the header's first version ends before `pull_back`.
static const size_t FIRST_SIZE = offsetof(TetlapModel, pull_back);

static bool has_pull(const TetlapModel *model) {
  return model->size >= offsetof(TetlapModel, range) && model->pull_back;
}

static const char *range_of(const TetlapModel *model) {
  return model->size >= sizeof *model ? model->range : NULL;
}

// A path without a slash would be looked for where the system's libraries are.
static Status load(Library *library) {
  char here[4096];
  if (access(library->path, R_OK) != 0)
    return status_fail(STATUS_IO, "%s: cannot be opened: %s", library->path, strerror(errno));
  if (snprintf(here, sizeof here, "%s%s", strchr(library->path, '/') ? "" : "./", library->path) >=
      (int)sizeof here)
    return status_fail(STATUS_INPUT, "%s: the path is too long", library->path);
  TRY(overlap_foreign_elf_check(library->path));
  library->handle = dlopen(here, RTLD_NOW | RTLD_LOCAL);
  if (library->handle) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "%s: cannot be loaded: %s. Build it with `cc -shared -fPIC`, for this machine",
                     library->path, dlerror());
}

static Status check(const Library *library) {
  const TetlapModel *model = library->model;
  if (!model) return status_fail(STATUS_INPUT, "%s: tetlap_model gave NULL", library->path);
  if (model->abi != TETLAP_MODEL_ABI)
    return status_fail(STATUS_INPUT,
                       "%s: was built for version %u of tetlap/model.h, this program has %d: build it again",
                       library->path, (unsigned)model->abi, TETLAP_MODEL_ABI);
  if (model->size < FIRST_SIZE || !model->evaluate)
    return status_fail(STATUS_INPUT, "%s: its TetlapModel has %s", library->path,
                       model->evaluate ? "no `size = sizeof(TetlapModel)`" : "no `evaluate`");
  return STATUS_OK;
}

static Status open_model(Library *library) {
  char why[1024] = "";
  if (!library->model->open) return STATUS_OK;
  int failed = library->model->open(&library->self, why, sizeof why);
  why[sizeof why - 1] = 0;
  if (!failed) return STATUS_OK;
  library->model = NULL; // nothing to close
  return status_fail(STATUS_INPUT, "%s: the model could not be opened (%d)%s%s", library->path, failed,
                     why[0] ? ": " : "", why);
}

static const char SYMBOL[] = "tetlap_model";

// Whether what was found is a variable, which must not be called.
static bool is_variable(const void *address) {
  Dl_info info;
  const ElfW(Sym) *symbol = NULL;
  return dladdr1(address, &info, (void **)&symbol, RTLD_DL_SYMENT) && symbol && info.dli_sname &&
         strcmp(info.dli_sname, SYMBOL) == 0 &&
         ELF64_ST_TYPE(symbol->st_info) == STT_OBJECT; // that of 32 bits is the same
}

static Status find_model(Library *library) {
  const TetlapModel *(*find)(void);
  TRY(load(library));
  void *const found = dlsym(library->handle, SYMBOL);
  *(void **)&find = found;
  if (!find)
    return status_fail(
        STATUS_INPUT,
        "%s: exports no function 'tetlap_model': tetlap/model.h says what a model's library has",
        library->path);
  if (is_variable(found))
    return status_fail(STATUS_INPUT,
                       "%s: its 'tetlap_model' is a variable, expected a function that returns the struct's "
                       "address, as tetlap/model.h has it",
                       library->path);
  library->model = find();
  Status status = check(library);
  if (!status) return open_model(library);
  library->model = NULL; // not to be called
  return status;
}

Status overlap_foreign_library_open(OverlapForeignPort *port, const char *path) {
  size_t length = strlen(path) + 1;
  Library *library = memory_zeroed(1, sizeof *library + length);
  if (!library) return status_no_memory("a model's library");
  memcpy(library->path, path, length);
  overlap_foreign_guard_begin(library->path);
  Status status = find_model(library);
  overlap_foreign_guard_end();
  if (status) {
    close_library(library);
    return status;
  }
  *port = (OverlapForeignPort){.self = library,
                               .gives = library->model->gives,
                               .range = range_of(library->model),
                               .ask = ask,
                               .pull = has_pull(library->model) ? pull : NULL,
                               .close = close_library};
  return STATUS_OK;
}
