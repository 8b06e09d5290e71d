# SPDX-License-Identifier: Apache-2.0
"""A small network that feels where a ball presses on a soft finger, and with what force, from the pressure map alone.

    python3 feel.py out/indent          trains on nine tenths of what indent.py has made, and tells its errors on the last tenth

The map is averaged over blocks of cells and gets noise of 1 % of the mean peak, as a coarse sensor would have. Two hidden layers of 64; needs PyTorch.
"""

import sys

import torch

import tetlap

BLOCK = 2  # vertices of a taxel, each way: 11 x 11 columns become 6 x 6 taxels


def read(directory):
    """Maps (n, taxels), and x, y [mm] and normal force [N] (n, 3)."""
    results = tetlap.Results(directory)
    maps = torch.tensor(results["pressure"].copy(), dtype=torch.float32)[:, None]
    taxels = torch.nn.functional.avg_pool2d(maps, BLOCK, ceil_mode=True).flatten(1)
    places = torch.tensor(results["position"].copy(), dtype=torch.float32) * 1e3
    forces = -torch.tensor(results["force"][:, 2:].copy(), dtype=torch.float32)
    return taxels, torch.cat([places, forces], dim=1)


def train(taxels, labels, epochs, batch=32):
    """A module from taxels to labels; both are scaled by what they are like in the training set."""
    mean, spread, size = labels.mean(0), labels.std(0), taxels.amax(1).mean()
    net = torch.nn.Sequential(torch.nn.Linear(taxels.shape[1], 64), torch.nn.Tanh(), torch.nn.Linear(64, 64), torch.nn.Tanh(), torch.nn.Linear(64, 3))
    noise = 0.01
    optimiser = torch.optim.Adam(net.parameters(), lr=2e-3)
    plan = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs)
    loader = torch.utils.data.DataLoader(torch.utils.data.TensorDataset(taxels / size, (labels - mean) / spread), batch, shuffle=True)
    for _ in range(epochs):
        for x, y in loader:
            optimiser.zero_grad()
            torch.nn.functional.mse_loss(net(x + noise * torch.randn_like(x)), y).backward()
            optimiser.step()
        plan.step()
    return lambda x: net(x / size + noise * torch.randn_like(x)) * spread + mean


def main(directory, epochs=200):
    """Root-mean-square errors (x [mm], y [mm], force [N]) on results that were not trained on, and the spread of these labels."""
    torch.manual_seed(1)
    taxels, labels = read(directory)
    kept = len(labels) * 9 // 10
    model = train(taxels[:kept], labels[:kept], epochs)
    with torch.no_grad():
        errors = (model(taxels[kept:]) - labels[kept:]).square().mean(0).sqrt()
    spread = labels[kept:].std(0)
    print(f"trained on {kept}, tried on {len(labels) - kept}: errors of x {errors[0]:.3f} mm, y {errors[1]:.3f} mm, force {errors[2]:.4f} N; "
          f"spread {spread[0]:.2f} mm, {spread[1]:.2f} mm, {spread[2]:.3f} N")
    return errors.tolist(), spread.tolist()


if __name__ == "__main__":
    main(*sys.argv[1:2])
