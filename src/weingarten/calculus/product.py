"""Matrix products on the CPU through whichever of torch's two libraries is fast on every processor.

`torch.mm` calls MKL, which on other makers' processors uses half of the vector width; oneDNN, shipped in
the same wheel, does not (measured on an AVX-512 AMD core pair: 180 against 380 GFLOP/s on 1024×256×256).
"""

import torch
from jaxtyping import Float
from torch import Tensor

ONEDNN = torch.backends.mkldnn.is_available() and hasattr(torch.ops.mkldnn, "_linear_pointwise")


def product(a: Float[Tensor, "n k"], b: Float[Tensor, "k m"]) -> Float[Tensor, "n m"]:
    """a b; strided views are welcome on both sides."""
    if ONEDNN and a.dtype is torch.float32 and a.device.type == "cpu":
        return torch.ops.mkldnn._linear_pointwise(a, b.t(), None, "none", [], "")
    return a @ b


def affine(
    a: Float[Tensor, "n k"], weight: Float[Tensor, "m k"], bias: Float[Tensor, " m"]
) -> Float[Tensor, "n m"]:
    """a weightᵀ + bias."""
    if ONEDNN and a.dtype is torch.float32 and a.device.type == "cpu":
        return torch.ops.mkldnn._linear_pointwise(a, weight, bias, "none", [], "")
    return torch.addmm(bias, a, weight.t())
