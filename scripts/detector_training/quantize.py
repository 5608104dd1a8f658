"""Post-training quantisation, and the integer network as engine/perception/vision/network.h says it, bit for bit."""
import numpy as np
import torch
import torch.nn.functional as F

from .network import CONVOLUTIONS, PIXEL_OFFSET, PIXEL_SCALE, SLOPE, to_input

ACTIVATION_MAX = 127
PIXEL_MAX = 255


def weight_limit(input_max: int) -> int:
    """Two neighbouring products fit 16 bits (engine/perception/vision/detector_model.h)."""
    return min(127, 32767 // (2 * input_max))


def scales_of(network, frames: np.ndarray) -> list[dict]:
    """Per layer: input scale and zero point from the activations that `frames` cause, weight scale from the weights."""
    low, high = {}, {}
    with torch.no_grad():
        for i in range(0, len(frames), 128):
            for layer, x in enumerate(network.activations(to_input(frames[i:i + 128]))[:-1]):
                # One value in 10,000 may be cut off: outliers would cost all others their resolution.
                values = np.sort(x.flatten().numpy())
                cut = len(values) // 10000
                low.setdefault(layer, []).append(values[cut])
                high.setdefault(layer, []).append(values[-1 - cut])
    scales = []
    for layer, (weight, _) in enumerate(network.layers):
        if layer == 0:
            scale, zero, largest = np.float32(PIXEL_SCALE), PIXEL_OFFSET, PIXEL_MAX
        else:
            bottom, top = min(0.0, float(np.mean(low[layer]))), max(1e-6, float(np.mean(high[layer])))
            scale, largest = np.float32((top - bottom) / ACTIVATION_MAX), ACTIVATION_MAX
            zero = int(np.rint(-bottom / float(scale)))
        limit = weight_limit(largest)
        scales.append({"input_scale": scale, "input_zero_point": zero, "input_max": largest,
                       "weight_scale": np.float32(float(weight.abs().max()) / limit)})
    return scales


def integer_logits(network, scales: list[dict], frames: np.ndarray, batch: int = 128) -> np.ndarray:
    """Sums in floats that hold these integers exactly; the rest in single precision, operation by operation."""
    parts = []
    for i in range(0, len(frames), batch):
        x = torch.from_numpy(np.array(frames[i:i + batch])).permute(0, 3, 1, 2).float()
        for layer, (weight, bias) in enumerate(network.layers):
            q = scales[layer]
            limit = weight_limit(q["input_max"])
            integers = np.clip(np.rint(weight.numpy() / q["weight_scale"]), -limit, limit)
            # No sum can reach 2^24, or it is one of doubles.
            exact = limit * q["input_max"] * weight[0].numel() < 2**24
            w = torch.from_numpy(integers.astype(np.float32 if exact else np.float64))
            x = x.to(w.dtype) - q["input_zero_point"]  # so that padding with zeros is padding with the zero point
            if layer < len(CONVOLUTIONS):
                _, kernel, stride = CONVOLUTIONS[layer]
                sums = F.conv2d(x, w, None, stride, kernel // 2).numpy()
                b = bias.numpy()[None, :, None, None]
            else:
                sums, b = F.linear(x.flatten(1), w).numpy(), bias.numpy()[None, :]
            y = sums.astype(np.float32) * (q["input_scale"] * q["weight_scale"]) + b
            if layer + 1 == len(network.layers):
                parts.append(y[:, 0])
                break
            n = scales[layer + 1]
            y = np.maximum(y, y * np.float32(SLOPE)) * (np.float32(1.0) / n["input_scale"])
            y = np.clip(y, -n["input_zero_point"], n["input_max"] - n["input_zero_point"])
            x = torch.from_numpy(np.rint(y).astype(np.float32)) + n["input_zero_point"]
    return np.concatenate(parts) if parts else np.zeros(0, np.float32)
