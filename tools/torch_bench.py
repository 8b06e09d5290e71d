# SPDX-License-Identifier: GPL-3.0-or-later
"""PyTorch as a peer of `tetlap-lab net` and `tetlap-lab device`: the same weights, the same inputs, timed in turns.

    torch_bench.py WEIGHTS PRECISION INPUTS THREADS [DEVICE]

WEIGHTS is a weights file of net/, PRECISION `float`, `double` or `bf16`, INPUTS raw numbers of it (of `bf16` floats), a sample after another,
DEVICE PyTorch's name of one (default: cpu). The first line that it writes is PyTorch's version. Each line read is then `WHAT BATCH CALLS`; WHAT is `V` (outputs) or `V+grad` (and the
last output's derivative by the inputs); the answer is `WALL CPU CHECK`:
seconds of all calls, and the mean of the absolute outputs (`V+grad`: of the derivatives). Exit status
77: PyTorch is not installed; 78: it finds no such device.
"""
import pathlib
import sys
import time

try:
    import torch
except ImportError:
    print("python3-torch cannot be imported", file=sys.stderr)
    sys.exit(77)

sys.dont_write_bytecode = True
from torch_network import Network, read  # noqa: E402


def main():
    weights, precision, inputs, threads = sys.argv[1:5]
    device = sys.argv[5] if len(sys.argv) > 5 else "cpu"
    dtype = {"float": torch.float32, "double": torch.float64, "bf16": torch.bfloat16}[precision]
    if device == "cuda" and not torch.cuda.is_available():
        sys.exit(78)
    torch.set_num_threads(int(threads))
    tensors, metadata = read(pathlib.Path(weights))
    network = Network({name: tensor.to(dtype).to(device) for name, tensor in tensors.items()}, metadata)
    columns = network.input_count()
    numbers = bytearray(pathlib.Path(inputs).read_bytes())
    given = torch.frombuffer(numbers, dtype=torch.float32 if precision == "bf16" else dtype)
    samples = given.reshape(-1, columns).to(dtype).to(device)

    def outputs(x):
        with torch.inference_mode():
            return network(x)

    def gradient(x):
        x = x.detach().requires_grad_()
        (gx,) = torch.autograd.grad(network(x)[:, -1].sum(), x)
        return gx

    acts = {"V": outputs, "V+grad": gradient}
    print(torch.__version__, flush=True)
    for line in sys.stdin:
        what, batch, calls = line.split()
        x = samples[: int(batch)]
        wall, cpu = time.perf_counter(), time.process_time()
        for _ in range(int(calls)):
            result = acts[what](x)
        if device == "cuda":  # which returns before it has computed
            torch.cuda.synchronize()
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        print(f"{wall:.9g} {cpu:.9g} {result.abs().double().mean().item():.9g}", flush=True)


main()
