"""The compact network of engine/perception/vision/topology.cc, and its training."""
import math
import time

import numpy as np
import torch
from torch import nn
import torch.nn.functional as F

CONVOLUTIONS = [(8, 3, 2), (8, 3, 1), (16, 3, 2), (16, 3, 1), (32, 3, 2), (32, 3, 1), (32, 3, 2), (32, 3, 1),
                (48, 3, 1), (48, 3, 1), (64, 3, 2)]  # channels, kernel, stride
DENSE = [64, 1]
SLOPE = 0.1
WIDTH, HEIGHT = 96, 54
PIXEL_OFFSET, PIXEL_SCALE = 128, 1.0 / 64.0


class Detector(nn.Module):
    """11 convolutions and 2 fully connected layers with LeakyReLU; one logit. Batch normalisation while it learns."""

    def __init__(self):
        super().__init__()
        self.convolutions, self.norms = nn.ModuleList(), nn.ModuleList()
        channels, height, width = 3, HEIGHT, WIDTH
        for out, kernel, stride in CONVOLUTIONS:
            self.convolutions.append(nn.Conv2d(channels, out, kernel, stride, kernel // 2))
            self.norms.append(nn.BatchNorm2d(out))
            channels, height, width = out, (height - 1) // stride + 1, (width - 1) // stride + 1
        inputs = channels * height * width
        self.dropout = nn.Dropout(0.2)
        self.dense = nn.ModuleList()
        for out in DENSE:
            self.dense.append(nn.Linear(inputs, out))
            inputs = out

    def forward(self, x):
        for convolution, norm in zip(self.convolutions, self.norms):
            x = F.leaky_relu(norm(convolution(x)), SLOPE)
        x = self.dropout(x.flatten(1))
        x = self.dropout(F.leaky_relu(self.dense[0](x), SLOPE))
        return self.dense[1](x)[:, 0]

    def folded(self) -> "FoldedDetector":
        """The same function with batch normalisation worked into the convolutions: what is exported."""
        layers = []
        for convolution, norm in zip(self.convolutions, self.norms):
            gain = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            weight = convolution.weight * gain[:, None, None, None]
            bias = (convolution.bias - norm.running_mean) * gain + norm.bias
            layers.append((weight.detach().clone(), bias.detach().clone()))
        layers += [(layer.weight.detach().clone(), layer.bias.detach().clone()) for layer in self.dense]
        return FoldedDetector(layers)


class FoldedDetector(nn.Module):
    """Plain convolutions and matrices, as the engine runs them. `layers`: (weight, bias) of each."""

    def __init__(self, layers):
        super().__init__()
        self.layers = layers
        for i, (weight, bias) in enumerate(layers):
            self.register_buffer(f"weight{i}", weight)
            self.register_buffer(f"bias{i}", bias)

    def forward(self, x):
        return self.activations(x)[-1][:, 0]

    def activations(self, x):
        """The input of every layer, then the output."""
        found = [x]
        for i, (weight, bias) in enumerate(self.layers):
            if i < len(CONVOLUTIONS):
                _, kernel, stride = CONVOLUTIONS[i]
                x = F.conv2d(x, weight, bias, stride, kernel // 2)
            else:
                x = F.linear(x.flatten(1), weight, bias)
            if i + 1 < len(self.layers):
                x = F.leaky_relu(x, SLOPE)
            found.append(x)
        return found


def to_input(frames: np.ndarray) -> torch.Tensor:
    pixels = torch.from_numpy(np.ascontiguousarray(frames)).permute(0, 3, 1, 2).float()
    return (pixels - PIXEL_OFFSET) * PIXEL_SCALE


def logits_of(network: nn.Module, frames: np.ndarray, batch: int = 256) -> np.ndarray:
    network.eval()
    with torch.no_grad():
        parts = [network(to_input(frames[i:i + batch])).numpy() for i in range(0, len(frames), batch)]
    return np.concatenate(parts) if parts else np.zeros(0, np.float32)


def augment(x: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Mirrored left to right (a fire has no handedness) and with another exposure and white balance."""
    n = len(x)
    mirrored = torch.rand(n, generator=generator) < 0.5
    x = torch.where(mirrored[:, None, None, None], x.flip(3), x)
    exposure = 1.0 + 0.15 * torch.randn(n, 1, 1, 1, generator=generator)
    balance = 1.0 + 0.05 * torch.randn(n, 3, 1, 1, generator=generator)
    black = -PIXEL_OFFSET * PIXEL_SCALE
    return torch.clamp((x - black) * exposure * balance + black, black, (255 - PIXEL_OFFSET) * PIXEL_SCALE)


def train(data, check, epochs: int, seed: int, learning_rate: float, batch: int, say):
    """Adam, cosine schedule, binary cross-entropy on the usable frames. Returns (network, log rows).

    The network of the epoch with the smallest loss on `check` wins.
    """
    torch.manual_seed(seed)
    generator = torch.Generator().manual_seed(seed)
    network = Detector()
    optimizer = torch.optim.AdamW(network.parameters(), lr=learning_rate, weight_decay=1e-3)
    index = np.flatnonzero(data.usable)
    labels = torch.from_numpy(data.positive.astype(np.float32))
    steps = max(1, len(index) // batch) * epochs
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, learning_rate, total_steps=steps, pct_start=0.15)
    best, best_state, rows = math.inf, None, []
    for epoch in range(1, epochs + 1):
        start = time.perf_counter()
        network.train()
        order = index[torch.randperm(len(index), generator=generator).numpy()]
        total = 0.0
        for i in range(max(1, len(index) // batch)):
            chosen = np.sort(order[i * batch:(i + 1) * batch])
            x = augment(to_input(data.frames[chosen]), generator)
            loss = F.binary_cross_entropy_with_logits(network(x), labels[chosen])
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += loss.item()
        found = logits_of(network, check.frames)
        loss = cross_entropy(found, check.positive)
        row = {"epoch": epoch, "train_loss": total / max(1, len(index) // batch), "check_loss": loss,
               "check_accuracy": float(np.mean((found > 0) == check.positive)),
               "learning_rate": schedule.get_last_lr()[0]}
        rows.append(row)
        say(f"epoch {epoch:3d}/{epochs}  train {row['train_loss']:.4f}  check {loss:.4f}  "
            f"accuracy {row['check_accuracy']:.4f}  {time.perf_counter() - start:.0f} s")
        if loss < best:
            best, best_state = loss, {k: v.clone() for k, v in network.state_dict().items()}
    network.load_state_dict(best_state)
    network.eval()
    return network, rows


def cross_entropy(logits: np.ndarray, positive: np.ndarray) -> float:
    signed = np.where(positive, logits, -logits).astype(np.float64)
    return float(np.mean(np.logaddexp(0.0, -signed)))
