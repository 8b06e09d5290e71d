# SPDX-License-Identifier: Apache-2.0
"""tetlap's `geo` in PyTorch: the same weights, V, its centroid and, by autograd, its gradient; a frame for a network of your own.

    tetlap run examples/02_two_blocks.yaml --overlap examples/models/geo.py:Geo

What is computed is told in overlap/geo: frame.h (the frame of a pair, P and V₀), features.h, geo.h (centroid), coplanar.h (the share of `clip`).
"""
import math
from typing import NamedTuple

import tetlap.torch
import torch

LINKS = ((1, 1), (2, 0), (1, 2), (2, 1))  # power of P, degree of d
SETS = {36: (4, 0, False), 56: (6, 0, False), 70: (4, 4, False), 100: (4, 4, True), 120: (6, 4, True)}  # features.h: powers, links, squares
REACH = {-1: 0.3, 1: 0.03}  # of coplanar faces that look the same way, and at each other
FLATTEST = 1e-5  # det of a tetrahedron by the third power of its longest edge
LEAST_SLACK = 1e-15  # a point this close to a face is on it


def slopes(tets):
    """∇λ_k (n, 4, 3) of the barycentric coordinates, and det (n)."""
    a, b, c = (tets[:, v] - tets[:, 0] for v in (1, 2, 3))
    normals = torch.stack((torch.cross(b, c, 1), torch.cross(c, a, 1), torch.cross(a, b, 1)), 1)
    det = (a * normals[:, 0]).sum(1)
    return torch.cat((-normals.sum(1, keepdim=True), normals), 1) / det[:, None, None], det


def coordinates(slope, tets, points):
    """λ_k (n, points, 4): each from a vertex of face k, where it is 0."""
    away = points[:, :, None] - tets[:, None, [1, 2, 3, 0]]
    return (away * slope[:, None]).sum(3)


def basis(m):
    """Q (n, 8, 3) and det R (n) of m = Q R, by Gram and Schmidt, each column twice."""
    columns, det = [], 1
    for c in range(3):
        column = m[..., c]
        for _ in range(2):
            for other in columns:
                column = column - (other * column).sum(1, keepdim=True) * other
        length = column.norm(dim=1)
        det = det * length
        columns.append(column / length[:, None])
    return torch.stack(columns, 2), det


def inside(across):
    """Slacks (n, 8) of a point inside of both: the mean of the ends of all clipped edges; NaN where there is none. across: (n, 2, 4, 4)."""
    total, count = torch.zeros(len(across), 8, dtype=across.dtype), torch.zeros(len(across), 1, dtype=across.dtype)
    for t in range(2):
        for v in range(1, 4):
            for w in range(v):
                p, q = across[:, t, v], across[:, t, w]
                at = p / (p - q)
                begin = torch.where((p < 0) & (q >= 0), at, torch.zeros_like(at)).amax(1, keepdim=True)
                end = torch.where((q < 0) & (p >= 0), at, torch.ones_like(at)).amin(1, keepdim=True)
                is_there = (begin <= end) & ~((p < 0) & (q < 0)).any(1, keepdim=True)
                own = torch.zeros(len(across), 4, dtype=across.dtype)
                own[:, v:v + 1], own[:, w:w + 1] = 2 - begin - end, begin + end
                other = 2 * p + (begin + end) * (q - p)
                ends = torch.cat((own, other) if t == 0 else (other, own), 1)
                total, count = total + torch.where(is_there, ends, torch.zeros_like(ends)), count + 2 * is_there
    return total / count


def centre(slope, slack):
    """Moves the slacks (n, 8) to the centre, the largest Σ log s_k, by Newton's method (overlap/geo/centre.h)."""
    done = torch.zeros(len(slack), dtype=torch.bool)
    for _ in range(40):
        q, _ = basis(slope / slack[..., None])
        along = q.sum(1)
        r, decrement = (q * along[:, None]).sum(2), along.norm(dim=1)
        longest = 0.99 / (-r).amax(1).clamp(min=1e-300)
        alpha = 1 / (1 + decrement)
        for _ in range(3):
            term = r / (1 + alpha[:, None] * r)
            alpha = torch.minimum(alpha + term.sum(1) / (term * term).sum(1), longest)
        alpha = torch.where(decrement <= 0.2, torch.ones_like(alpha), alpha)
        slack = torch.where(done[:, None], slack, slack * (1 + alpha[:, None] * r))
        done = done | (decrement < 1e-7)
        if bool(done.all()):
            break
    sums = slack.view(-1, 2, 4)
    excess = sums.sum(2, keepdim=True) - 1
    return (sums - excess / (sums * sums).sum(2, keepdim=True) * sums * sums).view(-1, 8), done


def features_of(P, count):
    """f (n, count) of P (n, 8, 8), and those of each plane (n, 8, …): overlap/geo/features/features.h has the list."""
    powers, links, has_squares = SETS[count]
    d = P.diagonal(dim1=1, dim2=2)
    row = {(n, b): (P**n * (d**b)[:, None]).sum(2) for n in range(1, powers + 1) for b in range(4)}
    link = [torch.einsum("nik,nk,njk->nij", P**power, d**degree, P**power) for power, degree in LINKS[:links]]
    f = [(d**k).sum(1) for k in range(2, 6)]
    f += [(d**a * row[n, b]).sum(1) for n in range(1, powers + 1) for a in range(int(n <= 2), 4) for b in range(a, 4)]
    planes = [d**a for a in range(1, 5)]
    planes += [d**a * row[n, b] for n in range(1, 5) for b in range(int(n <= 2), 4) for a in range(int(n == 1), 4) if a + b <= 4]
    for e, (power, _) in enumerate(LINKS[:links]):
        for a in range(1, 4):
            wedge = link[e] * P**a
            mean = (wedge * d[:, None]).sum(2)
            plain = [wedge.sum(2)] if a > 1 or power > 1 else []
            f += [sum_.sum(1) for sum_ in plain] + [mean.sum(1), (mean * d).sum(1)]
            planes += plain + ([mean] if a < 3 else [])
    f += [(link[e] * link[g] * P**a).sum((1, 2)) for e in range(links if has_squares else 0) for g in range(e + 1) for a in range(3)]
    return torch.stack(f, 1), torch.stack(planes, 2)


def share_of_clip(P):
    """w (n) of pairs with nearly coplanar faces (overlap/geo/coplanar.h)."""
    d, kept = P.diagonal(dim1=1, dim2=2), 1
    product = d[:, :4, None] * d[:, None, 4:]
    for side, reach in REACH.items():
        ratio = ((d[:, :4, None] + d[:, None, 4:] + 2 * side * P[:, :4, 4:]) / product).clamp(min=0)
        kept = kept * (1 - (1 - ratio / reach).clamp(min=0) ** 3).prod(2).prod(1)
    return 1 - kept


class Frame(NamedTuple):
    features: torch.Tensor  # (n, count)
    planes: torch.Tensor  # (n, 8, …)
    Q: torch.Tensor  # (n, 8, 3)
    volume: torch.Tensor  # V₀ (n)
    slack: torch.Tensor  # at the centre (n, 8)
    share: torch.Tensor  # of clip (n)


class Geo(torch.nn.Module):
    def __init__(self, weights="geo"):
        super().__init__()
        self.network = tetlap.torch.network(tetlap.read_weights(weights)).double()
        onset = torch.zeros(1, 8, 8, dtype=torch.float64)
        onset[0, :4, :4] = torch.eye(4) - 0.25
        self.onset = features_of(onset, self.count)[0]
        with torch.no_grad():
            self.offset = math.log(1.28) - float(self.network(self.onset)[0, 0])

    @property
    def count(self):
        return self.network.layer[0].in_features

    def describe(self, pairs, slope, slack):
        """What no weight changes of pairs whose centres have these slacks: the Frame."""
        # The numbers are those of `slack`; what they change with is one step of Newton's from there, with the planes' heights there.
        middle = (slack[:, :4, None] * pairs[:, 0]).sum(1).detach()
        heights = torch.cat([coordinates(slope[:, 4 * t:4 * t + 4], pairs[:, t], middle[:, None])[:, 0] for t in (0, 1)], 1)
        slack = slack + heights - heights.detach()
        m = slope / slack[..., None]
        step = torch.linalg.solve(m.transpose(1, 2) @ m, m.sum(1)) if slope.requires_grad else torch.zeros_like(middle)
        moved = (slope * step[:, None]).sum(2)
        slack = slack + moved - moved.detach()
        Q, det = basis(slope / slack[..., None])
        P = Q @ Q.transpose(1, 2)
        return Frame(*features_of(P, self.count), Q, 100 / 6 / det, slack, share_of_clip(P))

    def answer(self, pairs, frame):
        """V (n) and the centroid (n, 3)."""
        outputs = self.network(frame.features)
        volume = frame.volume * torch.exp(self.offset + outputs[:, 0])
        alpha = (frame.planes * outputs[:, None, 1:]).sum(2)
        change = (frame.Q * (frame.Q * alpha[..., None]).sum(1, keepdim=True)).sum(2)
        lowest = change.amin(1, keepdim=True)
        change = change * torch.where(lowest < -0.99, -0.99 / lowest, torch.ones_like(lowest))
        centroid = ((frame.slack * (1 + change))[:, :4, None] * pairs[:, 0]).sum(1)
        return self.blend(pairs, frame.share, volume, centroid)

    def blend(self, pairs, share, volume, centroid):
        at = (share > 0).nonzero()[:, 0]
        if len(at) == 0:
            return volume, centroid
        chosen = pairs[at]
        clip = tetlap.torch.overlap(chosen, "clip")
        place = torch.from_numpy(tetlap.overlap(chosen.detach().numpy(), "clip", 0, centroid=True).centroid)
        blended = volume[at] + share[at] * (clip - volume[at])
        part = share[at] * clip / blended
        moved = centroid[at] + part[:, None] * (place - centroid[at])
        return volume.index_put((at,), blended), centroid.index_put((at,), moved)

    def framed(self, pairs):
        """The pairs (m) with a common point that have a frame, it, and those (k) too flat for one."""
        (one, det), (two, det_two) = (slopes(pairs[:, t]) for t in (0, 1))
        slope = torch.cat((one, two), 1)
        with torch.no_grad():
            longest = torch.stack([(pairs[:, :, v] - pairs[:, :, w]).norm(dim=2) for v in range(4) for w in range(v)]).amax(0)
            fits = (torch.stack((det, det_two), 1).abs() > FLATTEST * longest**3).all(1)
            across = torch.stack((coordinates(two, pairs[:, 1], pairs[:, 0]), coordinates(one, pairs[:, 0], pairs[:, 1])), 1)
            slack = inside(across)
            at = (fits & (slack > LEAST_SLACK).all(1)).nonzero()[:, 0]
            slack, done = centre(slope[at], slack[at])
        return at[done], self.describe(pairs[at[done]], slope[at[done]], slack[done]), torch.cat((at[~done], (~fits).nonzero()[:, 0]))

    def forward(self, pairs):
        volume, centroid = pairs.new_zeros(len(pairs)), pairs.new_zeros(len(pairs), 3)
        at, frame, rest = self.framed(pairs)
        found, place = self.answer(pairs[at], frame)
        volume, centroid = volume.index_put((at,), found), centroid.index_put((at,), place)
        if len(rest):  # too flat
            exact = torch.from_numpy(tetlap.overlap(pairs[rest].detach().numpy(), "exact", 0, centroid=True).centroid)
            volume = volume.index_put((rest,), tetlap.torch.overlap(pairs[rest], "exact"))
            centroid = centroid.index_put((rest,), exact)
        return {"volume": volume, "centroid": centroid}
