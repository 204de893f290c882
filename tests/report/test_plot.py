"""Plots that stand in the page: names that clash with no other plot's, the page's colours, the same bytes."""

import re

from weingarten.report.plot import GROUP, colour, dots, inline, logarithmic, look, new_figure


def drawn(name: str) -> str:
    with look():
        figure = new_figure(3.0, 2.0)
        axes = figure.add_subplot()
        dots(axes, [1.0, 2.0, 30.0], [0.0, 1.0, 2.0], colour(1), "a")
        dots(axes, [3.0], [0.0], colour(2), "b")
        logarithmic(axes.xaxis, 0.5, 40.0)
        axes.set_xlabel("length <x> & more")
        return inline(figure, name, 'said "so" <b>', {"a": ["one", "two <b>", "three"], "b": ["four"]})


def test_names_are_the_plots_own_and_all_that_is_referred_to_is_there():
    text = drawn("first")
    names = re.findall(r'id="([^"]+)"', text)
    assert len(names) == len(set(names))
    assert all(name.startswith("first-") for name in names)
    referred = re.findall(r'(?:url\(#|href="#)([^")]+)', text)
    assert referred
    assert set(referred) == set(names)
    assert GROUP not in text


def test_points_have_their_titles_in_order_and_text_is_escaped():
    text = drawn("first")
    assert re.findall(r"<title>(.*?)</title>", text) == ["one", "two &lt;b&gt;", "three", "four"]
    assert "length &lt;x&gt; &amp; more" in text
    assert 'aria-label="said &quot;so&quot; &lt;b&gt;"' in text


def test_colours_and_type_are_the_pages():
    text = drawn("first")
    assert {"var(--ink)", "var(--muted)", "var(--grid)", "var(--c1)", "var(--c2)"} >= set(
        re.findall(r"var\(--\w+\)", text)
    )
    assert "var(--c1)" in text
    assert not re.search(r"#0[1-4]0", text)
    assert "DejaVu" not in text
    assert "<style" not in text
    assert "http" not in text
    assert ">0.5<" in text
    assert "10^" not in text


def test_the_same_plot_is_the_same_text():
    assert drawn("first") == drawn("first")
    assert drawn("first").replace("first-", "") == drawn("second").replace("second-", "")
