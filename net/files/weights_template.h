// SPDX-License-Identifier: Apache-2.0
// The file appears whole. NET_BAD_ARGUMENT where a parameter is not finite.
NetStatus NET_NAME(net_weights_write)(const char *path, const NET_NAME(NetModel) * model,
                                      const NetCard *card);

// Creates model and card, both to be destroyed. NET_BAD_FILE names what is wrong: no safetensors file,
// truncated, tensors that overlap, a wrong dtype or shape, a tensor missing or unknown, a number that is not
// finite, metadata missing.
NetStatus NET_NAME(net_weights_read)(const char *path, NET_NAME(NetModel) * model, NetCard *card);
