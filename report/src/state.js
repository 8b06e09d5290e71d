// SPDX-License-Identifier: GPL-3.0-or-later
// What the reader has chosen. Parts of the page listen to the keys that they show.

export function createState(values) {
  const listeners = new Map();
  return {
    ...values,
    on(keys, listener) {
      for (const key of keys) listeners.set(key, [...(listeners.get(key) ?? []), listener]);
    },
    set(changes) {
      const called = new Set();
      for (const [key, value] of Object.entries(changes)) {
        if (this[key] === value) continue;
        this[key] = value;
        for (const listener of listeners.get(key) ?? []) called.add(listener);
      }
      for (const listener of called) listener();
    },
  };
}
