// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/config.h"

#include <string.h>

#include "app/scene/read.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "overlap/geo/features/features.h"

#define AT(Type, field) offsetof(Type, field), sizeof(((Type *)0)->field)

static const SceneChoices kind_choices = {
    .listed =
        (const SceneChoice[]){{"geo", "analytic-centre frame, symmetric features, a small dense network"},
                              {"tpn", "TetrahedronPairNet as published (reading c) or after it"},
                              {"bound", "a bound of the error of a geo's V, which `hybrid` goes by"},
                              {0}}};
static const SceneChoices reading_choices = {
    .listed = (const SceneChoice[]){{"a", "coordinates concatenated, biased skips; 73,370 parameters"},
                                    {"b", "a vertex skip for each index; 73,370 parameters"},
                                    {"c", "as published: one tetrahedron, blocks that end linearly; 73,370"},
                                    {"backbone", "reading a with a layer of 1024; 410,266 parameters"},
                                    {0}}};
static const SceneChoices activation_choices = {
    .listed = (const SceneChoice[]){
        {"relu", "as published; its gradient is piecewise constant"}, {"silu", "smooth"}, {0}}};
static const SceneChoices pool_choices = {
    .listed = (const SceneChoice[]){
        {"max", "as published; the gradient jumps where another vertex takes over"}, {"sum", "smooth"}, {0}}};
static const SceneChoices normalisation_choices = {
    .listed = (const SceneChoice[]){{"unit", "the first tetrahedron becomes the unit simplex"},
                                    {"pca", "the first tetrahedron's principal axes become the axes"},
                                    {"sorted", "unit, vertices in an order of their own"},
                                    {"unscaled", "unit, but the network's output is V of the pair as it was"},
                                    {"axis", "sorted, the two tetrahedra in an order of their own too"},
                                    {0}}};

static const SceneChoices schedule_choices = {
    .listed = (const SceneChoice[]){{"cosine", "half a cosine from rate to final_rate"},
                                    {"plateau", "a cut where the validation's score stops falling"},
                                    {0}}};

static const char *finish_model(void *self, const char **key) {
  const AppTrainingModelDef *model = self;
  *key = "features";
  if (model->kind == APP_MODEL_GEO && !overlap_geo_features_set(model->features))
    return "there is no set of so many features: " OVERLAP_GEO_FEATURE_COUNTS;
  if (model->kind == APP_MODEL_BOUND && !overlap_geo_features_set(model->features))
    return "there is no set of so many features: those of the network that is "
           "bounded, " OVERLAP_GEO_FEATURE_COUNTS;
  *key = "of";
  if (model->kind == APP_MODEL_BOUND && !model->of) return "name the geo whose error is bounded";
  if (model->kind != APP_MODEL_BOUND && model->of) return "only a bound is of another network";
  *key = "normalisation";
  if (model->kind == APP_MODEL_TPN && model->reading == APP_READING_C &&
      model->normalisation == APP_NORMALISATION_PCA)
    return "reading c is shown the second tetrahedron alone: unit, sorted, unscaled or axis";
  return NULL;
}

static const char *finish_root(void *self, const char **key) {
  const AppTrainingConfig *config = self;
  *key = "loss";
  if (config->loss.sobolev > 0 && config->model.normalisation != APP_NORMALISATION_UNIT)
    return "sobolev needs model.normalisation: unit";
  if (config->loss.sobolev > 0 && config->model.reading == APP_READING_C)
    return "sobolev needs a model.reading of both tetrahedra: a, b, backbone";
  return NULL;
}

// clang-format off
static const SceneKey source_keys[] = {
    {"name", SCENE_LABEL, AT(AppTrainingSourceDef, name), .help = "in logs and plots"},
    {"file", SCENE_TEXT, AT(AppTrainingSourceDef, file), .excludes = "law mix volume seed swap",
     .help = "a data set of `tetlap datagen` or of a captured run"},
    {"law", SCENE_TEXT, AT(AppTrainingSourceDef, law), .help = "pairs made on the fly by this law"},
    {"mix", SCENE_TEXT, AT(AppTrainingSourceDef, mix), .needs = "law", .help = "shares of kinds, KIND=SHARE,…"},
    {"volume", SCENE_TEXT, AT(AppTrainingSourceDef, volume), .needs = "law",
     .help = "law of the volumetric pairs' V"},
    {"count", SCENE_INTEGER, AT(AppTrainingSourceDef, count), .range = "[1, inf)",
     .absent_help = "all of the file, the law's", .help = "pairs"},
    {"seed", SCENE_INTEGER, AT(AppTrainingSourceDef, seed), .range = "[0, inf)", .needs = "law", .fallback = "1",
     .help = "of the law"},
    {"swap", SCENE_NUMBER, AT(AppTrainingSourceDef, swap), .range = "[0, 1]", .needs = "law", .fallback = "0",
     .help = "share of the pairs whose tetrahedra are exchanged: 0.5 shows both orders alike"},
    {0},
};
static const SceneSection source = {.help = "where pairs come from", .size = sizeof(AppTrainingSourceDef),
                                    .keys = source_keys, .one_of = "file law"};

static const SceneKey model_keys[] = {
    {"kind", SCENE_CHOICE, AT(AppTrainingModelDef, kind), .choices = &kind_choices, .required = "geo",
     .help = "what is trained"},
    {"features", SCENE_INTEGER, AT(AppTrainingModelDef, features), .range = "[1, 256]", .fallback = "100",
     .help = "geo, bound: size of the set of features"},
    {"width", SCENE_INTEGER, AT(AppTrainingModelDef, width), .range = "[1, 1024]", .fallback = "32",
     .help = "geo, bound: of the hidden layers"},
    {"depth", SCENE_INTEGER, AT(AppTrainingModelDef, depth), .range = "[1, 8]", .fallback = "3",
     .help = "geo, bound: number of hidden layers"},
    {"of", SCENE_TEXT, AT(AppTrainingModelDef, of), .absent_help = "of a bound it must be there",
     .help = "bound: the geo whose errors are learned, a file or the name of one that ships"},
    {"centroid", SCENE_SWITCH, AT(AppTrainingModelDef, has_centroid), .fallback = "true",
     .help = "geo: the network gives the centroid of the overlap too; without, it follows from the volume's gradient"},
    {"reading", SCENE_CHOICE, AT(AppTrainingModelDef, reading), .choices = &reading_choices, .fallback = "a",
     .help = "tpn: of the paper's table of layers"},
    {"scale", SCENE_NUMBER, AT(AppTrainingModelDef, scale), .range = "(0, 16]", .fallback = "1",
     .help = "tpn: factor of the published widths, rounded to multiples of 4"},
    {"layers", SCENE_INTEGER, AT(AppTrainingModelDef, layers), .range = "[1, 8]", .fallback = "2",
     .help = "tpn: of each block, vertex, tetrahedron, combiner"},
    {"activation", SCENE_CHOICE, AT(AppTrainingModelDef, activation), .choices = &activation_choices,
     .fallback = "relu", .help = "tpn"},
    {"pool", SCENE_CHOICE, AT(AppTrainingModelDef, pool), .choices = &pool_choices, .fallback = "max",
     .help = "tpn: over vertices and over tetrahedra"},
    {"normalisation", SCENE_CHOICE, AT(AppTrainingModelDef, normalisation), .choices = &normalisation_choices,
     .fallback = "unit", .help = "tpn: of the input"},
    {"output_scale", SCENE_NUMBER, AT(AppTrainingModelDef, output_scale), .range = "(0, inf)",
     .fallback = "1000", .help = "tpn: the network's output is this times V of the normalised pair"},
    {0},
};
static const SceneSection model = {.help = "what is trained", .keys = model_keys, .finish = finish_model};

static const SceneKey data_keys[] = {
    {"training", SCENE_LIST, AT(AppTrainingConfig, training), .section = &source,
     .count_offset = offsetof(AppTrainingConfig, training_count), .required = "[{law: scene, count: 100000}]",
     .help = "pairs to learn from, all together"},
    {"validation", SCENE_LIST, AT(AppTrainingConfig, validation), .section = &source,
     .count_offset = offsetof(AppTrainingConfig, validation_count),
     .required = "[{law: scene, count: 10000, seed: 2}]", .help = "pairs to measure on, each set by itself"},
    {0},
};
static const SceneSection data = {.help = "pairs", .keys = data_keys};

static const SceneKey loss_keys[] = {
    {"tangents", SCENE_INTEGER, AT(AppTrainingLossDef, tangents), .range = "[1, 12]", .fallback = "2",
     .help = "random directions of each sample along which derivatives are learned"},
    {"huber", SCENE_NUMBER, AT(AppTrainingLossDef, huber), .range = "(0, inf)", .fallback = "0.1",
     .help = "where the loss of derivatives, and of geo's V, turns from quadratic to linear"},
    {"tangent_scale", SCENE_NUMBER, AT(AppTrainingLossDef, tangent_scale), .range = "[0, inf)", .fallback = "1",
     .help = "geo: factor of errors of derivatives"},
    {"centroid", SCENE_NUMBER, AT(AppTrainingLossDef, centroid), .range = "(0, inf)", .fallback = "1",
     .help = "geo: weight of the centroid's errors"},
    {"quantile", SCENE_NUMBER, AT(AppTrainingLossDef, quantile), .range = "(0, 1)", .fallback = "0.95",
     .help = "bound: share of the pairs whose error it bounds"},
    {"volume_scale", SCENE_NUMBER, AT(AppTrainingLossDef, volume_scale), .range = "(0, inf)", .fallback = "1000",
     .help = "tpn: factor of V"},
    {"sobolev", SCENE_NUMBER, AT(AppTrainingLossDef, sobolev), .range = "[0, inf)", .fallback = "0",
     .help = "tpn: weight of errors of derivatives of V; 0: the paper's loss"},
    {0},
};
static const SceneSection loss = {.help = "what is minimised", .keys = loss_keys};

static const SceneKey optimiser_keys[] = {
    {"rate", SCENE_NUMBER, AT(AppTrainingOptimiserDef, rate), .range = "(0, inf)", .fallback = "2e-3",
     .help = "AdamW's learning rate at its peak"},
    {"final_rate", SCENE_NUMBER, AT(AppTrainingOptimiserDef, final_rate), .range = "[0, inf)", .fallback = "0",
     .help = "at the end of half a cosine; the least of plateau"},
    {"schedule", SCENE_CHOICE, AT(AppTrainingOptimiserDef, schedule), .choices = &schedule_choices,
     .fallback = "cosine", .help = "of the learning rate, after the warm-up"},
    {"plateau_factor", SCENE_NUMBER, AT(AppTrainingOptimiserDef, plateau_factor), .range = "(0, 1)",
     .fallback = "0.5", .help = "schedule plateau: of the rate at each cut, down to final_rate"},
    {"plateau_patience", SCENE_INTEGER, AT(AppTrainingOptimiserDef, plateau_patience), .range = "[0, inf)",
     .fallback = "5", .help = "schedule plateau: validations without a gain of 1e-4 before a cut"},
    {"warmup", SCENE_NUMBER, AT(AppTrainingOptimiserDef, warmup), .range = "[0, 1)", .fallback = "0.01",
     .help = "share of the steps before the peak"},
    {"beta1", SCENE_NUMBER, AT(AppTrainingOptimiserDef, beta1), .range = "[0, 1)", .fallback = "0.9",
     .help = "decay of the first moment"},
    {"beta2", SCENE_NUMBER, AT(AppTrainingOptimiserDef, beta2), .range = "[0, 1)", .fallback = "0.999",
     .help = "decay of the second moment"},
    {"weight_decay", SCENE_NUMBER, AT(AppTrainingOptimiserDef, weight_decay), .range = "[0, inf)",
     .fallback = "0", .help = "decoupled, as AdamW has it"},
    {"clip", SCENE_NUMBER, AT(AppTrainingOptimiserDef, clip), .range = "(0, inf)", .fallback = "1",
     .help = "largest norm of a gradient"},
    {"batch", SCENE_INTEGER, AT(AppTrainingOptimiserDef, batch), .range = "[1, 65536]", .fallback = "512",
     .help = "samples a step"},
    {"samples", SCENE_NUMBER, AT(AppTrainingOptimiserDef, samples), .range = "[1, 1e12]", .required = "1e7",
     .help = "seen in all"},
    {0},
};
static const SceneSection optimiser = {.help = "AdamW", .keys = optimiser_keys};

static const SceneKey root_keys[] = {
    {"name", SCENE_LABEL, AT(AppTrainingConfig, name), .required = "geo",
     .help = "of the model: NAME.safetensors is written"},
    {"seed", SCENE_INTEGER, AT(AppTrainingConfig, seed), .range = "[0, inf)", .fallback = "1",
     .help = "of the first weights and of the order of samples"},
    {"start", SCENE_TEXT, AT(AppTrainingConfig, start), .absent_help = "random weights",
     .help = "weights to begin with, to fine-tune them: a file, or the name of a model whose weights ship"},
    {"model", SCENE_SECTION, AT(AppTrainingConfig, model), .section = &model, .required = "{kind: geo}",
     .help = "what is trained"},
    {"data", SCENE_SECTION, .section = &data, .required = "{…}", .help = "pairs"},
    {"loss", SCENE_SECTION, AT(AppTrainingConfig, loss), .section = &loss, .help = "what is minimised"},
    {"optimiser", SCENE_SECTION, AT(AppTrainingConfig, optimiser), .section = &optimiser,
     .required = "{samples: 1e7}", .help = "AdamW and how long"},
    {"validations", SCENE_INTEGER, AT(AppTrainingConfig, validations), .range = "[1, 100000]", .fallback = "50",
     .help = "how often the validation data are evaluated, evenly spaced; as often a checkpoint is written"},
    {"patience", SCENE_INTEGER, AT(AppTrainingConfig, patience), .range = "[0, inf)", .fallback = "0",
     .help = "stop after so many validations without a better score; 0: never"},
    {0},
};
// clang-format on
static const SceneSection training_keys = {
    .help = "a training", .size = sizeof(AppTrainingConfig), .keys = root_keys, .finish = finish_root};

static void destroy_sources(AppTrainingSourceDef *sources, int count) {
  for (int s = 0; s < count; s++) {
    memory_free(sources[s].name), memory_free(sources[s].file), memory_free(sources[s].law);
    memory_free(sources[s].mix), memory_free(sources[s].volume);
  }
  memory_free(sources);
}

void app_training_config_destroy(AppTrainingConfig *config) {
  destroy_sources(config->training, config->training_count);
  destroy_sources(config->validation, config->validation_count);
  memory_free(config->name), memory_free(config->start), memory_free(config->model.of);
  memory_free(config->text), memory_free(config->path);
  *config = (AppTrainingConfig){0};
}

static Status read_all(const char *path, const char *const *overrides, int override_count,
                       AppTrainingConfig *config) {
  TRY(app_scene_read_section(path, overrides, override_count, &training_keys, config));
  config->path = memory_copy(path, strlen(path) + 1, 1);
  if (!config->path) return status_no_memory("the configuration");
  size_t size;
  return file_read(path, &config->text, &size);
}

Status app_training_config_read(const char *path, const char *const *overrides, int override_count,
                                AppTrainingConfig *config) {
  *config = (AppTrainingConfig){0};
  Status status = read_all(path, overrides, override_count, config);
  if (status) app_training_config_destroy(config);
  return status;
}

AppSourceDef app_training_config_source(const AppTrainingSourceDef *def) {
  return (AppSourceDef){.name = def->name,
                        .file = def->file,
                        .law = def->law,
                        .mix = def->mix,
                        .volume = def->volume,
                        .count = def->count,
                        .seed = (uint64_t)def->seed,
                        .swap = def->swap};
}

static const char *text_of(const char *text) {
  return text ? text : "";
}

static void print_sources(const char *key, const AppTrainingSourceDef *sources, int count, char *text,
                          size_t size, size_t *used) {
  for (int s = 0; s < count; s++) {
    const AppTrainingSourceDef *def = &sources[s];
    text_append(text, size, used, "%s: ", key);
    if (def->file)
      text_append(text, size, used, "file %s", def->file);
    else
      text_append(text, size, used, "law %s, mix %s, volume %s, seed %d", def->law, text_of(def->mix),
                  text_of(def->volume), def->seed);
    if (def->swap > 0) text_append(text, size, used, ", swap %.15g", def->swap);
    text_append(text, size, used, ", count %d\n", def->count);
  }
}

static void print_model(const AppTrainingModelDef *def, char *text, size_t size, size_t *used) {
  text_append(text, size, used, "model: %s", app_scene_section_name(&kind_choices, (int)def->kind));
  if (def->kind == APP_MODEL_GEO)
    text_append(text, size, used, ", %d features, %d x %d%s\n", def->features, def->width, def->depth,
                def->has_centroid ? ", centroid" : "");
  else if (def->kind == APP_MODEL_BOUND)
    text_append(text, size, used, ", of %s, %d features, %d x %d\n", def->of, def->features, def->width,
                def->depth);
  else
    text_append(text, size, used, ", reading %s, %s%s, %s, output_scale %.15g\n",
                app_scene_section_name(&reading_choices, (int)def->reading),
                app_scene_section_name(&activation_choices, (int)def->activation),
                def->pool == APP_POOL_SUM ? ", sum pools" : "",
                app_scene_section_name(&normalisation_choices, (int)def->normalisation), def->output_scale);
  if (def->kind == APP_MODEL_TPN && (def->scale != 1 || def->layers != 2))
    text_append(text, size, used, "size: widths times %.15g, %d layers a block\n", def->scale, def->layers);
}

char *app_training_config_print(const AppTrainingConfig *config) {
  size_t size = 2048 + 1024 * (size_t)(config->training_count + config->validation_count), used = 0;
  char *text = memory_zeroed(size, 1);
  if (!text) return NULL;
  const AppTrainingOptimiserDef *adam = &config->optimiser;
  const AppTrainingLossDef *def = &config->loss;
  print_model(&config->model, text, size, &used);
  print_sources("training", config->training, config->training_count, text, size, &used);
  print_sources("validation", config->validation, config->validation_count, text, size, &used);
  text_append(text, size, &used, "loss: tangents %d, huber %.15g, tangent_scale %.15g, volume_scale %.15g\n",
              def->tangents, def->huber, def->tangent_scale, def->volume_scale);
  if (def->sobolev > 0) text_append(text, size, &used, "sobolev: %.15g\n", def->sobolev);
  if (config->model.kind == APP_MODEL_BOUND)
    text_append(text, size, &used, "quantile: %.15g\n", def->quantile);
  if (config->model.has_centroid) text_append(text, size, &used, "centroid: %.15g\n", def->centroid);
  text_append(
      text, size, &used,
      "AdamW: rate %.15g to %.15g, warmup %.15g, betas %.15g %.15g, decay %.15g, clip %.15g, batch %d, "
      "samples %.15g\n",
      adam->rate, adam->final_rate, adam->warmup, adam->beta1, adam->beta2, adam->weight_decay, adam->clip,
      adam->batch, adam->samples);
  if (adam->schedule == APP_SCHEDULE_PLATEAU)
    text_append(text, size, &used, "plateau: factor %.15g, patience %d\n", adam->plateau_factor,
                adam->plateau_patience);
  text_append(text, size, &used, "seed: %d, start: %s, validations %d, patience %d\n", config->seed,
              text_of(config->start), config->validations, config->patience);
  return text;
}
