// SPDX-License-Identifier: GPL-3.0-or-later
// What a run writes frame by frame: frame_NNNNN.vtu (or .pvtu) with frames.pvd, lines_NNNNN.csv, and
// history.csv; and the measures that go with a frame. docs/output.md describes every array and column.
#ifndef TETLAP_FEM_OUTPUT_RECORDER_H
#define TETLAP_FEM_OUTPUT_RECORDER_H

#include "contact/status.h"
#include "fem/effect/system.h"
#include "fem/measure/ledger.h"
#include "fem/output/columns.h"
#include "fem/output/forces.h"
#include "fem/output/frames.h"
#include "fem/output/history.h"
#include "fem/output/probes.h"
#include "fem/output/trouble.h"
#include "fem/time/audit.h"

typedef struct FemRecorder {
  FemSystem *system; // borrowed
  char *directory;   // owned; NULL: nothing is written
  bool writes_vtu;
  FemFrames frames; // where they are written
  int frame_count;  // of which there is something
  FemHistoryRows writes_history;
  FemHistory history;
  double *row;      // one line of the history
  int told;         // how many interfaces have columns: all, or none of too many
  FemForces forces; // of the state that was measured last
  FemLedger ledger;
  FemProbes probes;
  double (*moments)[3];    // scratch: of the interfaces about the origin [N m]; NULL: no history
  double *reaction;        // scratch; NULL: nothing is prescribed (vertex_count, 3)
  double *det_F, *overlap; // scratch                          (tet_count)
  FemTroubleWatch watch;
  bool has_status;             // the scene asks for the elements' status
  OverlapModel reference;      // that it is held against
  const ContactStatus *status; // of the frame being written; borrowed
  const FemState *state;       // likewise
  double seconds;              // spent writing
} FemRecorder;

// `directory` NULL: measures only.
Status fem_recorder_create(FemRecorder *recorder, FemSystem *system, const char *directory);
// Goes on from what an earlier run left in the directory: its history as of that mark, and so many frames.
// Fails as journal_continue does.
Status fem_recorder_continue(FemRecorder *recorder, JournalMark history, int frame_count);
void fem_recorder_destroy(FemRecorder *recorder);

// Removes the frames with those of obstacles, lists, history and summary that an earlier run has left in the
// folder, and says so. To be called once the first state is known, so that a run that fails before it takes
// nothing away.
Status fem_recorder_clear(const FemRecorder *recorder);

// The measures of a state, and its forces of contact (forces.h).
Status fem_recorder_measure(FemRecorder *recorder, const FemState *state, FemMeasures *measures);

// A run begins, or goes on, at the state that was measured last.
Status fem_recorder_begin_step(FemRecorder *recorder, const FemState *state, const FemMeasures *measures);
// A step would end at the state that was measured last; adds to the measures what is known of whole steps
// only.
Status fem_recorder_end_step(FemRecorder *recorder, const FemState *state, FemMeasures *measures);
// The step has ended there, and the next one begins there.
void fem_recorder_accept_step(FemRecorder *recorder);

// Into `state`: how many elements lie beyond the middle of another body at the last accepted state, as if
// they had passed through it.
void fem_recorder_find_turned(const FemRecorder *recorder, FemTroubleState *state);

// Writes one frame, or begins to (frames.h): then a failure of it is that of the next call of one of these
// three.
Status fem_recorder_write(FemRecorder *recorder, const FemColumnSource *source);

// A row of a history of steps: taken at the state that was measured last, while it is there, and appended
// once the step is accepted; nothing where the history is another.
Status fem_recorder_take_step(FemRecorder *recorder, const FemColumnSource *source);
Status fem_recorder_append_step(FemRecorder *recorder);

// Waits until what was written is on the disk.
Status fem_recorder_wait(FemRecorder *recorder);

// Ends the record: waits, and completes the list of frames.
Status fem_recorder_finish(FemRecorder *recorder);

#endif
