// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/kinds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "overlap/wrap/both.h"
#include "overlap/wrap/cut.h"
#include "overlap/wrap/mixture/coplanar.h"
#include "overlap/wrap/mixture/doubt.h"
#include "overlap/wrap/mixture/fade.h"
#include "overlap/wrap/placed.h"
#include "overlap/wrap/sound.h"

static const OverlapWrapKind *const kinds[] = {
    &overlap_wrap_cut,      &overlap_wrap_keep,    &overlap_wrap_fade,   &overlap_wrap_both,
    &overlap_wrap_coplanar, &overlap_wrap_doubt,   &overlap_wrap_placed, &overlap_wrap_derived,
    &overlap_wrap_strict,   &overlap_wrap_lenient,
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static Status fail_unknown(const char *word, int length) {
  char known[256] = "";
  size_t used = 0;
  for (int k = 0; k < KINDS; k++)
    text_append(known, sizeof known, &used, "%s%s", k ? ", " : "", kinds[k]->name);
  return status_fail(STATUS_INPUT,
                     "%s: '%.*s=' is none of what stands before a model: %s. A file's own name may not "
                     "begin so: write ./%s",
                     word, length, word, known, word);
}

// Of `:NUMBER=`; NAN where there is none.
static Status read_number(const char *word, const char *from, double *number) {
  char *end;
  *number = NAN;
  if (*from != ':') return STATUS_OK;
  *number = strtod(from + 1, &end);
  return *end == '=' && end > from + 1 && isfinite(*number)
             ? STATUS_OK
             : status_fail(STATUS_INPUT, "%s: '%.*s' before '=' is no number", word,
                           (int)strcspn(from + 1, "="), from + 1);
}

Status overlap_wrap_kinds_find(const char *word, const OverlapWrapKind **kind, double *number) {
  const size_t length = strcspn(word, ":=");
  for (int k = 0; k < KINDS; k++)
    if (strlen(kinds[k]->name) == length && strncmp(kinds[k]->name, word, length) == 0) {
      *kind = kinds[k];
      return read_number(word, word + length, number);
    }
  return fail_unknown(word, (int)length);
}
