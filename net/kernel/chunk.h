// SPDX-License-Identifier: Apache-2.0
// How a batch is divided: a chunk goes through all layers while it is in the cache. Private to net/.
#ifndef NET_CHUNK_H
#define NET_CHUNK_H

// Samples · (1 + tangents) of a chunk; 7 cache lines of floats: strides avoid powers of two.
enum { NET_CHUNK_COLUMNS = 112 };

// Samples of a chunk and chunks of `count` samples, for a number of tangents.
int net_chunk_size(int tangents);
int net_chunk_count(int count, int tangents);

#endif
