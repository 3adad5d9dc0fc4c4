"""Lessons in a device's memory, for a device that learns faster than they are made: all stay there, and batches are drawn from there."""
import torch


class Ring:
    """size: how many are kept; parts: of each lesson's tensors the shape and the type."""

    def __init__(self, size, device, parts):
        self.size, self.device, self.made = size, device, 0
        self.kept = [torch.empty((size, *shape), dtype=dtype, device=device) for shape, dtype in parts]

    def add(self, *batch):
        at = torch.arange(self.made, self.made + len(batch[0]), device=self.device) % self.size
        for kept, new in zip(self.kept, batch):
            kept[at] = new.to(self.device)
        self.made += len(at)

    def draw(self, count):
        picked = torch.randint(0, min(self.made, self.size), (count,), device=self.device)
        return [kept[picked] for kept in self.kept]
