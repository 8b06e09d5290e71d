/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two pads close on a soft cube until both press with 4 N, hold it, and lift it, as in examples/python/grip.py.
 *   cc grip.c -o grip $(pkg-config --cflags --libs tetlap-run)
 *   ./grip ../python/gripper.yaml */
#include <stdio.h>
#include <stdlib.h>
#include <tetlap/run.h>

static const double SPEED = 0.01, GRIP = 4; /* of a pad [m/s]; of each, when it is enough [N] */

static void check(int code) {
  if (code) fprintf(stderr, "%s\n", tetlap_run_message());
  if (code) exit(code);
}

/* On the cube, by a pad. */
static TetlapRunContact by(const TetlapRun *run, const char *pad) {
  TetlapRunContact contact = TETLAP_RUN_CONTACT_INIT;
  check(tetlap_run_contact(run, "cube", pad, &contact));
  return contact;
}

/* After every step: whether the pads, which are closing, press enough. */
static int is_held(void *closing, TetlapRun *run) {
  return *(int *)closing && by(run, "left").force[0] > GRIP && by(run, "right").force[0] < -GRIP;
}

static void move(TetlapRun *run, double closed, double lifted, double seconds) {
  const double left[3] = {closed, 0, lifted}, right[3] = {-closed, 0, lifted};
  check(tetlap_run_drive(run, "left", left, seconds));
  check(tetlap_run_drive(run, "right", right, seconds));
}

int main(int argc, char **argv) {
  int closing = 1;
  double height = 0, closed;
  TetlapRun *run;
  TetlapRunBody cube = TETLAP_RUN_BODY_INIT;
  TetlapRunOptions options = TETLAP_RUN_OPTIONS_INIT;
  options.on_step = is_held, options.user = &closing;
  check(tetlap_run_open(&run, argc > 1 ? argv[1] : "gripper.yaml", &options));
  move(run, SPEED * 0.5, 0, 0.5);
  check(tetlap_run_advance(run, 0.5));
  closing = 0;
  closed = SPEED * tetlap_run_time(run);
  move(run, closed, 0, 0.05); /* hold */
  check(tetlap_run_advance(run, tetlap_run_time(run) + 0.05));
  move(run, closed, 0.05, 0.5);
  check(tetlap_run_advance(run, tetlap_run_time(run) + 0.7));
  check(tetlap_run_body(run, 0, &cube));
  for (int v = cube.vertex_begin; v < cube.vertex_end; v++)
    height += tetlap_run_points(run)[3 * v + 2] / (cube.vertex_end - cube.vertex_begin);
  printf("height %.4f\ncarries %.4f\n", height, by(run, "left").force[2] + by(run, "right").force[2]);
  tetlap_run_close(run);
  return 0;
}
