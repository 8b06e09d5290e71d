// SPDX-License-Identifier: GPL-3.0-or-later
// PyTorch in a child process (tools/torch_bench.py), with the same weights and inputs, to take turns with our
// own kernels. It is not needed for anything else; where it is not installed, its rows are left out.
#ifndef TETLAP_LAB_TORCH_PEER_H
#define TETLAP_LAB_TORCH_PEER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

#include "base/status.h"

typedef struct LabTorchPeer {
  pid_t child; // 0: none
  FILE *to, *from;
  char name[64]; // "PyTorch 1.13.1"
  char *inputs;  // temporary file, owned
} LabTorchPeer;

typedef enum LabTorchPrecision { LAB_TORCH_FLOAT, LAB_TORCH_DOUBLE, LAB_TORCH_BF16 } LabTorchPrecision;

// What the child computes; all borrowed.
typedef struct LabTorchDef {
  const char *weights;         // a file
  LabTorchPrecision precision; // in which it computes, whatever the file has
  const char *device;          // PyTorch's name: "cpu", "cuda"
  const void *inputs;          // samples, in float for bf16
  size_t size;                 // their bytes
  int threads;
} LabTorchDef;

// STATUS_IO: Python, PyTorch or its device is not there, or the child ended; the message says so. Stop it in
// any case.
Status lab_torch_peer_start(LabTorchPeer *peer, const LabTorchDef *def);
void lab_torch_peer_stop(LabTorchPeer *peer); // a zeroed one is accepted

// What `calls` calls with the first `batch` samples took.
typedef struct LabTorchTime {
  double wall_s, cpu_s;
  double check; // mean of the absolute results
} LabTorchTime;

// `what`: "V" or "V+grad".
Status lab_torch_peer_time(LabTorchPeer *peer, const char *what, int batch, int calls, LabTorchTime *time);

#endif
