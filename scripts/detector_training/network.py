"""The compact networks of engine/perception/vision/topology.cc."""
import numpy as np
import torch
from torch import nn
import torch.nn.functional as F

from .data import HEIGHT, WIDTH

# All networks have these layers; Quantized looks at frames of half the width and height, for a quarter of the cost. Quarter is
# not flown: it shows what fewer pixels cost (scripts/plot_detectors.py).
CONVOLUTIONS = [(8, 3, 2), (8, 3, 1), (16, 3, 2), (16, 3, 1), (32, 3, 2), (32, 3, 1), (48, 3, 2), (48, 3, 1),
                (64, 3, 1), (64, 3, 1), (64, 3, 2)]  # channels, kernel, stride
DENSE = [64, 1]
SHRUNK = {"full": 1, "quantized": 2, "quarter": 4}
SIZES = {kind: (WIDTH // by, HEIGHT // by) for kind, by in SHRUNK.items()}
SLOPE = 0.1
PIXEL_OFFSET, PIXEL_SCALE = 128, 1.0 / 64.0


class Detector(nn.Module):
    """11 convolutions and 2 fully connected layers with LeakyReLU; one logit. Batch normalisation while it learns."""

    def __init__(self, size: tuple[int, int]):
        super().__init__()
        self.convolutions, self.norms = nn.ModuleList(), nn.ModuleList()
        channels, (width, height) = 3, size
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
            layers.append((weight.detach().clone().contiguous(), bias.detach().clone()))
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
    pixels = torch.from_numpy(np.array(frames)).permute(0, 3, 1, 2).float()
    return (pixels - PIXEL_OFFSET) * PIXEL_SCALE


def logits_of(network: nn.Module, frames, batch: int = 128) -> np.ndarray:
    network.eval()
    with torch.no_grad():
        parts = [network(to_input(frames[i:i + batch])).numpy() for i in range(0, len(frames), batch)]
    return np.concatenate(parts) if parts else np.zeros(0, np.float32)
