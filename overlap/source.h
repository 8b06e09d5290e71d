// SPDX-License-Identifier: Apache-2.0
// The word by which a model is named, everywhere: its form says what it is.
//
//   clip                  a model of the program's (overlap/models.h lists them)
//   net.safetensors       weights of a network of ours
//   mine.so               a library of the user's (include/tetlap/model.h)
//   mine.py:volume        a function, or a torch.nn.Module, in a Python file
//   mine.py               the one that is named `model`
//   mine.onnx             a network that ONNX Runtime runs, in a Python that has it
//   exec:COMMAND          a program that speaks the protocol of overlap/foreign/process.h
//   channel:3:4:volume    a function of the program that started this one (the same protocol)
//   NAME=WORD             the model of a word with a wrapper round it (overlap/wrap/kinds.h), as in
//   NAME:NUMBER=WORD      both=mine.so, fade:.05=both=mine.py:volume
//   MODEL=net.safetensors a model of the program's with another network, as in tpn-scene=mine.safetensors
#ifndef TETLAP_OVERLAP_SOURCE_H
#define TETLAP_OVERLAP_SOURCE_H

#include <stdbool.h>
#include <stddef.h>

typedef enum OverlapSource {
  OVERLAP_SOURCE_NAME,
  OVERLAP_SOURCE_WEIGHTS,
  OVERLAP_SOURCE_LIBRARY,
  OVERLAP_SOURCE_PYTHON,
  OVERLAP_SOURCE_COMMAND,
  OVERLAP_SOURCE_CHANNEL,
} OverlapSource;

// Of the innermost model.
OverlapSource overlap_source_of(const char *word);

// The part of the word that is a file's path: from *path on, so many characters. 0: it names no file.
size_t overlap_source_path(const char *word, const char **path);

// What stands after the first `NAME=` or `NAME:NUMBER=`; NULL: there is none.
const char *overlap_source_inner(const char *word);

// What stands after all of them: the word of the model itself.
const char *overlap_source_model(const char *word);

// The word with that path in the place of its own, into `text`; false: it does not fit.
bool overlap_source_with_path(const char *word, const char *path, char *text, size_t size);

// The word with its path, where that is relative, as seen from a folder. False: it does not fit.
bool overlap_source_from(const char *word, const char *folder, char *text, size_t size);

// Whether the form of the word says what it is: it is more than a name.
bool overlap_source_has_form(const char *word);

// Whether the model is not one of ours: somebody else's code computes it.
bool overlap_source_is_foreign(const char *word);

#endif
