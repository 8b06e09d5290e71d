// SPDX-License-Identifier: GPL-3.0-or-later
// PyTorch in a child process (tools/torch_bench.py), with the same weights and inputs, to take turns with our
// own kernels. It is not needed for anything else; where it is not installed, its rows are left out.
#ifndef TETLAP_APP_BENCH_TORCH_PEER_H
#define TETLAP_APP_BENCH_TORCH_PEER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

#include "base/status.h"

typedef struct AppTorchPeer {
  pid_t child; // 0: none
  FILE *to, *from;
  char name[64]; // "PyTorch 1.13.1"
  char *inputs;  // temporary file, owned
} AppTorchPeer;

typedef enum AppTorchPrecision { APP_TORCH_FLOAT, APP_TORCH_DOUBLE, APP_TORCH_BF16 } AppTorchPrecision;

// What the child computes; all borrowed.
typedef struct AppTorchDef {
  const char *weights;         // a file
  AppTorchPrecision precision; // in which it computes, whatever the file has
  const char *device;          // PyTorch's name: "cpu", "cuda"
  const void *inputs;          // samples, in float for bf16
  size_t size;                 // their bytes
  int threads;
} AppTorchDef;

// STATUS_IO: Python, PyTorch or its device is not there, or the child ended; the message says so. Stop it in
// any case.
Status app_torch_peer_start(AppTorchPeer *peer, const AppTorchDef *def);
void app_torch_peer_stop(AppTorchPeer *peer); // a zeroed one is accepted

// What `calls` calls with the first `batch` samples took.
typedef struct AppTorchTime {
  double wall_s, cpu_s;
  double check; // mean of the absolute results
} AppTorchTime;

// `what`: "V", "V+grad" or "train".
Status app_torch_peer_time(AppTorchPeer *peer, const char *what, int batch, int calls, AppTorchTime *time);

#endif
