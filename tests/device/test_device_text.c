// SPDX-License-Identifier: GPL-3.0-or-later
// The text of kernels in CUDA C++, where no NVRTC is: clang's front end compiles it, with the few words that
// NVRTC has by itself (cuda_words.h). It makes PTX, not machine code. Without clang this is skipped, and a
// line says so.
#include "suite.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fake/programs.h"

static const char instruction[] = "mma.sync.aligned.m16n8k16.row.col.f32.bf16.bf16.f32";

static int count_of(const char *text, const char *word) {
  int count = 0;
  for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) count++;
  return count;
}

// PTX, or an empty text where only the front end was asked; the caller's.
static char *compile(const DeviceProgram *program, const char *target, bool wants_code) {
  char folder[] = "/tmp/tetlap-text-XXXXXX", path[64], command[1000], *text;
  static char output[1 << 22];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/kernels.cu", folder);
  ck_assert_ok(device_source_text(program, DEVICE_CUDA_CPP, &text));
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  fclose(file);
  memory_free(text);
  snprintf(command, sizeof command,
           "clang -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch=%s -std=c++20 -O1 "
           "-ffp-contract=off -Wno-everything -include %s/tests/device/cuda_words.h %s %s -o - 2>&1",
           target, TETLAP_SOURCE_DIR, wants_code ? "-S" : "-fsyntax-only", path);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, sizeof output - 1, pipe)] = 0;
  const int status = pclose(pipe);
  ck_assert_msg(status == 0, "%s for %s: %.2000s", program->name, target, output);
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
  return output;
}

static bool has_clang(void) {
  if (system("clang -print-targets 2>&1 | grep -q nvptx64") == 0) return true;
  suite_skip("clang with the target nvptx64 is not installed");
  return false;
}

START_TEST(clang_takes_every_program) {
  static const char *const targets[] = {"sm_70", "sm_80"};
  for (int k = 0; k < 2 * PROGRAM_COUNT && has_clang(); k++) compile(programs[k / 2], targets[k % 2], false);
}
END_TEST

// Of V and of ∇V forwards and backwards, a bundle of four each.
START_TEST(tensor_cores_are_used_from_8_0_on) {
  if (!has_clang()) return;
  const char *code = compile(&device_program_tpn_bf16, "sm_80", true);
  ck_assert_int_eq(count_of(code, instruction), 12);
  ck_assert_int_eq(count_of(code, "cvt.rn.bf16x2.f32"), 6);
  ck_assert_int_eq(count_of(code, ".visible .entry"), 5);
  ck_assert_int_eq(count_of(compile(&device_program_tpn_bf16, "sm_70", true), "mma.sync"), 0);
  ck_assert_int_eq(count_of(compile(&device_program_tpn, "sm_80", true), "mma.sync"), 0);
}
END_TEST

// What LLVM writes for its own intrinsic of that product.
START_TEST(the_instruction_is_spelled_as_llvm_spells_it) {
  static const char ir[] =
      "declare { float, float, float, float } @llvm.nvvm.mma.m16n8k16.row.col.bf16(i32, i32, i32, i32, i32, "
      "i32, float, float, float, float)\n"
      "define float @f(i32 %a, float %c) {\n"
      "  %r = call { float, float, float, float } @llvm.nvvm.mma.m16n8k16.row.col.bf16(i32 %a, i32 %a, i32 "
      "%a, i32 %a, i32 %a, i32 %a, float %c, float %c, float %c, float %c)\n"
      "  %x = extractvalue { float, float, float, float } %r, 0\n"
      "  ret float %x\n}\n";
  char command[3000], output[4000];
  if (!has_clang() || system("which llc > /dev/null 2>&1") != 0) return;
  snprintf(command, sizeof command, "printf '%%s' '%s' | llc -march=nvptx64 -mcpu=sm_80 -mattr=+ptx70 2>&1",
           ir);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, sizeof output - 1, pipe)] = 0;
  ck_assert_msg(pclose(pipe) == 0 && count_of(output, instruction) == 1, "%s", output);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("device_text");
  tcase_add_test(cases, clang_takes_every_program);
  tcase_add_test(cases, tensor_cores_are_used_from_8_0_on);
  tcase_add_test(cases, the_instruction_is_spelled_as_llvm_spells_it);
  return suite_run("device text", cases, 300);
}
