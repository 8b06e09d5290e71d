// SPDX-License-Identifier: GPL-3.0-or-later
// What a run was started with, kept in its checkpoints: the way to the scene and what was said on the command
// line, to read it all again; the scene as it was understood and digests of meshes and weights, to see that
// it is still the same.
#ifndef TETLAP_APP_JOB_ORIGIN_H
#define TETLAP_APP_JOB_ORIGIN_H

#include "app/job/job.h"

// A new record, owned by the caller. STATUS_MEMORY.
Status app_origin_make(const AppJob *job, const AppJobOptions *options, const char *overlap, Record **origin);

// STATUS_INPUT names what differs so that a run would not go on as it began: the program, the scene, the mesh
// of a body, the weights. `path` is the checkpoint's.
Status app_origin_compare(const Record *was, const Record *is, const char *path);

// The job that an origin describes; texts are borrowed from it. STATUS_INPUT: it lacks something.
Status app_origin_read(const Record *origin, const char *path, AppJobOptions *options, const char **overlap);

#endif
