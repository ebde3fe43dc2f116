"""Plans as graphs in Graphviz's DOT language."""

from cubeling.characters.motion.trees.plan import Node, Plan, StateGraph

_FILL_COLOURS = {
    "state": "#fde7c8",
    "mix": "#d8efe4",
    "layer": "#e9def6",
    "modifier": "#dbe9fb",
    "clip": "#eef1f4",
}


def to_dot(plan: Plan, title: str = "") -> str:
    """Return a plan as DOT text; `dot -Tsvg plan.dot -o plan.svg` draws it.

    Boxes are states and motions; an edge leads from each motion to those that it uses. A motion
    that is used several times is one box. Dashed edges are transitions, with their conditions.
    """
    writer = _DotWriter(title)
    if plan.machine is None:
        for root in plan.roots:
            writer.add_motion(root)
    else:
        writer.add_states(plan.machine)
    return "\n".join([*writer.lines, "}\n"])


class _DotWriter:
    def __init__(self, title: str) -> None:
        self.lines = [
            f"digraph {_quote(title)} {{",
            f"  graph [rankdir=LR, labelloc=t, label={_quote(title)}]",
            '  node [shape=box, style="rounded,filled"]',
        ]
        self._motions: dict[int, str] = {}

    def add_states(self, machine: StateGraph) -> None:
        """Add the states with their motions and transitions."""
        states = {name: f"state{number}" for number, name in enumerate(machine.states)}
        for name, node in machine.states.items():
            note = "first state" if name == machine.start else "state"
            self._box(states[name], name, note, "state")
            self._edge(states[name], self.add_motion(node))
        if any(transition.start == "*" for transition in machine.transitions):
            self.lines.append('  any [label="any state", shape=plaintext, style=""]')
        for transition in machine.transitions:
            start, end = states.get(transition.start, "any"), states[transition.end]
            self._edge(start, end, transition.when.text, ", style=dashed, constraint=false")

    def add_motion(self, node: Node) -> str:
        """Add a motion and those that it uses, once; return its identifier."""
        if id(node) in self._motions:
            return self._motions[id(node)]
        name = self._motions[id(node)] = f"motion{len(self._motions)}"
        self._box(name, node.name or node.kind, node.description, node.group)
        for label, child in zip(node.labels, node.children, strict=True):
            self._edge(name, self.add_motion(child), label)
        return name

    def _box(self, name: str, title: str, note: str, group: str) -> None:
        label = _quote(title) if note == title else f"{_quote(title)[:-1]}\\n{_quote(note)[1:]}"
        self.lines.append(f'  {name} [label={label}, fillcolor="{_FILL_COLOURS[group]}"]')

    def _edge(self, start: str, end: str, label: str = "", style: str = "") -> None:
        attributes = f" [label={_quote(label)}{style}]" if label else ""
        self.lines.append(f"  {start} -> {end}{attributes}")


def _quote(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
