"""Matrix products, on the CPU through whichever of torch's two libraries is fast on every processor.

`torch.mm` calls MKL, which on other makers' processors uses half of the vector width; oneDNN, shipped in
the same wheel, does not (measured on one AVX-512 AMD core: 95 against 200 GFLOP/s on 256×256×512).
"""

import torch
from jaxtyping import Float
from torch import Tensor

ONEDNN = torch.backends.mkldnn.is_available() and hasattr(torch.ops.mkldnn, "_linear_pointwise")


def product(a: Float[Tensor, "*batch n k"], b: Float[Tensor, "*batch k m"]) -> Float[Tensor, "*batch n m"]:
    """a b. Either may be the transpose of a whole tensor; of a part of its columns it is far slower."""
    if ONEDNN and a.dim() == 2 and a.dtype is torch.float32 and a.device.type == "cpu":
        return torch.ops.mkldnn._linear_pointwise(a, b.t(), None, "none", [], "")
    return a @ b
