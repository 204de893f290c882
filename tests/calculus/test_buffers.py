"""Memory comes back in any shape that fits, and growing batches do not pile it up."""

import torch

from weingarten.calculus.buffers import Buffers, capacity


def test_a_tensor_has_the_shape_type_and_device_that_is_asked_for():
    like = torch.zeros(1, dtype=torch.float64)
    taken = Buffers().take(like, 3, 5)
    assert (taken.shape, taken.dtype, taken.device) == ((3, 5), like.dtype, like.device)
    assert taken.is_contiguous()


def test_what_is_given_back_is_handed_out_again():
    buffers, like = Buffers(), torch.zeros(1)
    first = buffers.take(like, 4, 16)
    address = first.data_ptr()
    buffers.give_back(first)
    again = buffers.take(like, 3, 20)
    assert again.data_ptr() == address
    assert buffers.take(like, 3, 20).data_ptr() != address


def test_two_tensors_never_share_memory():
    buffers, like = Buffers(), torch.zeros(1)
    for _ in range(3):
        tensors = [buffers.take(like, 7, 9).fill_(i) for i in range(5)]
        assert [float(tensor.sum()) for tensor in tensors] == [63.0 * i for i in range(5)]
        buffers.give_back(*tensors)


def test_growing_batches_leave_little_behind():
    buffers, like = Buffers(), torch.zeros(1)
    for points in range(400, 1601):
        tensors = [buffers.take(like, 8, points) for _ in range(4)]
        buffers.give_back(*tensors)
    kept = sum(memory.numel() for shelf in buffers.free.values() for memory in shelf)
    assert kept <= 4 * 4 * 8 * 1600


def test_capacity():
    assert [capacity(count) for count in (0, 1, 2, 3, 4, 5, 1000)] == [1, 1, 2, 4, 4, 8, 1024]
