// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of time, or of something else, written as formulas, "0.1*sin(2*pi*t)": parsed once into a short
// list of instructions for a stack. They are evaluated together with the exact first and second derivative
// (forward differentiation). A formula has no other names than these, no loops and no files; parsing and
// evaluation are bounded in time and memory.
//
//   numbers, t, pi          + - * / ^ (right to left, before a sign: −t^2 = −(t^2)), ( )
//   sin cos tan exp log sqrt abs floor
//   step(x)    0 for x < 0, else 1
//   smooth(x)  0 for x < 0, 3x² − 2x³, 1 for x > 1: a rise without a kink
//   min(a, b)  max(a, b)
#ifndef TETLAP_BASE_EXPRESSION_H
#define TETLAP_BASE_EXPRESSION_H

#include <stdbool.h>

#include "base/status.h"

enum { EXPRESSION_MAX_CODES = 64, EXPRESSION_MAX_DEPTH = 24, EXPRESSION_MAX_TEXT = 200 };

typedef struct ExpressionCode {
  int operation;
  double number; // of a constant
} ExpressionCode;

typedef struct Expression {
  char text[EXPRESSION_MAX_TEXT]; // as it was written
  int line, column;               // where it stands in its file, set by the caller; 0: in none
  int count;
  ExpressionCode codes[EXPRESSION_MAX_CODES]; // in the order of evaluation  (count)
} Expression;

typedef struct ExpressionValue {
  double value, rate; // f(t), df/dt; at a jump or a kink the rate from above
  double curve;       // d²f/dt²; of a kink nothing
} ExpressionValue;

// `argument`: its name in the text. STATUS_INPUT: the message says at which character (from 1) and what was
// expected there.
Status expression_parse(Expression *expression, const char *argument, const char *text);

// Whether t does not occur in it.
bool expression_is_constant(const Expression *expression);

// The functions there are, one after the other, with a line of help; NULL beyond the last.
const char *expression_function(int index, const char **help);

// NaN or infinite where the formula is: log(0), 1/0.
ExpressionValue expression_eval(const Expression *expression, double t);

// The next time after `t` at which floor, step, smooth, abs, min or max may make a jump or a kink. Only those
// whose arguments are straight in t until then are foreseen, exactly up to rounding; INFINITY: none is.
double expression_next_kink(const Expression *expression, double t);

#endif
