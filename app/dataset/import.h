// SPDX-License-Identifier: GPL-3.0-or-later
// The user's labelled pairs as a data set: every status and volume is computed again in exact arithmetic;
// labels of the file that differ are counted and named.
#ifndef TETLAP_APP_DATASET_IMPORT_H
#define TETLAP_APP_DATASET_IMPORT_H

#include <signal.h>

#include "app/pairs/reader.h"
#include "base/files/record.h"

// What can be wrong with a label.
typedef enum AppImportFault {
  APP_IMPORT_MISSED_VOLUME,  // V is 0, and the pair overlaps
  APP_IMPORT_FALSE_VOLUME,   // V is above 0, and the pair shares no volume
  APP_IMPORT_WRONG_VOLUME,   // V is another
  APP_IMPORT_MISSED_CONTACT, // the status is 0, and they have a point in common
  APP_IMPORT_FALSE_CONTACT,  // the status is 1, and they have none
  APP_IMPORT_WRONG_GRADIENT, // the derivatives are others
  APP_IMPORT_FLAT,           // a tetrahedron without volume: the pair is left out
  APP_IMPORT_FAULT_COUNT
} AppImportFault;

enum { APP_IMPORT_NAMED = 10 };

typedef struct AppImportFinding {
  long long count;
  long long places[APP_IMPORT_NAMED]; // the first ones, in the file
  double largest;                     // of the differences, in the label's unit; without meaning for statuses
  long long largest_place;
} AppImportFinding;

typedef struct AppImport {
  long long read, written; // pairs
  AppImportFinding findings[APP_IMPORT_FAULT_COUNT];
} AppImport;

typedef struct AppImportDef {
  const char *output, *program;      // the set to write; "tetlap 0.1.0"
  double tolerance;                  // share of V, and of |∇V|, by which a label may be off
  bool has_gradient;                 // the set gets the derivatives; so it does if the file has them
  bool is_strict;                    // a fault is an error, and nothing is written
  const volatile sig_atomic_t *stop; // not used if NULL; set: the import ends, and nothing is written
} AppImportDef;

// Reads all pairs and writes the set. STATUS_INPUT: the file is wrong, or strict and a label is;
// STATUS_INTERRUPTED. The findings are those up to there.
Status app_dataset_import_run(AppPairsReader *reader, const AppImportDef *def, AppImport *import);

// How many labels were wrong; pairs that are flat are not among them.
long long app_dataset_import_fault_count(const AppImport *import);

// A finding in words: what, how many, where. `place_word`: what the file's places are called.
void app_dataset_import_tell(const AppImport *import, AppImportFault fault, const char *place_word,
                             char *text, size_t size);
void app_dataset_import_record(const AppImport *import, Record *record);

#endif
