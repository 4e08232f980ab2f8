"""The networks of bench/learnt_part, their training and their use. They need PyTorch, which scripts/deps does not install."""
import time

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

SIZE = 128  # of an embedding


def block(inputs, outputs, stride):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU())


class Residual(nn.Module):
    def __init__(self, channels):
        super().__init__()
        self.first = block(channels, channels, 1)
        self.second = nn.Sequential(nn.Conv2d(channels, channels, 3, 1, 1, bias=False), nn.BatchNorm2d(channels))

    def forward(self, x):
        return torch.relu(x + self.second(self.first(x)))


class Embedding(nn.Module):
    """Of an image. The place of what is seen counts: cells of 4 x 3 stay apart until the last layer."""

    of_parts = False

    def __init__(self):
        super().__init__()
        self.body = nn.Sequential(block(3, 16, 2), block(16, 32, 2), Residual(32), block(32, 64, 2), Residual(64),
                                  nn.Conv2d(64, 48, 1), nn.ReLU(), nn.AvgPool2d(2))
        self.head = nn.Linear(48 * 12, SIZE)

    def forward(self, x):
        return nn.functional.normalize(self.head(self.body(x).flatten(1)))


class OfParts(nn.Module):
    """Of parts of a signature, side by side. Each is first brought to a mean squared length of 1, over the images trained on."""

    of_parts = True

    def __init__(self, design, sizes):
        super().__init__()
        self.design, self.sizes = design, sizes
        inputs = sum(sizes)
        self.register_buffer("mean", torch.zeros(inputs))
        self.register_buffer("scale", torch.ones(inputs))
        self.body = {
            "plain": nn.Identity(),
            "whitened": nn.Linear(inputs, SIZE, bias=False),
            "linear": nn.Sequential(nn.Dropout(0.2), nn.Linear(inputs, SIZE)),
            "parts": nn.Sequential(nn.Dropout(0.2), nn.Linear(inputs, 192), nn.ReLU(), nn.Dropout(0.2), nn.Linear(192, SIZE)),
        }[design]

    def learn_scale(self, features):
        self.mean[:] = torch.from_numpy(features.mean(0))
        at = 0
        for size in self.sizes:
            part = features[:, at:at + size] - features[:, at:at + size].mean(0)
            self.scale[at:at + size] = float(1 / np.sqrt((part ** 2).sum(1).mean()))
            at += size
        if self.design == "whitened":
            x = (features - self.mean.numpy()) * self.scale.numpy() * 8
            values, vectors = np.linalg.eigh(x.T @ x / len(x))
            self.body.weight.data[:] = torch.from_numpy((vectors[:, -SIZE:] / np.sqrt(values[-SIZE:])).T.copy())

    def forward(self, x):
        x = (x - self.mean) * self.scale * 8
        if self.design == "linear":  # a convolution of one pixel: twice as fast as PyTorch's plain matrix product on a CPU
            dropout, last = self.body
            x = nn.functional.conv2d(dropout(x)[:, :, None, None], last.weight[:, :, None, None], last.bias).flatten(1)
        else:
            x = self.body(x)
        return nn.functional.normalize(x)


def network(design, sizes):
    """@param sizes of the parts that a design of parts sees; None: a design of images."""
    return Embedding() if sizes is None else OfParts(design, sizes)


def prepared(x, design):
    """What a network sees of images with values 0 to 1."""
    if design == "rgb":
        x = x - x.mean((2, 3), keepdim=True)
        return x / (x.std((1, 2, 3), keepdim=True) + 0.02)
    blue, green, red = (torch.log(x[:, i:i + 1] + 0.02) for i in range(3))
    light = (blue + green + red) / 3
    near = F.avg_pool2d(F.pad(light, (5, 5, 5, 5), mode="replicate"), 11, 1)
    contrast = torch.sqrt(F.avg_pool2d(F.pad((light - near) ** 2, (5, 5, 5, 5), mode="replicate"), 11, 1)) + 0.05
    chroma = torch.cat([red - green, blue - green], 1)
    chroma = 2 * (chroma - chroma.mean((2, 3), keepdim=True))
    return torch.cat([(light - near) / contrast, chroma], 1)


def augmented(x):
    """Another light, exposure, camera and direction of view."""
    n, _, height, width = x.shape

    def normal(*shape):
        return torch.randn(*shape)

    # A little turned, shifted and nearer; the edges repeat as in the views of learnt frames.
    turn, zoom = 0.03 * normal(n), torch.exp(0.06 * normal(n))
    matrix = torch.zeros(n, 2, 3)
    matrix[:, 0, 0] = matrix[:, 1, 1] = zoom
    matrix[:, 0, 1], matrix[:, 1, 0] = -turn, turn
    matrix[:, 0, 2], matrix[:, 1, 2] = 0.15 * normal(n), 0.04 * normal(n)
    x = F.grid_sample(x, F.affine_grid(matrix, x.shape, align_corners=False), padding_mode="border", align_corners=False)
    x = x ** torch.exp(0.25 * normal(n, 1, 1, 1))
    field = F.interpolate(0.35 * normal(n, 1, 3, 4) + 0.08 * normal(n, 3, 3, 4), size=(height, width), mode="bilinear", align_corners=False)
    warmth = 0.2 * normal(n, 1, 1, 1)
    gains = torch.cat([-warmth, torch.zeros_like(warmth), warmth], 1) + 0.08 * normal(n, 3, 1, 1)
    x = x * torch.exp(field + gains + 0.25 * normal(n, 1, 1, 1))
    soft = F.avg_pool2d(F.pad(x, (1, 1, 1, 1), mode="replicate"), 3, 1)
    x = torch.where(torch.rand(n, 1, 1, 1) < 0.3, soft, x)
    for i in range(n):  # somebody, or something that was put there
        if torch.rand(1) < 0.3:
            w, h = int(torch.randint(4, 20, (1,))), int(torch.randint(8, 36, (1,)))
            u, v = int(torch.randint(0, width - w, (1,))), int(torch.randint(0, height - h, (1,)))
            x[i, :, v:v + h, u:u + w] = torch.rand(3, 1, 1)
    return (x + 0.02 * torch.rand(n, 1, 1, 1) * normal(*x.shape)).clamp(0, 1)


def contrastive_loss(z, same, unsure, temperature=0.1):
    n = len(z)
    itself = torch.eye(n, dtype=torch.bool)
    same, unsure = torch.from_numpy(same) & ~itself, torch.from_numpy(unsure)
    logits = (z @ z.T / temperature).masked_fill(itself | unsure, -1e4)
    logp = logits - torch.logsumexp(logits, 1, keepdim=True)
    return -((logp * same).sum(1) / same.sum(1).clamp(min=1))[same.any(1)].mean()


def descend(net, design, steps, batches, inputs):
    rate = 2e-3
    optimizer = torch.optim.AdamW(net.parameters(), lr=rate, weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps)
    mean = 0.0
    for step in range(steps):
        parts, same, unsure = batches.next()
        x = torch.from_numpy(np.concatenate([inputs[id(e)][ids] for e, ids in parts]))
        if not net.of_parts:
            x = prepared(augmented(x.permute(0, 3, 1, 2).float() / 255), design)
        z = net(x)
        loss = contrastive_loss(z, same, unsure)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
        mean += (loss.item() - mean) / min(step + 1, 50)
        if step % 50 == 49:
            print(f"step {step + 1}: loss {mean:.3f}, {time.process_time():.0f} s of CPU", flush=True)


def embedded(net, design, pixels):
    with torch.no_grad():
        if net.of_parts:
            return net(torch.from_numpy(pixels)).numpy()
        return np.concatenate([net(prepared(torch.from_numpy(pixels[i:i + 256]).permute(0, 3, 1, 2).float() / 255, design)).numpy()
                               for i in range(0, len(pixels), 256)])
