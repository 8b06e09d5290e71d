// SPDX-License-Identifier: GPL-3.0-or-later
// The configuration of `tetlap train`: a YAML or JSON file, read by a table of keys as scene files are.
#ifndef TETLAP_APP_TRAINING_CONFIG_H
#define TETLAP_APP_TRAINING_CONFIG_H

#include <stdbool.h>
#include <stddef.h>

#include "app/dataset/source.h"
#include "app/scene/keys/keys.h"

typedef enum AppModelKind { APP_MODEL_GEO, APP_MODEL_TPN, APP_MODEL_BOUND } AppModelKind;
typedef enum AppNormalisation {
  APP_NORMALISATION_UNIT,
  APP_NORMALISATION_PCA,
  APP_NORMALISATION_SORTED,
  APP_NORMALISATION_UNSCALED,
  APP_NORMALISATION_AXIS,
} AppNormalisation;
typedef enum AppReading {
  APP_READING_A,
  APP_READING_B,
  APP_READING_C,
  APP_READING_BACKBONE,
} AppReading;
typedef enum AppSchedule { APP_SCHEDULE_COSINE, APP_SCHEDULE_PLATEAU } AppSchedule;
typedef enum AppPool { APP_POOL_MAX, APP_POOL_SUM } AppPool;
typedef enum AppActivation { APP_ACTIVATION_RELU, APP_ACTIVATION_SILU } AppActivation;

// A source of pairs as the file has it.
typedef struct AppTrainingSourceDef {
  char *name, *file, *law, *mix, *volume; // owned; NULL: not given
  int count;                              // 0: all
  int seed;
  double swap; // share of a law's pairs whose tetrahedra are exchanged
} AppTrainingSourceDef;

typedef struct AppTrainingModelDef {
  AppModelKind kind;
  int features, width, depth;     // geo, bound
  char *of;                       // bound: the geo whose error it bounds, owned
  bool has_centroid;              // geo: the network gives the centroid too
  AppReading reading;             // tpn
  AppActivation activation;       // tpn
  AppPool pool;                   // tpn
  AppNormalisation normalisation; // tpn
  double scale;                   // tpn: factor of all published widths
  int layers;                     // tpn: of the vertex, the tetrahedron and the combiner block
  double output_scale;            // tpn: the network's output is this times V
} AppTrainingModelDef;

typedef struct AppTrainingLossDef {
  int tangents;         // geo: directions a sample
  double huber;         // geo: where Huber's function turns linear
  double tangent_scale; // geo: factor of the tangents' term inside Huber's function
  double centroid;      // geo: weight of the centroid's errors
  double volume_scale;  // tpn: V is multiplied by it
  double quantile;      // bound: share of pairs whose error it bounds
  double sobolev;       // tpn: weight of errors of ∇V; 0: the paper's loss
} AppTrainingLossDef;

typedef struct AppTrainingOptimiserDef {
  double rate, final_rate; // of AdamW, at the peak and at the end
  AppSchedule schedule;
  double plateau_factor; // plateau: of the rate at each cut
  int plateau_patience;  // plateau: validations without gain before a cut
  double warmup;         // share of the steps until the peak
  double beta1, beta2, weight_decay;
  double clip; // largest norm of a gradient
  int batch;
  double samples; // seen in all
} AppTrainingOptimiserDef;

typedef struct AppTrainingConfig {
  char *name;  // of the model, owned
  char *start; // weights to begin from, owned; NULL: random ones
  int seed;
  AppTrainingModelDef model;
  AppTrainingSourceDef *training; // (training_count), owned
  int training_count;
  AppTrainingSourceDef *validation; // (validation_count), owned
  int validation_count;
  AppTrainingLossDef loss;
  AppTrainingOptimiserDef optimiser;
  int validations; // of the whole training, evenly spaced
  int patience;    // validations without a better score until it stops; 0: to the end
  char *text;      // the file as it was read, owned
  char *path;      // owned
} AppTrainingConfig;

// Reads and checks. On failure nothing is left. STATUS_INPUT: file:line:column and what is wrong.
Status app_training_config_read(const char *path, const char *const *overrides, int override_count,
                                AppTrainingConfig *config);
void app_training_config_destroy(AppTrainingConfig *config); // a zeroed one is accepted

AppSourceDef app_training_config_source(const AppTrainingSourceDef *def);

// Everything that decides the result, one line a key, the same for equal trainings: what a checkpoint is
// compared with. To be freed with memory_free; NULL: no memory.
char *app_training_config_print(const AppTrainingConfig *config);

#endif
