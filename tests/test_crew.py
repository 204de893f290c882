"""A crew answers in the order of the tasks, on one core each, and leaves torch's threads as they were."""

import gc
import threading

import pytest
import torch

from weingarten.crew import THREADS, Crew, crew_for


@pytest.mark.parametrize("crew", [Crew(), Crew(1), Crew(3)])
def test_answers_keep_the_order_of_the_tasks(crew):
    assert crew.map(lambda task: task * task, list(range(50))) == [n * n for n in range(50)]
    assert crew.map(lambda task: task, []) == []


def test_tasks_run_side_by_side():
    barrier, crew = threading.Barrier(2, timeout=20), Crew(2)
    with crew:
        assert len(crew.map(lambda _: barrier.wait(), [0, 1])) == 2


@pytest.mark.parametrize("size", [1, 2, 4])
def test_an_error_of_a_task_is_raised_and_the_crew_goes_on(size):
    crew = Crew(size)
    with crew:
        for _ in range(3):
            with pytest.raises(ZeroDivisionError):
                crew.map(lambda task: 1 / task, [1, 0] * 10)
            assert crew.map(lambda task: 2 * task, [1, 2]) == [2, 4]


@pytest.mark.parametrize("size", [1, 2, 4])
def test_a_job_may_begin_others_and_all_are_done_at_the_finish(size):
    """Binary trees of jobs: 2⁸ leaves each."""
    crew, leaves = Crew(size), []

    def grow(depth):
        if depth == 0:
            leaves.append(threading.current_thread())
        else:
            crew.begin(lambda: grow(depth - 1))
            crew.begin(lambda: grow(depth - 1))

    with crew:
        for trees in range(1, 6):
            crew.begin(lambda: grow(8))
            crew.finish()
            assert len(leaves) == trees * 2**8
    assert len(set(leaves)) <= size


def test_the_others_live_within_the_with_alone():
    before, crew = threading.active_count(), Crew(3)
    for _ in range(2):
        with crew, crew:
            assert threading.active_count() == before + 2
        assert threading.active_count() == before


@pytest.mark.parametrize("crew", [Crew(), Crew(2)])
@pytest.mark.parametrize("grad", [True, False])
def test_gradients_are_on_or_off_as_in_the_calling_thread(crew, grad):
    with torch.set_grad_enabled(grad):
        assert crew.map(lambda _: torch.is_grad_enabled(), [0, 1]) == [grad, grad]


def test_torch_has_one_thread_in_a_crew_and_its_own_number_afterwards():
    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        crew = Crew(2)
        with crew:
            with crew:
                assert torch.get_num_threads() == 1
            assert torch.get_num_threads() == 1
            assert crew.map(lambda _: torch.get_num_threads(), [0, 1]) == [1, 1]
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_a_crew_is_as_large_as_torch_may_use_threads():
    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        assert crew_for(torch.device("cpu")).size == 2
        torch.set_num_threads(1)
        assert crew_for(torch.device("cpu")).size == 1
    finally:
        torch.set_num_threads(before)
    assert crew_for(torch.device("meta")).size == 1


def test_what_was_left_undone_is_not_the_next_ones():
    crew, seen = Crew(2), []
    with crew:
        crew.begin(lambda: seen.append(threading.Event().wait(0.05)))
    crew.begin(lambda: seen.append("left"))
    with crew:
        pass
    seen.clear()
    with crew:
        assert crew.map(lambda task: task, [1]) == [1]
    assert seen == []


def test_an_error_keeps_nothing_of_the_crew_alive():
    gone = []

    class Held:
        def __del__(self):
            gone.append(True)

    def fail():
        held = Held()
        raise ValueError(str(held))

    gc.disable()
    try:
        crew = Crew(1)
        crew.begin(fail)
        with pytest.raises(ValueError, match="Held"):
            crew.finish()
        del crew
    finally:
        gc.enable()
    assert gone


def test_a_thread_that_begins_beside_a_crew_has_the_crew_that_it_would_have_alone():
    """And leaves the process's number of threads as it was, whichever of the two ends last."""
    before, sizes = torch.get_num_threads(), []

    def beside() -> None:
        THREADS.join()
        own = crew_for(torch.device("cpu"))
        with own:
            sizes.extend([own.size, torch.get_num_threads()])
        sizes.append(torch.get_num_threads())

    def later() -> None:
        sizes.append(torch.get_num_threads())

    try:
        torch.set_num_threads(2)
        with Crew(2):
            for work in (beside, beside):
                thread = threading.Thread(target=work)
                thread.start()
                thread.join()
        assert sizes == [2, 1, 2] * 2
        assert torch.get_num_threads() == 2
        sizes.clear()
        thread = threading.Thread(target=later)
        thread.start()
        thread.join()
        assert sizes == [2]
    finally:
        torch.set_num_threads(before)
