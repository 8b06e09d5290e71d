// SPDX-License-Identifier: Apache-2.0
// net/: small networks on the processor, for evaluation inside another program and for training. Plain C11
// with OpenMP; OpenBLAS where the processor has neither AVX2 nor AVX-512; jansson for the header of a weights
// file. No geometry.
//
// A network that was trained elsewhere:
//
//   NetModel_f32 model = {0};
//   NetCard card = {0};
//   NetWork_f32 work = {0};
//   NetWorkDef def = net_work_default();
//   NetStatus status = net_weights_read_f32("tpn.safetensors", &model, &card);
//   if (status == NET_OK) status = net_work_create_f32(model.plan, &def, &work);
//   if (status == NET_OK) net_forward_eval_f32(&work, &model, count, x, y);
//   else puts(net_status_message());
//   net_work_destroy_f32(&work), net_weights_card_destroy(&card), net_model_destroy_f32(&model);
//
// A training step: net_gradient_forward, a loss of loss.h (or one's own), net_gradient_backward,
// net_adam_clip, net_adam_step at the rate of net_schedule_rate. Everything is there for float (_f32) and
// double (_f64), is a function of its arguments only, and gives the same bits for any number of threads on
// the same processor.
#ifndef NET_NET_H
#define NET_NET_H

#include "net/dense.h"
#include "net/files/checkpoint.h"
#include "net/files/weights.h"
#include "net/kernel/kernel.h"
#include "net/model/model.h"
#include "net/model/plan.h"
#include "net/model/random.h"
#include "net/model/shape.h"
#include "net/model/whitening.h"
#include "net/pass/fold.h"
#include "net/pass/forward.h"
#include "net/pass/gradient.h"
#include "net/pass/tangent.h"
#include "net/status.h"
#include "net/training/adam.h"
#include "net/training/loss.h"
#include "net/training/plateau.h"
#include "net/training/schedule.h"
#include "net/work.h"

#endif
