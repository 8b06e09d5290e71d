// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"
#include "lab/program.h"

int main(int argument_count, char **arguments) {
  return app_program_main(&lab_program_root, argument_count, arguments);
}
