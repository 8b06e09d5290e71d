// SPDX-License-Identifier: Apache-2.0
// `first`: the coordinates of the first tetrahedron, vertex by vertex. NET_BAD_ARGUMENT: not a tpn, or one
// that is folded already. Destroy `folded` as any model; it borrows nothing.
NetStatus NET_NAME(net_fold_create)(const NET_NAME(NetModel) * model, const NET_REAL first[12],
                                    NET_NAME(NetModel) * folded);
