#!/usr/bin/python3
"""Training learned factors here and in PyTorch (Debian: python3-torch, no dependency of rodsweep), one core each.

    compare_pytorch.py build/rodsweep [--latent 16] [--segments 50]

The network, its lengths and its loss are those of `kind: train` (network/processor/factor_sweeps.hpp,
network/training/energy_loss.hpp). In PyTorch three ways, at several sizes of batch: as one would write it, the same
through torch.jit.script, and with the two passes' gradients written by hand. Systems are random chains: times do not
depend on what is in them. Prints systems per second, and the best of PyTorch beside rodsweep.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

try:
    import torch
except ImportError:
    sys.exit("compare_pytorch.py: PyTorch is not installed (Debian: apt-get install python3-torch)")

BATCHES = (16, 64, 256, 1024)
BLOCKS, PLACES = 51, 5  # features of a joint's blocks and of its place


def ramp(a):
    half = (a.clamp(-1, 1) + 1) / 2
    return half * half + (a - 1).clamp(min=0)


def with_child(x):
    """[x_k; x_k+1] of chains, roots first: [places, batch, 2 H]."""
    return torch.cat([x, torch.cat([x[1:], torch.zeros_like(x[:1])])], 2)


def passes(n, m, r):
    """y of r [places, batch, 6, 1]: tips to roots, then roots to tips."""
    places = r.shape[0]
    h = [r[places - 1]]
    for k in range(places - 1, 0, -1):
        h.append(r[k - 1] - m[k].transpose(1, 2) @ h[-1])
    y = [n[0] @ h[places - 1]]
    for k in range(1, places):
        y.append(n[k] @ h[places - 1 - k] - m[k] @ y[-1])
    return torch.stack(y)


class Passes(torch.autograd.Function):
    """The same with its gradient by hand: the adjoint of two passes is two passes and one batch of outer products."""

    @staticmethod
    def forward(context, n, m, r):
        places = r.shape[0]
        h, y = r.clone(), torch.empty_like(r)
        transposed = m.transpose(2, 3)
        for k in range(places - 1, 0, -1):
            h[k - 1].baddbmm_(transposed[k], h[k], alpha=-1)
        torch.matmul(n, h, out=y)
        for k in range(1, places):
            y[k].baddbmm_(m[k], y[k - 1], alpha=-1)
        context.save_for_backward(n, m, h, y)
        return y

    @staticmethod
    def backward(context, dy):
        n, m, h, y = context.saved_tensors
        places = dy.shape[0]
        u = dy.clone()
        transposed = m.transpose(2, 3)
        for k in range(places - 1, 0, -1):
            u[k - 1].baddbmm_(transposed[k], u[k], alpha=-1)
        dh = n.transpose(2, 3) @ u
        for k in range(1, places):
            dh[k].baddbmm_(m[k], dh[k - 1], alpha=-1)
        dm = torch.zeros_like(m)
        dm[1:] = -(u[1:] @ y[:-1].transpose(2, 3)) - h[1:] @ dh[:-1].transpose(2, 3)
        return u @ h.transpose(2, 3), dm, dh


class Factors(torch.nn.Module):
    def __init__(self, latent, solve):
        super().__init__()
        self.encode = torch.nn.Linear(BLOCKS + PLACES, latent)
        self.join = torch.nn.Linear(2 * latent, latent)
        self.join_again = torch.nn.Linear(2 * latent, latent)
        self.factors = torch.nn.Linear(latent, 42)
        torch.nn.init.normal_(self.factors.weight, std=0.01)
        torch.nn.init.zeros_(self.factors.bias)
        self.solve = solve
        entry = torch.zeros(6, 6, dtype=torch.long)
        rows, columns = np.tril_indices(6)
        for number, (row, column) in enumerate(sorted(zip(rows, columns), key=lambda at: (at[1], at[0]))):
            entry[row, column] = entry[column, row] = number
        self.register_buffer("entry", entry.reshape(-1))

    def forward(self, features, coupling, r):
        e = ramp(self.encode(features))
        f = ramp(self.join(with_child(e)))
        both = self.factors(ramp(self.join_again(with_child(f))))
        shape = (*both.shape[:2], 6, 6)
        n = both[..., :21].index_select(2, self.entry).reshape(shape) + torch.eye(6)
        t = both[..., 21:].index_select(2, self.entry).reshape(shape)
        return self.solve(n, t @ coupling, r)


def loss_of(y, diagonal, coupling, r, base_energy, solution_energy):
    """The mean of sqrt(E / x^T A x), E = E_base - (y.r)^2 / y.A y."""
    ay = diagonal @ y
    ay[1:] += coupling[1:] @ y[:-1]
    ay[:-1] += coupling[1:].transpose(2, 3) @ y[1:]
    left = base_energy - (y * r).sum((0, 2, 3)) ** 2 / (y * ay).sum((0, 2, 3))
    return (left.clamp(min=1e-12) / solution_energy).sqrt().mean()


def systems_per_second(latent, places, batch, solve, budget_s=4):
    torch.manual_seed(1)
    features = 0.3 * torch.randn(places, batch, BLOCKS + PLACES)
    coupling = 0.1 * torch.randn(places, batch, 6, 6)
    diagonal = torch.eye(6).expand(places, batch, 6, 6).contiguous()
    r = torch.randn(places, batch, 6, 1)
    energy = torch.full((batch,), 1e4)
    net = Factors(latent, solve)
    adam = torch.optim.Adam(net.parameters(), 1e-4)

    def step():
        adam.zero_grad(set_to_none=True)
        loss_of(net(features, coupling, r), diagonal, coupling, r, energy, energy).backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1)
        adam.step()

    for _ in range(3):
        step()
    times, begin = [], time.perf_counter()
    while time.perf_counter() - begin < budget_s or len(times) < 3:
        before = time.perf_counter()
        step()
        times.append(time.perf_counter() - before)
    return batch / np.median(times)


def rodsweep_systems_per_second(program, latent, segments):
    """Measured over the epochs of a short training on one thread, including validation."""
    rods = {"type": "bending_rod", "segments": segments, "length_m": 2, "initial_angle_deg": {"uniform": [0, 45]},
            "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6}
    data = {"name": "data", "kind": "dataset", "seed": 1, "samples": 24, "scene": rods,
            "time": {"step_s": 0.02, "steps": 40, "newton_iterations": 6}, "record": {"systems": "all"}}
    train = {"name": "train", "kind": "train", "seed": 1, "data": "data.h5", "validation_simulations": 1,
             "network": {"encoding": "linear_system", "processor": "factors", "base": "none", "latent": latent},
             "training": {"epochs": 8, "batch": 32, "shards": 4, "ratio_every_epochs": 0, "ratio_simulations": 1}}
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        for job in (data, train):
            path = os.path.join(folder, job["name"])
            with open(path + ".json", "w", encoding="utf-8") as file:
                json.dump(job, file)
            subprocess.run([os.path.abspath(program), "run", path + ".json", "-o", path + ".h5"], check=True,
                           env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with h5py.File(os.path.join(folder, "train.h5")) as file:
            examples = int(file["data"].attrs["training_examples"])
            return examples / np.median(file["timing/epoch_s"][1:])


def check_gradients():
    torch.manual_seed(2)
    n, m, r = (torch.randn(4, 2, 6, k, dtype=torch.double, requires_grad=True) for k in (6, 6, 1))
    for one, other in zip(*(torch.autograd.grad((way(n, m, r) ** 2).sum(), (n, m, r))
                            for way in (passes, Passes.apply))):
        if not torch.allclose(one, other):
            sys.exit("compare_pytorch.py: the gradients by hand are wrong")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program")
    arguments.add_argument("--latent", type=int, default=16)
    arguments.add_argument("--segments", type=int, default=50)
    options = arguments.parse_args()
    torch.set_num_threads(1)
    check_gradients()
    places = options.segments - 1
    ways = {"idiomatic": passes, "torch.jit.script": torch.jit.script(passes), "by hand": Passes.apply}
    print(f"PyTorch {torch.__version__}, chains of {options.segments} segments, latent {options.latent}, "
          "systems per second on one core")
    print(f"{'batch':>18}" + "".join(f"{batch:>10}" for batch in BATCHES))
    best = 0
    for name, solve in ways.items():
        speeds = [systems_per_second(options.latent, places, batch, solve) for batch in BATCHES]
        best = max(best, *speeds)
        print(f"{name:>18}" + "".join(f"{speed:>10.0f}" for speed in speeds))
    own = rodsweep_systems_per_second(options.program, options.latent, options.segments)
    print(f"{'rodsweep':>18}{own:>10.0f}   {own / best:.1f} times the best of PyTorch")


if __name__ == "__main__":
    main()
