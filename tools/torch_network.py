# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks of net/ rebuilt in PyTorch from their weights files. Safetensors are parsed by hand, by the format's own
description, so that the writer is checked too. Whoever imports this has seen to it that PyTorch is there."""
import json
import struct

import torch

DTYPES = {"F32": torch.float32, "F64": torch.float64}


def read(path):
    """Tensors by name, and the metadata."""
    data = path.read_bytes()
    (length,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + length])
    metadata = header.pop("__metadata__")
    tensors = {}
    for name, entry in header.items():
        begin, end = entry["data_offsets"]
        numbers = bytearray(data[8 + length + begin : 8 + length + end])
        tensors[name] = torch.frombuffer(numbers, dtype=DTYPES[entry["dtype"]]).reshape(entry["shape"]).clone()
    return tensors, metadata


class Network:
    """The shape's text says all; weights are looked up by name."""

    def __init__(self, tensors, metadata):
        self.shape = json.loads(metadata["shape"])
        self.weights = {name: tensor.requires_grad_() for name, tensor in tensors.items()}
        self.activate = {"relu": torch.relu, "silu": torch.nn.functional.silu}[self.shape["activation"]]

    def input_count(self):
        if self.shape["kind"] == "tpn":
            return 12 if self.shape.get("one_tetrahedron", False) else 24
        return self.weights["layer.0.weight"].shape[1]

    def linear(self, name, x):
        return torch.nn.functional.linear(x, self.weights[name + ".weight"], self.weights.get(name + ".bias"))

    def layers(self, block, x, widths):
        for k in range(len(widths)):
            x = self.linear(f"{block}.{k}", x)
            if not self.ends_linearly(block) or k < len(widths) - 1:
                x = self.activate(x)
        return x

    def ends_linearly(self, block):
        return self.shape.get("linear_ends", False) and block in ("vertex", "tetrahedron", "combiner")

    def own(self, block, raw):
        """A map for each vertex (or tetrahedron) of the pair; with one tetrahedron the others are idle."""
        members = raw.reshape(len(raw), -1, raw.shape[-1])
        maps = [self.linear(f"{block}_skip.{m}", members[:, m]) for m in range(members.shape[1])]
        return torch.stack(maps, dim=1).reshape(*raw.shape[:-1], -1)

    def skip(self, block, x, raw):
        kind = self.shape[block + "_skip"]
        if kind == "own":
            return x + self.own(block, raw)
        if kind == "none":
            return x
        if kind == "per_index":  # one matrix for each of the four vertices, which are the last dimension but one
            return x + torch.stack([self.linear(f"{block}_skip.{a}", raw[..., a, :]) for a in range(4)], dim=-2)
        return x + self.linear(block + "_skip", raw)

    def pool(self, x):
        return x.max(dim=-2).values if self.shape["pool"] == "max" else x.sum(dim=-2)

    def head(self, block, x):
        widths = self.shape[block]
        return self.linear(f"{block}.{len(widths)}", self.layers(block, x, widths))

    def __call__(self, x):
        shape = self.shape
        if shape["kind"] == "mlp":
            return self.linear(f"layer.{len(shape['hidden'])}", self.layers("layer", x, shape["hidden"]))
        count = 1 if shape.get("one_tetrahedron", False) else 2
        xyz = x.reshape(-1, count, 4, 3)
        h = self.skip("vertex", self.layers("vertex", xyz, shape["vertex"]), xyz)
        if shape["coordinates"]:
            h = torch.cat([h, xyz], dim=-1)
        h = self.layers("tetrahedron", self.pool(h), shape["tetrahedron"])
        h = self.skip("tetrahedron", h, x.reshape(-1, count, 12))
        h = self.skip("combiner", self.layers("combiner", self.pool(h), shape["combiner"]), x)
        h = self.layers("backbone", h, shape["backbone"])
        return torch.cat([self.head("status_head", h), self.head("volume_head", h)], dim=-1)


def paper_loss(y, labels, targets):
    cross_entropy = torch.nn.functional.binary_cross_entropy_with_logits(y[:, 0], labels)
    difference = torch.log1p(torch.relu(y[:, 1])) - torch.log1p(targets)
    return 0.5 * cross_entropy + 0.5 * torch.sqrt(torch.mean(difference**2))
