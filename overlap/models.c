// SPDX-License-Identifier: Apache-2.0
#include "overlap/models.h"

#include <math.h>
#include <string.h>

#include "base/text.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/foreign/foreign.h"
#include "overlap/geo/model.h"
#include "overlap/hybrid/hybrid.h"
#include "overlap/source.h"
#include "overlap/tpn/model.h"
#include "overlap/weights.h"
#include "overlap/wrap/cut.h"
#include "overlap/wrap/kinds.h"
#include "overlap/wrap/mixture/doubt.h"
#include "overlap/wrap/mixture/fade.h"
#include "overlap/wrap/sound.h"

// In those programs that link it; the library that others embed (overlap/api) does not.
extern const OverlapOps overlap_cgal_ops __attribute__((weak));

// The fastest first: what a person reads when asking for the models.
static const OverlapOps *const models[] = {
    &overlap_clip_ops,      &overlap_clip32_ops, &overlap_clip_scalar_ops, &overlap_geo_small_ops,
    &overlap_geo_ops,       &overlap_tpn_ops,    &overlap_tpn_bf16_ops,    &overlap_tpn_published_ops,
    &overlap_tpn_scene_ops, &overlap_hybrid_ops, &overlap_exact_ops,       &overlap_cgal_ops,
};
enum { MOST_MODELS = sizeof models / sizeof *models };

static int model_count(void) {
  return MOST_MODELS - (&overlap_cgal_ops == NULL);
}

const OverlapOps *const *overlap_models_list(int *count) {
  *count = model_count();
  return models;
}

static Status fail_unknown(const char *name) {
  char known[256] = "";
  size_t used = 0;
  TextGuess guess = text_guess_of(name);
  for (int m = 0; m < model_count(); m++) {
    text_append(known, sizeof known, &used, "%s%s", m ? ", " : "", models[m]->name);
    text_guess_offer(&guess, models[m]->name);
  }
  if (guess.best)
    return status_fail(STATUS_INPUT, "there is no overlap model '%s': did you mean '%s'? Known are %s", name,
                       guess.best, known);
  return status_fail(STATUS_INPUT, "there is no overlap model '%s': known are %s", name, known);
}

// The model that a weights file holds.
static Status find_by_file(const char *path, const OverlapOps **ops) {
  OverlapWeightsKind kind;
  TRY(overlap_weights_kind(path, &kind));
  *ops = kind == OVERLAP_WEIGHTS_TPN ? &overlap_tpn_ops : &overlap_geo_ops;
  return STATUS_OK;
}

static OverlapUnsound unsound_of(const OverlapOptions *options) {
  return options ? options->unsound : OVERLAP_UNSOUND_AUTO;
}

static Status create_foreign(OverlapModel *model, const char *word, const OverlapOptions *options) {
  TRY(overlap_foreign_create(&model->self, &model->ops, word, unsound_of(options)));
  return overlap_model_has_ghosts(model) ? overlap_wrap_create(model, &overlap_wrap_cut, NAN, word)
                                         : STATUS_OK;
}

static Status fail_unbounded(const char *network, double doubt) {
  return status_fail(
      STATUS_INPUT,
      "hybrid: '%s' is a TetrahedronPairNet, which gives no bound of its error, so it takes no "
      "number: leave %g out, as in hybrid=%s",
      network, doubt, network);
}

static const OverlapOps *find_named(const char *name, size_t length) {
  for (int m = 0; m < model_count(); m++)
    if (strlen(models[m]->name) == length && strncmp(models[m]->name, name, length) == 0) return models[m];
  return NULL;
}

// `hybrid=NETWORK` and `hybrid:DOUBT=NETWORK`.
static Status create_hybrid(OverlapModel *model, double doubt, const char *network,
                            const OverlapOptions *given) {
  OverlapOptions options = given ? *given : overlap_options_default();
  if (!isnan(doubt)) options.doubt = doubt;
  if (!(options.doubt > 0 && options.doubt < INFINITY))
    return status_fail(STATUS_INPUT,
                       "hybrid: its number, the relative error of V from which clipping begins, "
                       "is %g; expected a positive one",
                       options.doubt);
  const OverlapOps *named = find_named(network, strlen(network));
  if (named && !named->create)
    return status_fail(STATUS_INPUT,
                       "hybrid: '%s' has no bound of its error: write a network, as in hybrid=geo, or a model of "
                       "yours that tells its doubt",
                       network);
  TRY(overlap_models_create_with(model, "hybrid", network, &options));
  if (isnan(doubt) || model->ops->has_bounds(model->self)) return STATUS_OK;
  overlap_model_destroy(model);
  return fail_unbounded(network, doubt);
}

// What stands behind the wrappers: from a `hybrid=` on, else the model.
static const char *skip_wrappers(const char *word) {
  const OverlapWrapKind *kind;
  double number;
  for (const char *inner; (inner = overlap_source_inner(word)); word = inner)
    if (overlap_wrap_kinds_find(word, &kind, &number) || kind == &overlap_wrap_doubt) break;
  return word;
}

// `hybrid=both=geo`: what has a bound of its error is the network, not what stands round it.
static Status fail_around(const char *inner) {
  const char *behind = skip_wrappers(inner);
  const bool is_hybrid = strncmp(behind, "hybrid", strlen("hybrid")) == 0;
  return status_fail(STATUS_INPUT,
                     "hybrid: '%s' tells no doubt: where the network has a bound of its error, write "
                     "%.*s%s%s",
                     inner, (int)(behind - inner), inner,
                     is_hybrid ? "" : "hybrid=", is_hybrid ? behind : overlap_source_model(behind));
}

static Status create_inner(OverlapModel *model, const OverlapWrapKind *kind, const char *inner,
                           const OverlapOptions *given) {
  OverlapOptions options = given ? *given : overlap_options_default();
  if (kind == &overlap_wrap_strict) options.unsound = OVERLAP_UNSOUND_FATAL;
  if (kind == &overlap_wrap_lenient) options.unsound = OVERLAP_UNSOUND_COUNT;
  return overlap_models_create_with(model, inner, NULL, &options);
}

// A word with something before its model: a wrapper, or what a network is used as.
static Status create_round(OverlapModel *model, const char *word, const char *inner,
                           const OverlapOptions *options) {
  const OverlapWrapKind *kind;
  double number;
  const bool is_foreign = overlap_source_is_foreign(inner), is_bare = !overlap_source_inner(inner);
  const OverlapOps *named = find_named(word, strcspn(word, "="));
  if (!*inner) return status_fail(STATUS_INPUT, "%s: a model is missing behind it, as in %sgeo", word, word);
  if (named && named->create && named != &overlap_hybrid_ops && !is_foreign && is_bare)
    return overlap_models_create_with(model, named->name, inner, options);
  TRY(overlap_wrap_kinds_find(word, &kind, &number));
  if (kind == &overlap_wrap_doubt && !is_foreign && is_bare)
    return create_hybrid(model, number, inner, options);
  if (kind == &overlap_wrap_keep && is_foreign && is_bare)
    TRY(overlap_foreign_create(&model->self, &model->ops, inner, unsound_of(options)));
  else
    TRY(create_inner(model, kind, inner, options));
  if (kind == &overlap_wrap_doubt && !is_foreign) {
    overlap_model_destroy(model);
    return fail_around(inner);
  }
  if (kind == &overlap_wrap_fade && overlap_model_has_ghosts(model))
    TRY(overlap_wrap_create(model, &overlap_wrap_cut, NAN, inner));
  return overlap_wrap_create(model, kind, number, word);
}

Status overlap_models_create_with(OverlapModel *model, const char *word, const char *weights,
                                  const OverlapOptions *options) {
  *model = (OverlapModel){0};
  const char *inner = overlap_source_inner(word);
  if (inner && weights)
    return status_fail(STATUS_INPUT, "%s: weights stand in the word, in place of the model: %.*s%s", word,
                       (int)(inner - word), word, weights);
  if (inner) return create_round(model, word, inner, options);
  if (overlap_source_is_foreign(word)) return create_foreign(model, word, options);
  const OverlapOps *ops = find_named(word, strlen(word));
  if (!ops && overlap_weights_is_path(word)) {
    TRY(find_by_file(word, &ops));
    weights = word;
  }
  if (!ops) return fail_unknown(word);
  if (ops->create) TRY(ops->create(&model->self, weights, options));
  model->ops = ops;
  return STATUS_OK;
}

bool overlap_models_lack_scale(const char *word) {
  for (; word; word = overlap_source_inner(word)) {
    const OverlapOps *ops = find_named(word, strcspn(word, "="));
    if (ops && ops->lacks_scale) return true;
  }
  return false;
}

Status overlap_models_create(OverlapModel *model, const char *word) {
  return overlap_models_create_with(model, word, NULL, NULL);
}
