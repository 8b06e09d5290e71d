// SPDX-License-Identifier: Apache-2.0
#include "device/kernels/source.h"

#include <string.h>

#include "base/memory.h"

// The assembler takes a file's bytes as they are, and a terminating 0.
#define PIECE(name, file)                                                                                    \
  __asm__(".pushsection .rodata\n"                                                                           \
          "device_piece_" #name ":\n"                                                                        \
          ".incbin \"" TETLAP_SOURCE "/" file "\"\n"                                                         \
          ".byte 0\n"                                                                                        \
          ".popsection\n");                                                                                  \
  extern const char name[] __asm__("device_piece_" #name)

PIECE(language_opencl, "device/kernels/language_opencl.inc");
PIECE(language_cuda, "device/kernels/language_cuda.inc");
PIECE(one, "device/kernels/one.inc");
PIECE(kept, "device/kernels/clip/kept.inc");
PIECE(pairs, "device/kernels/pairs.inc");
PIECE(peak, "device/kernels/peak.inc");
PIECE(gather, "device/kernels/gather.inc");
PIECE(clip, "device/kernels/clip/clip.inc");
PIECE(pose, "device/kernels/clip/pose.inc");
PIECE(poses, "device/kernels/clip/poses.inc");
PIECE(tpn_steps, "device/kernels/tpn/steps.h");
PIECE(bf16, "device/kernels/tpn/bf16.inc");
PIECE(mma, "device/kernels/tpn/mma.inc");
PIECE(mma_cuda, "device/kernels/tpn/mma_cuda.inc");
PIECE(tpn_normalise, "device/kernels/tpn/normalise.inc");
PIECE(tpn_mma, "device/kernels/tpn/products.inc");
PIECE(tpn_network, "device/kernels/tpn/network.inc");
PIECE(tpn, "device/kernels/tpn/tpn.inc");
PIECE(clip_constants, "overlap/clip/constants.h");
PIECE(clip_lanes, "overlap/clip/lanes.inc");
PIECE(vec3, "device/kernels/vec3.inc");
PIECE(scalar, "device/kernels/clip/scalar.inc");
PIECE(polytope_types, "overlap/clip/polytope_types.h");
PIECE(polytope, "overlap/clip/polytope.inc");
PIECE(clip_sums, "overlap/clip/sums.inc");
PIECE(geo_lanes, "overlap/geo/lanes.h");
PIECE(geo_constants, "overlap/geo/constants.h");
PIECE(geo_invariants, "overlap/geo/features/invariants.h");
PIECE(geo_gate, "overlap/geo/bundle/gate_steps.inc");
PIECE(geo_frame, "overlap/geo/bundle/frame_steps.inc");
PIECE(geo_forward, "overlap/geo/features/forward.inc");
PIECE(geo_backward, "overlap/geo/features/backward.inc");
PIECE(geo_centroid, "overlap/geo/bundle/centroid_steps.inc");
PIECE(geo_coplanar_types, "overlap/geo/coplanar_types.h");
PIECE(geo_coplanar, "overlap/geo/coplanar.inc");
PIECE(geo_pack, "device/kernels/geo/pack.inc");
PIECE(geo_rows, "device/kernels/geo/rows.h");
PIECE(geo, "device/kernels/geo/features.inc");
PIECE(geo_network, "device/kernels/geo/network.inc");
PIECE(geo_answer, "device/kernels/geo/answer.inc");

const DeviceProgram device_program_clip = {
    .name = "clip",
    .defines = "#define GROUPS_AT_ONCE 6\n",
    .pieces = {clip_constants, one, kept, clip_lanes, pairs, clip},
    .kernels = {"clip_volume", "clip_gradient", "clip_centroid"},
    .items = 64,
};

const DeviceProgram device_program_clip32 = {
    .name = "clip32",
    .defines = "#define LANES_SINGLE\n#define GROUPS_AT_ONCE 8\n",
    .pieces = {clip_constants, one, kept, clip_lanes, pairs, clip},
    .kernels = {"clip_volume", "clip_gradient", "clip_centroid"},
    .items = 64,
};

const DeviceProgram device_program_gather = {
    .name = "gather",
    .defines = "#define GROUPS_AT_ONCE 1\n",
    .pieces = {one, pairs, gather},
    .kernels = {"gather_pairs", "scatter_answers"},
    .items = 64,
};

const DeviceProgram device_program_peak = {
    .name = "peak",
    .defines = "#define GROUPS_AT_ONCE 4\n",
    .pieces = {peak},
    .kernels = {"peak_float", "peak_double"},
    .items = 64,
};

const DeviceProgram device_program_poses = {
    .name = "poses",
    .defines = "#define GROUPS_AT_ONCE 6\n",
    .pieces = {clip_constants, one, kept, clip_lanes, pose, poses},
    .kernels = {"poses_clip", "poses_mend", "poses_sum"},
    .items = 64,
};

const DeviceProgram device_program_scalar = {
    .name = "scalar",
    .defines = "#define GROUPS_AT_ONCE 6\n",
    .pieces = {clip_constants, one, pairs, vec3, polytope_types, polytope, clip_sums, scalar},
    .kernels = {"scalar_volume", "scalar_gradient", "scalar_centroid"},
    .items = 64,
};

#define TPN_KERNELS                                                                                          \
  { "tpn_gate", "tpn_volume", "tpn_gradient", "tpn_answer", "tpn_pull_back" }

const DeviceProgram device_program_tpn = {
    .name = "tpn",
    .defines = "#define GROUPS_AT_ONCE 4\n",
    .pieces = {one, pairs, tpn_steps, tpn_normalise, tpn_network, tpn},
    .kernels = TPN_KERNELS,
    .items = 64,
};

const DeviceProgram device_program_tpn_bf16 = {
    .name = "tpn-bf16",
    .defines = "#define GROUPS_AT_ONCE 4\n#define TPN_BF16\n",
    .pieces = {one, pairs, tpn_steps, tpn_normalise, bf16, mma, mma_cuda, tpn_mma, tpn_network, tpn},
    .kernels = TPN_KERNELS,
    .items = 64,
};

#define GEO_PIECES                                                                                           \
  {                                                                                                          \
    geo_lanes, geo_pack, geo_constants, geo_invariants, geo_gate, geo_frame, geo_forward, geo_backward,      \
        geo_centroid, geo_coplanar_types, geo_coplanar, one, pairs, geo_rows, geo, geo_network, geo_answer   \
  }
#define GEO_KERNELS                                                                                          \
  {                                                                                                          \
    "geo_gate", "geo_frame", "geo_features", "geo_network", "geo_volume", "geo_gradient", "geo_centroid",    \
        "geo_blend", "geo_pull"                                                                              \
  }

const DeviceProgram device_program_geo_small = {
    .name = "geo-small",
    .defines = "#define GROUPS_AT_ONCE 4\n#define GEO_FEATURES 56\n",
    .pieces = GEO_PIECES,
    .kernels = GEO_KERNELS,
    .items = 64,
};

const DeviceProgram device_program_geo = {
    .name = "geo",
    .defines = "#define GROUPS_AT_ONCE 4\n#define GEO_FEATURES 120\n",
    .pieces = GEO_PIECES,
    .kernels = GEO_KERNELS,
    .items = 64,
};

Status device_source_text(const DeviceProgram *program, DeviceLanguage language, char **text) {
  const char *parts[DEVICE_MAX_PIECES + 2] = {language == DEVICE_OPENCL_C ? language_opencl : language_cuda,
                                              program->defines};
  memcpy(parts + 2, program->pieces, sizeof program->pieces);
  size_t length = 0, used = 0;
  for (int k = 0; k < DEVICE_MAX_PIECES + 2; k++) length += parts[k] ? strlen(parts[k]) : 0;
  if (!(*text = memory_zeroed(length + 1, 1))) return status_no_memory("a kernel's source");
  for (int k = 0; k < DEVICE_MAX_PIECES + 2; k++) {
    size_t size = parts[k] ? strlen(parts[k]) : 0;
    if (size > 0) memcpy(*text + used, parts[k], size);
    used += size;
  }
  return STATUS_OK;
}
