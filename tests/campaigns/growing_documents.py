"""Documents of BML, FML and schedules that grow, each in one way."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tests.characters.behaviour.bml.suite import block

Make = Callable[[int], str]
"""Returns a document of a size."""


@dataclass(frozen=True)
class Growing:
    """A kind of documents that grow in one way."""

    name: str

    make: Make

    largest: int
    """Size of the last one, in what is repeated."""

    read: str = "bml"
    """Who reads it: bml, fml or schedule."""


def _text(inside: Make) -> Make:
    return lambda n: block(f"<speech id='s'><text>{inside(n)}</text></speech>")


def _rules(rule: Callable[[int], str], behaviours: str = "<wait id='w'/><head id='h'/>") -> Make:
    return lambda n: block(
        behaviours + "<constraint>" + "".join(map(rule, range(n))) + "</constraint>"
    )


def _each(behaviour: Callable[[int], str]) -> Make:
    return lambda n: block("".join(map(behaviour, range(n))))


def _synchronize(a: str, b: str) -> str:
    return f"<synchronize><sync ref='{a}'/><sync ref='{b}'/></synchronize>"


def _after(earlier: str, later: str) -> str:
    return f"<after ref='{earlier}'><sync ref='{later}'/></after>"


HEADS = "".join(f"<head id='h{i}'/>" for i in range(150))

MARKS = "".join(f"<sync id='m{i}'/>a " for i in range(400))


def bml_texts() -> Iterator[Growing]:
    """Yield documents with long texts."""
    yield Growing("newlines in a text", _text(lambda n: "\n" * n), 1_000_000)
    yield Growing("letters in a text", _text(lambda n: "a " * n), 500_000)
    yield Growing("references in a text", _text(lambda n: "&amp;" * n), 200_000)
    yield Growing("newlines between elements", lambda n: block("\n" * n), 1_000_000)
    yield Growing(
        "marks in a text",
        _text(
            lambda n: (
                "<sync id='a'/>" * min(n, 1) + "".join(f"<sync id='m{i}'/>a " for i in range(n))
            )
        ),
        4_900,
    )
    yield Growing("digits of a time", lambda n: block(f"<wait start='{'1' * n}x'/>"), 1_000_000)
    yield Growing(
        "digits of an offset", lambda n: block(f"<wait start='w:end+{'1' * n}x'/>"), 1_000_000
    )
    yield Growing("spaces of a time", lambda n: block(f"<wait start='{' ' * n}x'/>"), 1_000_000)
    yield Growing("colons of a time", lambda n: block(f"<wait start='{'a:' * n}'/>"), 500_000)
    yield Growing("letters of the id", lambda n: block(HEADS, name="a" * n), 900_000)
    yield Growing(
        "letters of a behaviour's id",
        lambda n: block(f"<head id='{'a' * n}'/>" + f"<head start='{'a' * (n // 2)}:end'/>"),
        600_000,
    )
    yield Growing(
        "names to wait for",
        lambda n: block(more=f"composition='APPEND-AFTER({'a ' * n})'"),
        500_000,
    )
    yield Growing(
        "names to interrupt",
        lambda n: block(f"<bmla:interrupt id='i' target='{'a ' * n}'/>"),
        500_000,
    )
    yield Growing(
        "a deep text",
        lambda n: block("<gesture>" + "<x>" * 28 + "é" * n + "</x>" * 28 + "</gesture>"),
        500_000,
    )
    yield Growing(
        "letters of a lexeme", lambda n: block(f"<dance id='d' lexeme='{'a' * n}'/>"), 1_000_000
    )


def bml_elements() -> Iterator[Growing]:
    """Yield documents with many elements."""
    yield Growing("behaviours", _each(lambda i: f"<head id='b{i}'/>"), 1_600)
    yield Growing("behaviours without id", _each(lambda i: "<head/>"), 1_600)
    yield Growing(
        "gestures in turn", _each(lambda i: f"<gesture id='b{i}' start='{3 * i}'/>"), 1600
    )
    yield Growing("gestures at once", _each(lambda i: f"<gesture id='b{i}'/>"), 1_600)
    yield Growing(
        "a chain",
        _each(
            lambda i: f"<head id='b{i}' start='b{max(i - 1, 0)}:end'/>" if i else "<head id='b0'/>"
        ),
        1600,
    )
    yield Growing(
        "a chain backwards", _each(lambda i: f"<head id='b{i}' start='b{i + 1}:end'/>"), 1600
    )
    yield Growing(
        "a broken chain",
        _each(
            lambda i: (
                f"<head id='b{i}' start='b{i - 1}:end'/>" if i else "<head id='b0' start='-9'/>"
            )
        ),
        1600,
    )
    yield Growing(
        "impossible behaviours", _each(lambda i: f"<head id='b{i}' start='2' end='1'/>"), 1600
    )
    yield Growing(
        "clusters that join",
        _each(
            lambda i: f"<head id='b{i}'/><gaze id='g{i}' start='b{i}:end' end='b{i + 1}:start'/>"
        ),
        800,
    )
    yield Growing("controls", _each(lambda i: f"<bmla:interrupt id='b{i}' target='x'/>"), 1_600)
    yield Growing(
        "unknown children", lambda n: block("<gesture>" + "<x/>" * n + "</gesture>"), 100_000
    )
    yield Growing(
        "attributes",
        lambda n: block("<gesture " + " ".join(f"a{i}='1'" for i in range(n)) + "/>"),
        60_000,
    )
    yield Growing(
        "namespaces",
        lambda n: block("<gesture " + " ".join(f"xmlns:a{i}='u{i}'" for i in range(n)) + "/>"),
        30_000,
    )
    yield Growing(
        "namespaces in turn",
        lambda n: block("".join(f"<x{i} xmlns='u{i}'/>" for i in range(n))),
        40_000,
    )
    yield Growing("comments", lambda n: block("<!---->" * n), 140_000)


def bml_constraints() -> Iterator[Growing]:
    """Yield documents with many constraints."""
    yield Growing(
        "constraints that are met", _rules(lambda i: _synchronize("w:start", "h:start")), 4_000
    )
    yield Growing(
        "constraints that are not met",
        _rules(lambda i: _synchronize(f"w:end+{i}", "w:start")),
        2_400,
    )
    yield Growing(
        "constraints against each other",
        _rules(lambda i: _synchronize(f"w:start+{i}", "h:start")),
        2_400,
    )
    yield Growing(
        "constraints with three each",
        _rules(
            lambda i: (
                f"<synchronize><sync ref='w:start+{i}'/><sync ref='h:start'/>"
                "<sync ref='h:end'/></synchronize>"
            )
        ),
        2_400,
    )
    yield Growing(
        "one constraint with many",
        lambda n: block(
            HEADS
            + "<constraint><synchronize>"
            + "".join(f"<sync ref='h{i % 150}:start'/>" for i in range(n))
            + "</synchronize></constraint>"
        ),
        4_800,
    )
    yield Growing(
        "constraints on nothing", _rules(lambda i: _synchronize(f"x{i}:start", "h:start")), 2_400
    )
    yield Growing(
        "orders in a row",
        _rules(lambda i: _after(f"h{i % 149}:end", f"h{i % 149 + 1}:start"), HEADS),
        2_400,
    )
    yield Growing(
        "orders in a row, backwards",
        _rules(lambda i: _after(f"h{148 - i % 149}:end", f"h{149 - i % 149}:start"), HEADS),
        2_400,
    )
    yield Growing(
        "orders in circles",
        _rules(lambda i: _after(f"h{i % 150}:end", f"h{(i * 7 + 3) % 150}:start"), HEADS),
        2_400,
    )
    yield Growing(
        "orders that are not met", _rules(lambda i: _after(f"w:end+{i}", "w:start")), 2_400
    )
    yield Growing(
        "required in circles",
        lambda n: block(
            HEADS
            + "<required><constraint>"
            + "".join(_after(f"h{i % 150}:end", f"h{(i * 7 + 3) % 150}:start") for i in range(n))
            + "</constraint></required>"
        ),
        2_400,
    )
    speech = f"<speech id='s'><text>{MARKS}</text></speech>"
    yield Growing(
        "marks tied to behaviours",
        _rules(lambda i: _synchronize(f"s:m{i % 400}", f"h{i % 150}:start"), speech + HEADS),
        2_000,
    )
    yield Growing(
        "marks tied to each other",
        _rules(lambda i: _synchronize(f"s:m{i % 400}", f"s:m{i * 7 % 400}+1"), speech),
        2_000,
    )
    yield Growing(
        "marks that do not exist",
        _rules(lambda i: _synchronize(f"s:x{i}", "s:start"), speech),
        2_000,
    )
    yield Growing(
        "marks in an order",
        _rules(lambda i: _after(f"s:m{i % 400}", f"h{i % 150}:start"), speech + HEADS),
        2_000,
    )


def fml() -> Iterator[Growing]:
    """Yield documents of FML."""
    yield Growing(
        "intentions",
        lambda n: (
            "<fml id='f'>"
            + "".join(f"<performative id='p{i}' type='greet'/>" for i in range(n))
            + "</fml>"
        ),
        1600,
        "fml",
    )
    yield Growing(
        "intentions that nobody knows",
        lambda n: (
            "<fml id='f'>"
            + "".join(f"<performative id='p{i}' type='x'/>" for i in range(n))
            + "</fml>"
        ),
        1600,
        "fml",
    )


def dialects() -> Iterator[Growing]:
    """Yield documents of the dialects of BML."""

    def of(name: str, make: Make, largest: int) -> Growing:
        return Growing(name, make, largest, "dialect of bml")

    def act(inside: str) -> str:
        return f"<act><bml>{inside}</bml></act>"

    yield of("comments before the root", lambda n: "<!-- a -->" * n + act("<head/>"), 90_000)
    yield of("an open comment", lambda n: "<!--" + "-" * n + act("<head/>"), 900_000)
    yield of(
        "spaces of a DTD", lambda n: f"<!DOCTYPE bml SYSTEM{' ' * n}[{' ' * n}]><bml/>", 400_000
    )
    yield of("quotes of a root", lambda n: "<bml " + "a='" * n + "/>", 300_000)
    yield of("prefixes", lambda n: act("".join(f"<p{i}:x/>" for i in range(n))), 4_900)
    yield of("a prefix", lambda n: act("<sbm:animation name='Beat'/>" * n), 1_600)
    yield of("an id used often", lambda n: act("<head id='h' type='NOD'/>" * n), 1_600)
    yield of(
        "what is added to one",
        lambda n: act("<gesture id='g' type='BEAT'/>" + "<gesture id='g' stroke='1'/>" * n),
        4_800,
    )
    yield of("words of a name", lambda n: act(f"<gesture lexeme='{'Beat_' * n}'/>"), 390)
    yield of(
        "marks",
        lambda n: act(
            "<speech id='s'>" + "".join(f"<tm id='m{i}'/>a " for i in range(n)) + "</speech>"
        ),
        490,
    )
    yield of(
        "behaviours at marks that are not there",
        lambda n: act("<speech id='s'>a</speech>" + "<head type='NOD' start='s:m' end='s:n'/>" * n),
        1_600,
    )
    yield of(
        "times that are given up",
        lambda n: act("".join(f"<head type='NOD' start='{i}' end='{i}.1'/>" for i in range(n))),
        1_600,
    )
    yield of(
        "expressivity",
        lambda n: act(
            "<head><description>" + "<SPC.value>1</SPC.value>" * n + "</description></head>"
        ),
        4_900,
    )


def _schedule(pool: str, activate: str) -> str:
    return f"<blendingschedule><actionpool>{pool}</actionpool>{activate}</blendingschedule>"


def _action(name: str, parameters: str = "", motion: str = "") -> str:
    motion = motion or '<blendableobject type="keyframebodyanimation">human#wave</blendableobject>'
    return f'<blendingaction id="{name}">{parameters}{motion}</blendingaction>'


ONE = '<activate id="a"/>'


def schedules() -> Iterator[Growing]:
    """Yield schedules."""
    wave = 'type="keyframebodyanimation"'

    def of(name: str, make: Make, largest: int) -> Growing:
        return Growing(name, make, largest, "schedule")

    yield of("newlines", lambda n: _schedule(_action("a") + "\n" * n, ONE), 3_900_000)
    yield of(
        "newlines of a name",
        lambda n: _schedule(
            _action("a", motion=f"<blendableobject {wave}>{chr(10) * n}x</blendableobject>"), ONE
        ),
        3_900_000,
    )
    yield of(
        "references",
        lambda n: _schedule(
            _action("a", motion=f"<blendableobject {wave}>{'&amp;' * n}</blendableobject>"), ONE
        ),
        1_600_000,
    )
    yield of(
        "actions",
        lambda n: _schedule("".join(_action(f"a{i}") for i in range(n)), '<activate id="a0"/>'),
        40_000,
    )
    yield of("one activated often", lambda n: _schedule(_action("a"), ONE * n), 200_000)
    yield of(
        "all activated",
        lambda n: _schedule(
            "".join(_action(f"a{i}") for i in range(n)),
            "".join(f'<activate id="a{i}"/>' for i in range(n)),
        ),
        40_000,
    )
    yield of(
        "merged curves",
        lambda n: _schedule(
            _action(
                "a",
                '<blendingparams type="merge">'
                + '<blendingparams type="fade"/>' * n
                + "</blendingparams>",
            ),
            ONE,
        ),
        200_000,
    )
    yield of(
        "scopes",
        lambda n: _schedule(
            _action(
                "a",
                '<blendingparams type="joints">'
                + '<scope id="torso" weight="1"/>' * n
                + "</blendingparams>",
            ),
            ONE,
        ),
        200_000,
    )
    yield of(
        "rotations",
        lambda n: _schedule(
            _action(
                "a",
                '<blendingparams type="joints">'
                + '<rotation id="vl5" weight="1"/>' * n
                + "</blendingparams>",
            ),
            ONE,
        ),
        200_000,
    )
    yield of(
        "nested modifiers",
        lambda n: _schedule(
            _action(
                "a",
                motion=(
                    '<blendableobject type="modifier"><modifier type="stretch" duration="3"/>' * n
                    + f"<blendableobject {wave}>x</blendableobject>"
                    + "</blendableobject>" * n
                ),
            ),
            ONE,
        ),
        100_000,
    )
    yield of(
        "digits",
        lambda n: _schedule(_action("a"), f'<activate id="a" offset="{"1" * n}x"/>'),
        3_900_000,
    )
    yield of(
        "unknown actions",
        lambda n: _schedule("".join(_action(f"a{i}") for i in range(n)), '<activate id="b"/>'),
        40_000,
    )
    yield of(
        "attributes",
        lambda n: _schedule(
            _action("a"), "<activate id='a' " + " ".join(f"a{i}='1'" for i in range(n)) + "/>"
        ),
        200_000,
    )
    yield of("comments", lambda n: _schedule(_action("a") + "<!---->" * n, ONE), 1_000_000)


def everything() -> list[Growing]:
    """Return all kinds of growing documents."""
    return [
        *bml_texts(),
        *bml_elements(),
        *bml_constraints(),
        *fml(),
        *dialects(),
        *schedules(),
    ]
