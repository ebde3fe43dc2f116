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


def _many(part: Callable[[int], str], count: int) -> str:
    return "".join(map(part, range(count)))


def _rules(rule: Callable[[int], str], behaviours: str = "<wait id='w'/><head id='h'/>") -> Make:
    return lambda n: block(f"{behaviours}<constraint>{_many(rule, n)}</constraint>")


def _each(behaviour: Callable[[int], str]) -> Make:
    return lambda n: block(_many(behaviour, n))


def _synchronize(a: str, b: str) -> str:
    return f"<synchronize><sync ref='{a}'/><sync ref='{b}'/></synchronize>"


def _after(earlier: str, later: str) -> str:
    return f"<after ref='{earlier}'><sync ref='{later}'/></after>"


def _circle(number: int) -> str:
    return _after(f"h{number % 150}:end", f"h{(number * 7 + 3) % 150}:start")


def _mark(number: int) -> str:
    return f"<sync id='m{number}'/>a "


def _attribute(number: int) -> str:
    return f"a{number}='1' "


HEADS = _many(lambda i: f"<head id='h{i}'/>", 150)

MARKS = _many(_mark, 400)


def bml_texts() -> Iterator[Growing]:
    """Yield documents with long texts."""
    yield Growing("newlines in a text", _text(lambda n: "\n" * n), 1_000_000)
    yield Growing("letters in a text", _text(lambda n: "a " * n), 500_000)
    yield Growing("references in a text", _text(lambda n: "&amp;" * n), 200_000)
    yield Growing("newlines between elements", lambda n: block("\n" * n), 1_000_000)
    yield Growing(
        "marks in a text", _text(lambda n: "<sync id='a'/>" * min(n, 1) + _many(_mark, n)), 4_900
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
    yield Growing("attributes", lambda n: block("<gesture " + _many(_attribute, n) + "/>"), 60_000)
    yield Growing(
        "namespaces",
        lambda n: block("<gesture " + _many(lambda i: f"xmlns:a{i}='u{i}' ", n) + "/>"),
        30_000,
    )
    yield Growing("namespaces in turn", _each(lambda i: f"<x{i} xmlns='u{i}'/>"), 40_000)
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
            f"{HEADS}<constraint><synchronize>"
            + _many(lambda i: f"<sync ref='h{i % 150}:start'/>", n)
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
    yield Growing("orders in circles", _rules(_circle, HEADS), 2_400)
    yield Growing(
        "orders that are not met", _rules(lambda i: _after(f"w:end+{i}", "w:start")), 2_400
    )
    yield Growing(
        "required in circles",
        lambda n: block(
            f"{HEADS}<required><constraint>{_many(_circle, n)}</constraint></required>"
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
    for name, kind in (("intentions", "greet"), ("intentions that nobody knows", "x")):

        def make(count: int, kind: str = kind) -> str:
            parts = _many(lambda i: f"<performative id='p{i}' type='{kind}'/>", count)
            return f"<fml id='f'>{parts}</fml>"

        yield Growing(name, make, 1600, "fml")


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
    yield of("prefixes", lambda n: act(_many(lambda i: f"<p{i}:x/>", n)), 4_900)
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
        lambda n: act("<speech id='s'>" + _many(lambda i: f"<tm id='m{i}'/>a ", n) + "</speech>"),
        490,
    )
    yield of(
        "behaviours at marks that are not there",
        lambda n: act("<speech id='s'>a</speech>" + "<head type='NOD' start='s:m' end='s:n'/>" * n),
        1_600,
    )
    yield of(
        "times that are given up",
        lambda n: act(_many(lambda i: f"<head type='NOD' start='{i}' end='{i}.1'/>", n)),
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
    motion = motion or _keyframes("human#wave")
    return f'<blendingaction id="{name}">{parameters}{motion}</blendingaction>'


def _keyframes(motion: str) -> str:
    return f'<blendableobject type="keyframebodyanimation">{motion}</blendableobject>'


def _actions(count: int) -> str:
    return _many(lambda i: _action(f"a{i}"), count)


ONE = '<activate id="a"/>'


def _playing(motion: str) -> str:
    return _schedule(_action("a", motion=motion), ONE)


def _blended(kind: str, inside: str) -> str:
    parameters = f'<blendingparams type="{kind}">{inside}</blendingparams>'
    return _schedule(_action("a", parameters), ONE)


def _modified(depth: int) -> str:
    modifier = '<blendableobject type="modifier"><modifier type="stretch" duration="3"/>'
    return modifier * depth + _keyframes("x") + "</blendableobject>" * depth


def schedules() -> Iterator[Growing]:
    """Yield schedules."""

    def of(name: str, make: Make, largest: int) -> Growing:
        return Growing(name, make, largest, "schedule")

    yield of("newlines", lambda n: _schedule(_action("a") + "\n" * n, ONE), 3_900_000)
    yield of("newlines of a name", lambda n: _playing(_keyframes("\n" * n + "x")), 3_900_000)
    yield of("references", lambda n: _playing(_keyframes("&amp;" * n)), 1_600_000)
    yield of("actions", lambda n: _schedule(_actions(n), '<activate id="a0"/>'), 40_000)
    yield of("one activated often", lambda n: _schedule(_action("a"), ONE * n), 200_000)
    yield of(
        "all activated",
        lambda n: _schedule(_actions(n), _many(lambda i: f'<activate id="a{i}"/>', n)),
        40_000,
    )
    yield of(
        "merged curves",
        lambda n: _blended("merge", '<blendingparams type="fade"/>' * n),
        200_000,
    )
    yield of("scopes", lambda n: _blended("joints", '<scope id="torso" weight="1"/>' * n), 200_000)
    yield of(
        "rotations", lambda n: _blended("joints", '<rotation id="vl5" weight="1"/>' * n), 200_000
    )
    yield of("nested modifiers", lambda n: _playing(_modified(n)), 100_000)
    yield of(
        "digits",
        lambda n: _schedule(_action("a"), f'<activate id="a" offset="{"1" * n}x"/>'),
        3_900_000,
    )
    yield of("unknown actions", lambda n: _schedule(_actions(n), '<activate id="b"/>'), 40_000)
    yield of(
        "attributes",
        lambda n: _schedule(_action("a"), "<activate id='a' " + _many(_attribute, n) + "/>"),
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
