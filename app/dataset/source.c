// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/dataset/source.h"

#include <string.h>

#include "base/text.h"
#include "datagen/generate.h"

enum { BLOCK = 16384, SIZE = 24 };

static Status open_law(AppSource *source, const AppSourceDef *def, bool wants_gradient) {
  DatagenLaw law;
  TRY(datagen_law_find(def->law, &law));
  if (def->mix) TRY(datagen_law_parse_mix(law.mix, def->mix));
  if (def->swap > 0) law.swap_share = def->swap;
  if (def->volume) TRY(datagen_volume_law_parse(&law.volume, def->volume));
  TRY(datagen_plan_make(&source->plan, &law, def->seed, def->count ? def->count : law.default_count));
  source->plan.label = DATAGEN_LABEL_CLIP;
  source->plan.wants_gradient = wants_gradient;
  source->count = source->plan.count;
  source->has_gradient = wants_gradient;
  source->has_centroid = true;
  return STATUS_OK;
}

static Status open_file(AppSource *source, const AppSourceDef *def) {
  TRY(datagen_dataset_open(&source->dataset, def->file));
  const DatagenInfo *info = datagen_dataset_info(source->dataset);
  source->count = info->count;
  source->has_gradient = info->has_gradient;
  source->has_centroid = info->has_centroid;
  if (def->count > info->count)
    return status_fail(STATUS_INPUT, "%s holds %lld pairs, %lld are wanted", def->file, info->count,
                       def->count);
  if (def->count) source->count = def->count;
  return STATUS_OK;
}

Status app_dataset_source_open(AppSource *source, const AppSourceDef *def, bool wants_gradient) {
  *source = (AppSource){0};
  return def->file ? open_file(source, def) : open_law(source, def, wants_gradient);
}

void app_dataset_source_close(AppSource *source) {
  datagen_dataset_close(source->dataset);
  *source = (AppSource){0};
}

// ∇V and x̄ of the pairs by clipping, of those that are not NULL.
static Status complete(const DatagenPairs *pairs, size_t count) {
  bool has_failed = false;
#pragma omp parallel for schedule(dynamic, 64) reduction(|| : has_failed)
  for (size_t i = 0; i < count; i++) {
    double volume;
    if (datagen_generate_label(DATAGEN_LABEL_CLIP, pairs->coordinates + i * SIZE,
                               pairs->volume[i] > 0 ? 3 : -1, &volume,
                               pairs->gradient ? pairs->gradient + i * SIZE : NULL,
                               pairs->centroid ? pairs->centroid + i * 3 : NULL) != STATUS_OK)
      has_failed = true;
  }
  return has_failed ? status_fail(STATUS_SOLVER, "clipping gave no answer for a pair") : STATUS_OK;
}

Status app_dataset_source_read(AppSource *source, long long first, size_t count, const DatagenPairs *pairs) {
  long long attempts[DATAGEN_KIND_COUNT] = {0};
  DatagenPairs read = *pairs, missing = {.coordinates = pairs->coordinates, .volume = pairs->volume};
  if (!source->has_gradient) missing.gradient = pairs->gradient, read.gradient = NULL;
  if (!source->has_centroid) missing.centroid = pairs->centroid, read.centroid = NULL;
  TRY(source->dataset ? datagen_dataset_read(source->dataset, first, count, &read)
                      : datagen_generate(&source->plan, first, (int)count, &read, attempts));
  return missing.gradient || missing.centroid ? complete(&missing, count) : STATUS_OK;
}

static Status load_block(AppSource *source, const DatagenPairs *pairs, size_t first, size_t count) {
  DatagenPairs block = {.coordinates = pairs->coordinates + first * SIZE,
                        .status = pairs->status + first,
                        .kind = pairs->kind + first,
                        .volume = pairs->volume + first,
                        .gradient = pairs->gradient + first * SIZE,
                        .centroid = pairs->centroid + first * 3};
  return app_dataset_source_read(source, (long long)first, count, &block);
}

static Status load(AppSource *source, DatagenPairs *pairs, size_t *count) {
  *count = (size_t)source->count;
  TRY(datagen_pairs_create(pairs, *count, true));
  Status status = STATUS_OK;
  for (size_t first = 0; first < *count && !status; first += BLOCK)
    status = load_block(source, pairs, first, *count - first < BLOCK ? *count - first : BLOCK);
  if (status) datagen_pairs_destroy(pairs);
  return status;
}

Status app_dataset_source_load(const AppSourceDef *def, DatagenPairs *pairs, size_t *count) {
  AppSource source;
  Status status = app_dataset_source_open(&source, def, true);
  if (!status) status = load(&source, pairs, count);
  app_dataset_source_close(&source);
  return status;
}

void app_dataset_source_describe(const AppSourceDef *def, const AppSource *source, char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  if (def->file) {
    text_append(text, size, &used, "file %s, %lld pairs", def->file, source->count);
    return;
  }
  char mix[DATAGEN_MIX_TEXT], volume[DATAGEN_VOLUME_TEXT];
  datagen_law_print_mix(source->plan.law.mix, mix, sizeof mix);
  datagen_volume_law_print(&source->plan.law.volume, volume, sizeof volume);
  text_append(text, size, &used, "law %s (%s; V %s), seed %llu, %lld pairs", def->law, mix, volume,
              (unsigned long long)def->seed, source->count);
  if (source->plan.law.swap_share > 0)
    text_append(text, size, &used, ", %g of them exchanged", source->plan.law.swap_share);
}

bool app_dataset_source_is_paper(const AppSourceDef *def, const AppSource *source) {
  static const char name[] = "paper-test";
  DatagenLaw law;
  if (!source->dataset) return strcmp(def->law, name) == 0 && !def->volume && !def->mix && !(def->swap > 0);
  const DatagenInfo *info = datagen_dataset_info(source->dataset);
  char volume[DATAGEN_VOLUME_TEXT];
  if (strcmp(info->law, name) != 0 || datagen_law_find(name, &law) != STATUS_OK) return false;
  datagen_volume_law_print(&law.volume, volume, sizeof volume);
  return strcmp(info->volume_law, volume) == 0;
}
