"""Matrix products on the CPU through whichever of torch's two libraries is fast on every processor.

`torch.mm` calls MKL, which on other makers' processors uses half of the vector width; oneDNN, shipped in
the same wheel, does not (measured on one AVX-512 AMD core: 95 against 200 GFLOP/s on 256×256×512).
"""

import torch
from jaxtyping import Float
from torch import Tensor

ONEDNN = torch.backends.mkldnn.is_available() and hasattr(torch.ops.mkldnn, "_linear_pointwise")


def product(a: Float[Tensor, "n k"], b: Float[Tensor, "k m"]) -> Float[Tensor, "n m"]:
    """a b. Either may be the transpose of a whole tensor; of a part of its columns it is far slower."""
    if ONEDNN and a.dtype is torch.float32 and a.device.type == "cpu":
        return torch.ops.mkldnn._linear_pointwise(a, b.t(), None, "none", [], "")
    return a @ b
