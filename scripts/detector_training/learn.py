"""Training of one network, epoch by epoch; what is done so far is kept, so that it can go on after a stop."""
import math
import pathlib
import time

import numpy as np
import torch
import torch.nn.functional as F

from .network import Detector, PIXEL_OFFSET, PIXEL_SCALE, SIZES, logits_of, to_input


def augment(x: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Mirrored left to right (a fire has no handedness) and with another exposure and white balance."""
    n = len(x)
    mirrored = torch.rand(n, generator=generator) < 0.5
    x = torch.where(mirrored[:, None, None, None], x.flip(3), x)
    exposure = 1.0 + 0.15 * torch.randn(n, 1, 1, 1, generator=generator)
    balance = 1.0 + 0.05 * torch.randn(n, 3, 1, 1, generator=generator)
    black = -PIXEL_OFFSET * PIXEL_SCALE
    return torch.clamp((x - black) * exposure * balance + black, black, (255 - PIXEL_OFFSET) * PIXEL_SCALE)


class Training:
    """Adam, one cycle of the learning rate, binary cross-entropy on the usable frames.

    Products in bfloat16, sums and weights in single precision: half the time. The network of the epoch with the smallest
    loss on `check` wins.
    """

    def __init__(self, kind: str, data, check, options, settings: str, checkpoint: pathlib.Path):
        self.data, self.check, self.options, self.settings, self.checkpoint = data, check, options, settings, checkpoint
        torch.manual_seed(options.seed)
        self.generator = torch.Generator().manual_seed(options.seed)
        self.network = Detector(SIZES[kind]).to(memory_format=torch.channels_last)
        self.index = np.flatnonzero(data.usable)
        self.labels = torch.from_numpy(data.positive.astype(np.float32))
        self.batches = max(1, int(options.share * len(self.index)) // options.batch)
        self.optimizer = torch.optim.AdamW(self.network.parameters(), lr=options.learning_rate, weight_decay=1e-3)
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(self.optimizer, options.learning_rate,
                                                            total_steps=self.batches * options.epochs, pct_start=0.15)
        self.best, self.best_state, self.rows = math.inf, None, []
        if checkpoint.is_file():
            self._go_on()

    def _go_on(self) -> None:
        kept = torch.load(self.checkpoint)
        if kept["settings"] != self.settings:
            print(f"{self.checkpoint}: of another training; starting from nothing", flush=True)
            return
        self.network.load_state_dict(kept["network"])
        self.optimizer.load_state_dict(kept["optimizer"])
        self.schedule.load_state_dict(kept["schedule"])
        self.best, self.best_state, self.rows = kept["best"], kept["best_state"], kept["rows"]
        self.generator.set_state(kept["generator"])
        torch.set_rng_state(kept["random"])
        print(f"{self.checkpoint}: going on after epoch {len(self.rows)}", flush=True)

    def _keep(self) -> None:
        new = self.checkpoint.with_suffix(".new")
        torch.save({"settings": self.settings, "network": self.network.state_dict(),
                    "optimizer": self.optimizer.state_dict(), "schedule": self.schedule.state_dict(), "best": self.best,
                    "best_state": self.best_state, "rows": self.rows, "generator": self.generator.get_state(),
                    "random": torch.get_rng_state()}, new)
        new.replace(self.checkpoint)

    def _step(self, chosen: np.ndarray) -> float:
        x = augment(to_input(self.data.frames[chosen]), self.generator).contiguous(memory_format=torch.channels_last)
        with torch.cpu.amp.autocast(dtype=torch.bfloat16):
            logits = self.network(x)
        loss = F.binary_cross_entropy_with_logits(logits.float(), self.labels[chosen])
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        self.schedule.step()
        return loss.item()

    def _epoch(self) -> dict:
        self.network.train()
        batch = self.options.batch
        order = self.index[torch.randperm(len(self.index), generator=self.generator).numpy()]
        total = sum(self._step(np.sort(order[i * batch:(i + 1) * batch])) for i in range(self.batches))
        found = logits_of(self.network, self.check.frames)
        return {"epoch": len(self.rows) + 1, "train_loss": total / self.batches,
                "check_loss": cross_entropy(found, self.check.positive),
                "check_accuracy": float(np.mean((found > 0) == self.check.positive)),
                "learning_rate": self.schedule.get_last_lr()[0]}

    def run(self, say):
        """(network, log rows)."""
        while len(self.rows) < self.options.epochs:
            start = time.perf_counter()
            row = self._epoch()
            self.rows.append(row)
            if row["check_loss"] < self.best:
                self.best = row["check_loss"]
                self.best_state = {k: v.clone() for k, v in self.network.state_dict().items()}
            self._keep()
            say(f"epoch {row['epoch']:3d}/{self.options.epochs}  train {row['train_loss']:.4f}  check "
                f"{row['check_loss']:.4f}  accuracy {row['check_accuracy']:.4f}  {time.perf_counter() - start:.0f} s")
        self.network.load_state_dict(self.best_state)
        self.network.eval()
        return self.network, self.rows


def cross_entropy(logits: np.ndarray, positive: np.ndarray) -> float:
    signed = np.where(positive, logits, -logits).astype(np.float64)
    return float(np.mean(np.logaddexp(0.0, -signed)))
