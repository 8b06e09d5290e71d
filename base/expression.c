// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/expression.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

enum {
  CONSTANT,
  ARGUMENT,
  ADD,
  SUBTRACT,
  MULTIPLY,
  DIVIDE,
  POWER,
  NEGATE,
  FIRST_FUNCTION, // from here on as in `functions`
};

// f(a) by f, f′ and f″ there; what does not move keeps still where f′ or f″ is infinite.
static ExpressionValue chain(ExpressionValue a, double value, double first, double second) {
  ExpressionValue result = {value, 0, 0};
  if (a.rate != 0) result.rate = first * a.rate;
  if (a.rate != 0 && second != 0) result.curve = second * a.rate * a.rate;
  if (a.curve != 0) result.curve += first * a.curve;
  return result;
}

// One line a function; `apply1` or `apply2` gives value, rate and curve.
static ExpressionValue do_sin(ExpressionValue a) {
  return chain(a, sin(a.value), cos(a.value), -sin(a.value));
}
static ExpressionValue do_cos(ExpressionValue a) {
  return chain(a, cos(a.value), -sin(a.value), -cos(a.value));
}
static ExpressionValue do_tan(ExpressionValue a) {
  double value = tan(a.value), first = 1 / (cos(a.value) * cos(a.value));
  return chain(a, value, first, 2 * value * first);
}
static ExpressionValue do_exp(ExpressionValue a) {
  double value = exp(a.value);
  return chain(a, value, value, value);
}
static ExpressionValue do_log(ExpressionValue a) {
  return chain(a, log(a.value), 1 / a.value, -1 / (a.value * a.value));
}
static ExpressionValue do_sqrt(ExpressionValue a) {
  double root = sqrt(a.value);
  return chain(a, root, 1 / (2 * root), -1 / (4 * root * a.value));
}
static ExpressionValue do_abs(ExpressionValue a) {
  bool is_falling = a.value < 0 || (a.value == 0 && a.rate < 0);
  return chain(a, fabs(a.value), is_falling ? -1 : 1, 0);
}
static ExpressionValue do_floor(ExpressionValue a) {
  return (ExpressionValue){floor(a.value), 0, 0};
}
static ExpressionValue do_step(ExpressionValue a) {
  return (ExpressionValue){a.value < 0 ? 0 : 1, 0, 0};
}
static ExpressionValue do_smooth(ExpressionValue a) {
  double x = fmin(fmax(a.value, 0), 1);
  return chain(a, x * x * (3 - 2 * x), 6 * x * (1 - x), x == a.value ? 6 - 12 * x : 0);
}
static ExpressionValue do_min(ExpressionValue a, ExpressionValue b) {
  bool is_first = a.value < b.value || (a.value == b.value && a.rate < b.rate);
  return is_first ? a : b;
}
static ExpressionValue do_max(ExpressionValue a, ExpressionValue b) {
  bool is_first = a.value > b.value || (a.value == b.value && a.rate > b.rate);
  return is_first ? a : b;
}

// When a straight value reaches `target`, counted from now; INFINITY: it moves away, or is there.
static double time_to(ExpressionValue a, double target) {
  double time = (target - a.value) / a.rate;
  return time > 0 ? time : INFINITY;
}
// The time to the kink that a function makes of straight arguments.
static double to_whole(ExpressionValue a, ExpressionValue b) {
  (void)b;
  double below = floor(a.value);
  if (a.rate > 0) return time_to(a, below + 1);
  return time_to(a, below == a.value ? below - 1 : below);
}
static double to_zero(ExpressionValue a, ExpressionValue b) {
  (void)b;
  return time_to(a, 0);
}
static double to_zero_or_one(ExpressionValue a, ExpressionValue b) {
  (void)b;
  return fmin(time_to(a, 0), time_to(a, 1));
}
static double to_each_other(ExpressionValue a, ExpressionValue b) {
  return time_to((ExpressionValue){a.value - b.value, a.rate - b.rate, 0}, 0);
}

static const struct {
  const char *name;
  ExpressionValue (*apply1)(ExpressionValue a);
  ExpressionValue (*apply2)(ExpressionValue a, ExpressionValue b);
  double (*kink)(ExpressionValue a, ExpressionValue b); // NULL: it makes none
  const char *help;
} functions[] = {
    {"sin", do_sin, NULL, NULL, "sine, of radians"},
    {"cos", do_cos, NULL, NULL, "cosine, of radians"},
    {"tan", do_tan, NULL, NULL, "tangent, of radians"},
    {"exp", do_exp, NULL, NULL, "e to that power"},
    {"log", do_log, NULL, NULL, "natural logarithm; no number at 0 and below"},
    {"sqrt", do_sqrt, NULL, NULL, "square root; no number below 0"},
    {"abs", do_abs, NULL, to_zero, "absolute value"},
    {"floor", do_floor, NULL, to_whole, "largest whole number not above it"},
    {"step", do_step, NULL, to_zero, "0 below 0, else 1"},
    {"smooth", do_smooth, NULL, to_zero_or_one,
     "0 below 0, 3x² − 2x³ up to 1, then 1: a rise without a kink"},
    {"min", NULL, do_min, to_each_other, "the smaller of two, min(a, b)"},
    {"max", NULL, do_max, to_each_other, "the larger of two, max(a, b)"},
};
enum { FUNCTION_COUNT = sizeof functions / sizeof *functions };

const char *expression_function(int index, const char **help) {
  if (index >= FUNCTION_COUNT) return NULL;
  *help = functions[index].help;
  return functions[index].name;
}

// Recursive descent; each level of precedence is a function below.
typedef struct Parser {
  Expression *expression;
  const char *argument; // the name of what it is a function of
  const char *next;
  int nesting, stack, deepest;
} Parser;

static Status fail_at(const Parser *parser, const char *at, const char *expected) {
  int column = (int)(at - parser->expression->text) + 1;
  if (*at == 0)
    return status_fail(STATUS_INPUT, "'%s': expected %s at the end", parser->expression->text, expected);
  return status_fail(STATUS_INPUT, "'%s': expected %s at character %d, found '%.8s'",
                     parser->expression->text, expected, column, at);
}

static Status emit(Parser *parser, int operation, double number, int growth) {
  Expression *expression = parser->expression;
  parser->stack += growth;
  if (expression->count == EXPRESSION_MAX_CODES || parser->stack > EXPRESSION_MAX_DEPTH)
    return status_fail(STATUS_INPUT, "'%s': the formula is too long; give a table", expression->text);
  expression->codes[expression->count++] = (ExpressionCode){operation, number};
  return STATUS_OK;
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

static char peek(Parser *parser) {
  while (*parser->next == ' ') parser->next++;
  return *parser->next;
}

static bool accept(Parser *parser, char c) {
  if (peek(parser) != c) return false;
  parser->next++;
  return true;
}

static Status parse_sum(Parser *parser);

// Decimal numbers only: no hexadecimal, no `inf`.
static Status parse_number(Parser *parser) {
  const char *begin = parser->next, *end = begin;
  while (is_digit(*end) || *end == '.') end++;
  if ((*end == 'e' || *end == 'E') &&
      (is_digit(end[1]) || ((end[1] == '-' || end[1] == '+') && is_digit(end[2])))) {
    end += 2;
    while (is_digit(*end)) end++;
  }
  char *read;
  double number = strtod(begin, &read);
  if (read != end || !isfinite(number)) return fail_at(parser, begin, "a number");
  parser->next = end;
  return emit(parser, CONSTANT, number, 1);
}

static Status fail_name(const Parser *parser, const char *begin, const char *name) {
  TextGuess guess = text_guess_of(name);
  text_guess_offer(&guess, parser->argument);
  text_guess_offer(&guess, "pi");
  for (int f = 0; f < FUNCTION_COUNT; f++) text_guess_offer(&guess, functions[f].name);
  char expected[160];
  size_t used = 0;
  text_append(expected, sizeof expected, &used, "%s, pi", parser->argument);
  for (int f = 0; f < FUNCTION_COUNT; f++)
    text_append(expected, sizeof expected, &used, ", %s", functions[f].name);
  if (guess.best) text_append(expected, sizeof expected, &used, " (did you mean %s?)", guess.best);
  return fail_at(parser, begin, expected);
}

static Status parse_call(Parser *parser, int f) {
  if (!accept(parser, '(')) return fail_at(parser, parser->next, "'('");
  TRY(parse_sum(parser));
  if (functions[f].apply2) {
    if (!accept(parser, ',')) return fail_at(parser, parser->next, "',' and a second value");
    TRY(parse_sum(parser));
  }
  if (!accept(parser, ')')) return fail_at(parser, parser->next, "')'");
  return emit(parser, FIRST_FUNCTION + f, 0, functions[f].apply2 ? -1 : 0);
}

static Status parse_name(Parser *parser) {
  const char *begin = parser->next;
  char name[16] = "";
  for (size_t i = 0; is_letter(*parser->next) || is_digit(*parser->next); i++, parser->next++)
    if (i < sizeof name - 1) name[i] = *parser->next;
  if (strcmp(name, parser->argument) == 0) return emit(parser, ARGUMENT, 0, 1);
  if (strcmp(name, "pi") == 0) return emit(parser, CONSTANT, M_PI, 1);
  for (int f = 0; f < FUNCTION_COUNT; f++)
    if (strcmp(name, functions[f].name) == 0) return parse_call(parser, f);
  return fail_name(parser, begin, name);
}

static Status parse_primary(Parser *parser) {
  char c = peek(parser);
  if (is_digit(c) || c == '.') return parse_number(parser);
  if (is_letter(c)) return parse_name(parser);
  char expected[64];
  snprintf(expected, sizeof expected, "a number, %s, a function or '('", parser->argument);
  if (!accept(parser, '(')) return fail_at(parser, parser->next, expected);
  TRY(parse_sum(parser));
  return accept(parser, ')') ? STATUS_OK : fail_at(parser, parser->next, "')' or an operator");
}

// A sign and a power: −2^−t. Every recursion comes through here, so here it is bounded.
static Status parse_power(Parser *parser) {
  if (++parser->nesting > EXPRESSION_MAX_DEPTH)
    return status_fail(STATUS_INPUT, "'%s': nested too deeply; give a table", parser->expression->text);
  bool is_negative = false;
  for (;;) {
    if (accept(parser, '-'))
      is_negative = !is_negative;
    else if (!accept(parser, '+'))
      break;
  }
  TRY(parse_primary(parser));
  if (accept(parser, '^')) {
    TRY(parse_power(parser));
    TRY(emit(parser, POWER, 0, -1));
  }
  parser->nesting--;
  return is_negative ? emit(parser, NEGATE, 0, 0) : STATUS_OK;
}

static Status parse_product(Parser *parser) {
  TRY(parse_power(parser));
  for (;;) {
    int operation = accept(parser, '*') ? MULTIPLY : accept(parser, '/') ? DIVIDE : -1;
    if (operation < 0) return STATUS_OK;
    TRY(parse_power(parser));
    TRY(emit(parser, operation, 0, -1));
  }
}

static Status parse_sum(Parser *parser) {
  TRY(parse_product(parser));
  for (;;) {
    int operation = accept(parser, '+') ? ADD : accept(parser, '-') ? SUBTRACT : -1;
    if (operation < 0) return STATUS_OK;
    TRY(parse_product(parser));
    TRY(emit(parser, operation, 0, -1));
  }
}

Status expression_parse(Expression *expression, const char *argument, const char *text) {
  *expression = (Expression){.count = 0};
  if (strlen(text) >= sizeof expression->text)
    return status_fail(STATUS_INPUT, "a formula has at most %d characters; give a table",
                       EXPRESSION_MAX_TEXT - 1);
  memcpy(expression->text, text, strlen(text) + 1);
  Parser parser = {.expression = expression, .argument = argument, .next = expression->text};
  TRY(parse_sum(&parser));
  return peek(&parser) == 0 ? STATUS_OK : fail_at(&parser, parser.next, "an operator");
}

// (aᵇ)′ = b aᵇ⁻¹ a′ + aᵇ log a b′; the second term only where the exponent moves, so that t^2 is fine at
// t ≤ 0.
static ExpressionValue raise(ExpressionValue a, ExpressionValue b) {
  double n = b.value, first = n == 0 ? 0 : n * pow(a.value, n - 1);
  double second = n == 0 || n == 1 ? 0 : n * (n - 1) * pow(a.value, n - 2);
  ExpressionValue result = chain(a, pow(a.value, n), first, second);
  if (b.rate == 0 && b.curve == 0) return result;
  double value = result.value, logarithm = log(a.value);
  result.rate += value * logarithm * b.rate;
  result.curve += value * logarithm * (b.curve + logarithm * b.rate * b.rate);
  if (a.rate != 0) result.curve += 2 * b.rate * a.rate * (pow(a.value, n - 1) + first * logarithm);
  return result;
}

static ExpressionValue multiply(ExpressionValue a, ExpressionValue b) {
  return (ExpressionValue){a.value * b.value, a.rate * b.value + a.value * b.rate,
                           a.curve * b.value + 2 * a.rate * b.rate + a.value * b.curve};
}

static ExpressionValue divide(ExpressionValue a, ExpressionValue b) {
  double value = a.value / b.value, rate = (a.rate - value * b.rate) / b.value;
  return (ExpressionValue){value, rate, (a.curve - 2 * rate * b.rate - value * b.curve) / b.value};
}

static ExpressionValue apply(int operation, ExpressionValue a, ExpressionValue b) {
  switch (operation) {
  case ADD:
    return (ExpressionValue){a.value + b.value, a.rate + b.rate, a.curve + b.curve};
  case SUBTRACT:
    return (ExpressionValue){a.value - b.value, a.rate - b.rate, a.curve - b.curve};
  case MULTIPLY:
    return multiply(a, b);
  case DIVIDE:
    return divide(a, b);
  case POWER:
    return raise(a, b);
  default:
    return functions[operation - FIRST_FUNCTION].apply2(a, b);
  }
}

static bool is_binary(int operation) {
  if (operation >= FIRST_FUNCTION) return functions[operation - FIRST_FUNCTION].apply2 != NULL;
  return operation != NEGATE;
}

bool expression_is_constant(const Expression *expression) {
  for (int i = 0; i < expression->count; i++)
    if (expression->codes[i].operation == ARGUMENT) return false;
  return true;
}

// A value on the stack, and whether it stays straight in t until the next kink.
typedef struct Piece {
  ExpressionValue now;
  bool is_straight;
} Piece;

static bool stays(Piece piece) {
  return piece.is_straight && piece.now.rate == 0;
}

static bool is_straight(int operation, Piece a, Piece b) {
  bool both = a.is_straight && b.is_straight;
  if (operation == ADD || operation == SUBTRACT) return both;
  if (operation == MULTIPLY) return both && (stays(a) || stays(b));
  if (operation == DIVIDE) return a.is_straight && stays(b);
  if (operation == POWER) return stays(a) && stays(b);
  if (operation == NEGATE) return a.is_straight;
  if (functions[operation - FIRST_FUNCTION].apply2) return both;
  if (!functions[operation - FIRST_FUNCTION].kink) return stays(a);
  bool rises = functions[operation - FIRST_FUNCTION].apply1 == do_smooth && a.now.rate != 0 &&
               (a.now.rate > 0 ? a.now.value >= 0 && a.now.value < 1 : a.now.value > 0 && a.now.value <= 1);
  return a.is_straight && !rises;
}

// What the last one or two on the stack become; `b` is not used by what takes one.
static Piece operate(int operation, Piece a, Piece b, double *next_kink) {
  const int f = operation - FIRST_FUNCTION;
  bool makes_kink = operation >= FIRST_FUNCTION && functions[f].kink && a.is_straight && b.is_straight;
  if (makes_kink) *next_kink = fmin(*next_kink, functions[f].kink(a.now, b.now));
  Piece result = {.is_straight = is_straight(operation, a, b)};
  if (operation == NEGATE)
    result.now = (ExpressionValue){-a.now.value, -a.now.rate, -a.now.curve};
  else if (is_binary(operation))
    result.now = apply(operation, a.now, b.now);
  else
    result.now = functions[f].apply1(a.now);
  return result;
}

// Value and derivatives at t; `next_kink`: how long until one that is foreseen.
static ExpressionValue run(const Expression *expression, double t, double *next_kink) {
  const Piece none = {{0, 0, 0}, true};
  Piece stack[EXPRESSION_MAX_DEPTH + 1] = {{{0, 0, 0}, true}};
  int top = -1;
  *next_kink = INFINITY;
  for (int i = 0; i < expression->count; i++) {
    const ExpressionCode *code = &expression->codes[i];
    if (code->operation == CONSTANT || code->operation == ARGUMENT) {
      bool is_argument = code->operation == ARGUMENT;
      stack[++top] = (Piece){{is_argument ? t : code->number, is_argument, 0}, true};
      continue;
    }
    bool takes_two = is_binary(code->operation);
    top -= takes_two;
    stack[top] = operate(code->operation, stack[top], takes_two ? stack[top + 1] : none, next_kink);
  }
  return stack[0].now;
}

ExpressionValue expression_eval(const Expression *expression, double t) {
  double kink;
  return run(expression, t, &kink);
}

double expression_next_kink(const Expression *expression, double t) {
  double kink;
  run(expression, t, &kink);
  return t + kink > t ? t + kink : INFINITY;
}
