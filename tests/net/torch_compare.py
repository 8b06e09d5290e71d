# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks of net/ rebuilt in PyTorch from their weights files, and compared.

    torch_compare.py DIRECTORY

DIRECTORY holds pairs NAME.weights.safetensors and NAME.case.safetensors, the latter with inputs x and what net/ computed:
outputs y, the derivative gx of c·y, the paper's loss of labels and targets with its parameter gradient, and the parameters
after three AdamW steps with that loss. Exit status 77: PyTorch is not installed.
"""
import pathlib
import sys

try:
    import torch
except ImportError:
    print("skipped: python3-torch cannot be imported")
    sys.exit(77)

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from torch_network import Network, paper_loss, read  # noqa: E402


def check(name, what, ours, theirs, tolerance):
    scale = theirs.abs().max().item() + 1e-30
    error = (ours - theirs).abs().max().item() / scale
    ok = error <= tolerance  # NaN fails
    print(f"{name:12} {what:24} {error:9.2e} {'' if ok else f'> {tolerance:g}: differs'}")
    return ok


def compare(directory, name):
    tensors, metadata = read(directory / f"{name}.weights.safetensors")
    case, _ = read(directory / f"{name}.case.safetensors")
    tolerance = 1e-12 if case["x"].dtype == torch.float64 else 1e-6
    # What net/ computed in float is held against the same float weights in double: its own rounding, not PyTorch's too.
    network = Network({n: tensor.double() for n, tensor in tensors.items()}, metadata)
    x = case["x"].double().requires_grad_()
    y = network(x)
    ok = check(name, "outputs", case["y"], y.detach(), tolerance)
    (gx,) = torch.autograd.grad((case["c"] * y).sum(), x)
    ok &= check(name, "input gradient", case["gx"], gx, 10 * tolerance)
    if "loss" not in case:
        return ok

    names = list(network.weights)
    optimiser = torch.optim.AdamW([network.weights[n] for n in names], lr=1e-3, weight_decay=0.01)
    for step in range(3):
        optimiser.zero_grad()
        loss = paper_loss(network(x), case["labels"], case["targets"])
        loss.backward()
        for n in names:  # what is never reached has no gradient here, and one of zeros in net/
            if network.weights[n].grad is None:
                network.weights[n].grad = torch.zeros_like(network.weights[n])
        if step == 0:
            ok &= check(name, "loss", case["loss"], loss.detach().reshape(1), tolerance)
            for n in names:
                ok &= check(name, "d " + n, case["gradient:" + n], network.weights[n].grad, 10 * tolerance)
        optimiser.step()
    for n in names:
        ok &= check(name, "AdamW " + n, case["stepped:" + n], network.weights[n].detach(), 100 * tolerance)
    return ok


def main():
    directory = pathlib.Path(sys.argv[1])
    names = sorted(path.name.split(".")[0] for path in directory.glob("*.weights.safetensors"))
    torch.set_num_threads(1)
    ok = bool(names)
    for name in names:
        ok &= compare(directory, name)
    print(f"PyTorch {torch.__version__}: {len(names)} networks {'agree' if ok else 'do NOT agree'}")
    sys.exit(0 if ok else 1)


main()
