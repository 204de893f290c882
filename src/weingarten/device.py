"""Where a fit runs."""

import torch

from weingarten.errors import DeviceError, OptionError

DEVICES = ("auto", "cpu", "cuda", "mps")


def chosen_device(name: str) -> torch.device:
    """The device of that name; `auto` takes CUDA if there is one, else the CPU.

    Raises DeviceError when this machine has no such device.
    """
    if name not in DEVICES:
        raise OptionError(f"There is no device {name!r}; choose one of {', '.join(DEVICES)}.")
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    available = {"cpu": True, "cuda": torch.cuda.is_available(), "mps": torch.backends.mps.is_available()}
    if not available[name]:
        raise DeviceError(
            f"--device {name} was asked for, but torch sees no such device here; use --device auto."
        )
    return torch.device(name)
