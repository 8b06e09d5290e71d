// SPDX-License-Identifier: Apache-2.0
// A model in a process of its own: a Python file, or any command. The two share memory for the numbers and a
// socket for a few words.
//
// The process is started with the socket as descriptor 3 and the memory, a file to be mapped, as 4. All words
// are unsigned, of 64 bits, in the byte order of the machine. The program sends requests of four words, and
// the process answers each by a reply of four words and, where it has one, a text (UTF-8, no 0 at its end):
//
//   request   what, count, capacity, wants        reply   failed, length of the text [bytes], gives, 0
//
//   what = 1, count = 1 (the version of this protocol): what is the model?
//            gives: bits TETLAP_MODEL_… of include/tetlap/model.h; text: its name;
//            behind it, where it has one, a line with its range as TetlapModel has it
//   what = 2: evaluate `count` pairs, 1 or more; wants: the bits that are asked for besides V
//
// failed: 0, or 1 with the reason as text; after that the program ends. The memory has room for `capacity`
// pairs, C below, and grows: where C is another than before, it must be mapped anew, 624 C bytes of it, or
// 432 C without a doubt_gradient. The arrays in it are those of TetlapModelBatch, doubles, at these bytes:
//
//   pairs 0    volume 192 C    gradient 200 C    centroid 392 C    logit 416 C    doubt 424 C
//   doubt_gradient 432 C
//
// The arrays that are wanted are NaN before a request. When the socket is closed the process ends. What it
// prints goes to the program's standard error.
//
// A reply that takes longer than $TETLAP_MODEL_SECONDS, 300 by default, ends the process and the run.
#ifndef TETLAP_OVERLAP_FOREIGN_PROCESS_H
#define TETLAP_OVERLAP_FOREIGN_PROCESS_H

#include "overlap/foreign/port.h"

// What the shell's `exec` takes: one program with its arguments, and redirections.
Status overlap_foreign_process_open(OverlapForeignPort *port, const char *command);

// `path:name` of a Python file; run by $TETLAP_PYTHON, `python3` by default, with python/tetlap/serve.py.
Status overlap_foreign_process_open_python(OverlapForeignPort *port, const char *word);

// `channel:SOCKET:MEMORY:NAME`: the other side, which has started this program, holds the other end. The same
// word may be opened more than once, in one thread: each asks what the model is, and the memory only grows.
// STATUS_INPUT: the descriptors are not there, as in a run that is resumed.
Status overlap_foreign_process_attach(OverlapForeignPort *port, const char *word);

// Programs that this one starts inherit the channel of such a word, and may open it one after the other.
// STATUS_INPUT: as above.
Status overlap_foreign_process_hand_on(const char *word);

#endif
