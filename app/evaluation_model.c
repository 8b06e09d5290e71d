// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation_model.h"

#include <stdbool.h>
#include <string.h>

#include "base/file.h"
#include "contact/geo_overlap.h"

// `self` is made from a path, so there is no `create`.
static const ContactOverlapOps geo_of_file = {
    .name = "geo",
    .help = "the analytic-centre frame with the network of a file",
    .has_hessian = true,
    .seconds_per_pair = 5e-6,
    .eval_pair = contact_geo_overlap_eval_pair,
    .eval_batch = contact_geo_overlap_eval_batch,
    .destroy = contact_geo_overlap_destroy,
};

static bool is_path(const char *name) {
  size_t length = strlen(name);
  static const char ending[] = ".safetensors";
  size_t wanted = sizeof ending - 1;
  return strchr(name, '/') || (length > wanted && strcmp(name + length - wanted, ending) == 0);
}

Status app_evaluation_model_open(ContactOverlapModel *model, const char *name) {
  *model = (ContactOverlapModel){0};
  bool is_constant = strcmp(name, "geo-constant") == 0;
  if (!is_constant && !is_path(name)) return contact_overlap_create(model, name);
  if (!is_constant && !file_exists(name)) return status_fail(STATUS_IO, "%s: there is no such file", name);
  TRY(contact_geo_overlap_create(&model->self, is_constant ? NULL : name));
  model->ops = &geo_of_file;
  return STATUS_OK;
}
