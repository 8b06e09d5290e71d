// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/dataset/import.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/memory.h"
#include "base/text.h"
#include "datagen/draw/proof.h"
#include "datagen/generate.h"

// Of a volume that is nearly none, rounding alone is more: this share of the smaller tetrahedron is let pass.
static const double rounding_share = 1e-12;

static const struct {
  const char *key, *words;
  bool has_size;
} faults[APP_IMPORT_FAULT_COUNT] = {
    [APP_IMPORT_MISSED_VOLUME] = {"missed_volume", "the label's V is 0, but the tetrahedra overlap", true},
    [APP_IMPORT_FALSE_VOLUME] = {"false_volume", "the label's V is above 0, but they share no volume", true},
    [APP_IMPORT_WRONG_VOLUME] = {"wrong_volume", "the label's V is another than the exact one", true},
    [APP_IMPORT_MISSED_CONTACT] = {"missed_contact", "the status is 0, but they have a point in common",
                                   false},
    [APP_IMPORT_FALSE_CONTACT] = {"false_contact", "the status is 1, but they have no point in common",
                                  false},
    [APP_IMPORT_WRONG_GRADIENT] = {"wrong_gradient", "the label's derivatives are others than the exact ones",
                                   true},
    [APP_IMPORT_FLAT] = {"flat", "a tetrahedron has no volume: the pair is left out", false},
};

typedef struct Run {
  AppPairsReader *reader;
  const AppImportDef *def;
  AppImport *import;
  DatagenWriter *writer;
  DatagenPairs pairs; // a block, with exact labels
  bool *are_flat;     // (APP_PAIRS_BLOCK)
  bool has_gradient;
} Run;

static void find_fault(AppImport *import, AppImportFault fault, double size, long long place) {
  AppImportFinding *finding = &import->findings[fault];
  if (finding->count < APP_IMPORT_NAMED) finding->places[finding->count] = place;
  if (finding->count == 0 || size > finding->largest) finding->largest = size, finding->largest_place = place;
  finding->count++;
  log_debug("place %lld: %s", place, faults[fault].words);
}

// The first kind of contact that the proof bears out; CAPTURED, which claims nothing, where there is none.
static DatagenKind kind_of(const DatagenProof *proof) {
  for (int k = DATAGEN_NONE; k < DATAGEN_SCENE; k++)
    if (datagen_proof_confirms(proof, (DatagenKind)k)) return (DatagenKind)k;
  return DATAGEN_CAPTURED;
}

static Status label_pair(const Run *run, int i) {
  const double *pair = run->reader->block.coordinates + APP_PAIRS_SIZE * (size_t)i;
  DatagenProof proof = datagen_proof_of(pair);
  memcpy(run->pairs.coordinates + APP_PAIRS_SIZE * (size_t)i, pair, APP_PAIRS_SIZE * sizeof *pair);
  run->are_flat[i] = proof.is_flat;
  run->pairs.status[i] = proof.dimension >= 0;
  run->pairs.kind[i] = (uint8_t)(proof.is_flat ? DATAGEN_CAPTURED : kind_of(&proof));
  return datagen_generate_label(DATAGEN_LABEL_EXACT, pair, proof.dimension, run->pairs.volume + i,
                                run->pairs.gradient + APP_PAIRS_SIZE * (size_t)i,
                                run->pairs.centroid + 3 * (size_t)i);
}

static Status label_block(const Run *run) {
  int failed = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : failed)
  for (int i = 0; i < run->reader->block.count; i++) failed += label_pair(run, i) != STATUS_OK;
  return failed ? status_fail(STATUS_SOLVER, "%s: %d pairs could not be labelled", run->reader->name, failed)
                : STATUS_OK;
}

static double tet_volume(const double *tet) {
  double edges[3][3];
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) edges[k][c] = tet[3 * (k + 1) + c] - tet[c];
  double cross[3] = {edges[1][1] * edges[2][2] - edges[1][2] * edges[2][1],
                     edges[1][2] * edges[2][0] - edges[1][0] * edges[2][2],
                     edges[1][0] * edges[2][1] - edges[1][1] * edges[2][0]};
  return fabs(edges[0][0] * cross[0] + edges[0][1] * cross[1] + edges[0][2] * cross[2]) / 6;
}

static void check_volume(const Run *run, int i, double smaller) {
  const AppPairsBlock *block = &run->reader->block;
  double exact = run->pairs.volume[i], label = block->volume[i];
  double error = fabs(label - exact), bound = run->def->tolerance * exact + rounding_share * smaller;
  if (exact > 0 && label == 0)
    find_fault(run->import, APP_IMPORT_MISSED_VOLUME, exact, block->places[i]);
  else if (error > bound)
    find_fault(run->import, exact > 0 ? APP_IMPORT_WRONG_VOLUME : APP_IMPORT_FALSE_VOLUME, error,
               block->places[i]);
}

static double norm(const double *values) {
  double sum = 0;
  for (int k = 0; k < APP_PAIRS_SIZE; k++) sum += values[k] * values[k];
  return sqrt(sum);
}

static void check_gradient(const Run *run, int i, double smaller) {
  const AppPairsBlock *block = &run->reader->block;
  const double *exact = run->pairs.gradient + APP_PAIRS_SIZE * (size_t)i,
               *label = block->gradient + APP_PAIRS_SIZE * (size_t)i;
  double difference[APP_PAIRS_SIZE];
  for (int k = 0; k < APP_PAIRS_SIZE; k++) difference[k] = label[k] - exact[k];
  double area = cbrt(smaller) * cbrt(smaller);
  if (norm(difference) > run->def->tolerance * norm(exact) + rounding_share * area)
    find_fault(run->import, APP_IMPORT_WRONG_GRADIENT, norm(difference), block->places[i]);
}

static void check_pair(const Run *run, int i) {
  const AppPairsReader *reader = run->reader;
  const double *pair = reader->block.coordinates + APP_PAIRS_SIZE * (size_t)i;
  if (run->are_flat[i]) {
    find_fault(run->import, APP_IMPORT_FLAT, 0, reader->block.places[i]);
    return;
  }
  double smaller = fmin(tet_volume(pair), tet_volume(pair + 12));
  if (reader->has_volume) check_volume(run, i, smaller);
  if (reader->has_gradient) check_gradient(run, i, smaller);
  if (reader->has_status && reader->block.status[i] != run->pairs.status[i])
    find_fault(run->import, run->pairs.status[i] ? APP_IMPORT_MISSED_CONTACT : APP_IMPORT_FALSE_CONTACT, 0,
               reader->block.places[i]);
}

// Moves the pairs that are not flat together; how many they are.
static size_t drop_flat(const Run *run) {
  const DatagenPairs *pairs = &run->pairs;
  size_t kept = 0;
  for (size_t i = 0; i < (size_t)run->reader->block.count; i++) {
    if (run->are_flat[i]) continue;
    memmove(pairs->coordinates + APP_PAIRS_SIZE * kept, pairs->coordinates + APP_PAIRS_SIZE * i,
            APP_PAIRS_SIZE * sizeof(double));
    memmove(pairs->gradient + APP_PAIRS_SIZE * kept, pairs->gradient + APP_PAIRS_SIZE * i,
            APP_PAIRS_SIZE * sizeof(double));
    pairs->status[kept] = pairs->status[i];
    pairs->kind[kept] = pairs->kind[i];
    pairs->volume[kept] = pairs->volume[i];
    kept++;
  }
  return kept;
}

static Status import_block(Run *run) {
  TRY(label_block(run));
  for (int i = 0; i < run->reader->block.count; i++) check_pair(run, i);
  run->import->read += run->reader->block.count;
  size_t kept = drop_flat(run);
  run->import->written += (long long)kept;
  DatagenPairs pairs = run->pairs;
  if (!run->has_gradient) pairs.gradient = NULL;
  return kept ? datagen_dataset_writer_append(run->writer, &pairs, kept, NULL) : STATUS_OK;
}

static Status import_blocks(Run *run) {
  for (;;) {
    Status status = app_pairs_reader_next(run->reader);
    if (run->def->stop && *run->def->stop)
      return status_fail(STATUS_INTERRUPTED, "interrupted; nothing was written");
    if (status || run->reader->block.count == 0) return status;
    TRY(import_block(run));
  }
}

static Status conclude(const Run *run) {
  long long wrong = app_dataset_import_fault_count(run->import);
  if (run->def->is_strict && wrong > 0)
    return status_fail(STATUS_INPUT, "%s: %lld labels are wrong; nothing was written", run->reader->name,
                       wrong);
  if (run->import->written == 0)
    return status_fail(STATUS_INPUT, "%s: every pair has a tetrahedron without volume; nothing was written",
                       run->reader->name);
  return STATUS_OK;
}

static Status begin(Run *run) {
  DatagenInfo info;
  memset(&info, 0, sizeof info);
  info.generator_version = DATAGEN_GENERATOR_VERSION;
  snprintf(info.program, sizeof info.program, "%s", run->def->program);
  snprintf(info.law, sizeof info.law, "imported");
  snprintf(info.mix, sizeof info.mix, "imported");
  snprintf(info.volume_law, sizeof info.volume_law, "imported");
  snprintf(info.label, sizeof info.label, "%s", datagen_plan_label_name(DATAGEN_LABEL_EXACT));
  info.has_gradient = run->has_gradient;
  info.has_centroid = true;
  TRY(datagen_pairs_create(&run->pairs, APP_PAIRS_BLOCK, true));
  run->are_flat = memory_zeroed(APP_PAIRS_BLOCK, sizeof *run->are_flat);
  if (!run->are_flat) return status_no_memory("a block of pairs");
  return datagen_dataset_writer_begin(&run->writer, run->def->output, &info);
}

Status app_dataset_import_run(AppPairsReader *reader, const AppImportDef *def, AppImport *import) {
  Run run = {.reader = reader,
             .def = def,
             .import = import,
             .has_gradient = def->has_gradient || reader->has_gradient};
  *import = (AppImport){0};
  Status status = begin(&run);
  if (!status) status = import_blocks(&run);
  if (!status) status = conclude(&run);
  if (status)
    datagen_dataset_writer_abandon(run.writer);
  else
    status = datagen_dataset_writer_commit(run.writer);
  datagen_pairs_destroy(&run.pairs);
  memory_free(run.are_flat);
  return status;
}

long long app_dataset_import_fault_count(const AppImport *import) {
  long long count = 0;
  for (int f = 0; f < APP_IMPORT_FLAT; f++) count += import->findings[f].count;
  return count;
}

void app_dataset_import_tell(const AppImport *import, AppImportFault fault, const char *place_word,
                             char *text, size_t size) {
  const AppImportFinding *finding = &import->findings[fault];
  size_t used = 0;
  int named = finding->count < APP_IMPORT_NAMED ? (int)finding->count : APP_IMPORT_NAMED;
  text_append(text, size, &used, "%lld of %lld pairs: %s (%s", finding->count, import->read,
              faults[fault].words, place_word);
  for (int n = 0; n < named; n++) text_append(text, size, &used, "%s %lld", n ? "," : "", finding->places[n]);
  text_append(text, size, &used, finding->count > named ? ", …)" : ")");
  if (faults[fault].has_size)
    text_append(text, size, &used, "; at most by %.3g, in %s %lld", finding->largest, place_word,
                finding->largest_place);
}

void app_dataset_import_record(const AppImport *import, Record *record) {
  record_integer(record, "pairs", import->read);
  record_integer(record, "written", import->written);
  record_integer(record, "wrong_labels", app_dataset_import_fault_count(import));
  Record *findings = record_child(record, "findings");
  for (int f = 0; f < APP_IMPORT_FAULT_COUNT; f++) {
    const AppImportFinding *finding = &import->findings[f];
    Record *row = record_child(findings, faults[f].key);
    record_integer(row, "count", finding->count);
    RecordList *places = record_list(row, "places");
    for (int n = 0; n < finding->count && n < APP_IMPORT_NAMED; n++)
      record_append_integer(places, finding->places[n]);
    if (!faults[f].has_size || finding->count == 0) continue;
    record_number(row, "largest", finding->largest);
    record_integer(row, "largest_place", finding->largest_place);
  }
}
