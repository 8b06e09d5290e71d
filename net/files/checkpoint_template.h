// SPDX-License-Identifier: Apache-2.0
typedef struct NET_NAME(NetCheckpoint) {
  NET_NAME(NetModel) * model; // borrowed
  NET_NAME(NetAdam) * adam;   // borrowed: moments, steps taken, definition
  NET_REAL *best;             // borrowed: the best parameters so far (parameter_count)
  double best_score;          // theirs
  NetSchedule schedule;
  NetRandom random;
  NetWhitening whitening; // count 0: none. Owned where it was read.
  char *note;             // text of the caller's. Owned where it was read.
} NET_NAME(NetCheckpoint);

NetStatus NET_NAME(net_checkpoint_write)(const char *path, const NET_NAME(NetCheckpoint) * checkpoint);

// Into the model, adam and best that the checkpoint borrows, which must have the file's shape. After a
// failure they hold no meaningful state. The whitening and the note are created: net_checkpoint_release frees
// them.
NetStatus NET_NAME(net_checkpoint_read)(const char *path, NET_NAME(NetCheckpoint) * checkpoint);
void NET_NAME(net_checkpoint_release)(NET_NAME(NetCheckpoint) * checkpoint);
