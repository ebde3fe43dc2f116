"""`cubeling character graph`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.tree import Tree

from app.errors import AppError
from characters import Animator, Character
from characters.control.builtin_tree import built_in
from characters.motion.trees import Node, Plan
from characters.motion.trees.diagram import draw
from characters.motion.trees.layout import described, plain
from characters.motion.trees.plan import Change


def graph(
    character: Annotated[
        str, typer.Argument(help="A bundled character, or a .glb, .gltf or .vrm file.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Draw it into this .svg file.")
    ] = None,
) -> None:
    """Show how a character's motions are put together: blend trees, layers, states.

    They come from the .toml file beside the character (docs/motions.md); without one, what every
    character with such clips does is shown.

    Example: [cyan]cubeling character graph human -o human.svg[/]
    """
    if output is not None and output.suffix != ".svg":
        raise AppError(f"a graph is drawn as an .svg file, not as '{output}'")
    loaded = Character.load(character)
    plan = loaded.plan or built_in(loaded)
    if loaded.plan is not None:
        Animator(loaded)  # what cannot be played is told before it is played
    Console().print(outline(plan, loaded.name))
    if output is None:
        return
    try:
        output.write_text(draw(plan, loaded.name), encoding="utf-8")
    except OSError as error:
        raise AppError(f"cannot write '{output}' ({error.strerror}): check the folder") from None
    Console().print(f"[bold]{escape(str(output))}[/] is drawn; a web browser shows it.")


def outline(plan: Plan, name: str) -> Tree:
    """Return a plan as an indented list."""
    tree = Tree(f"[bold]{escape(name)}[/]  [dim]from {escape(plan.source)}[/]")
    if plan.machine is None:
        for root in plan.roots:
            _grow(tree, root, "")
        return tree
    for state, node in plan.machine.states.items():
        first = "first state" if state == plan.machine.start else "state"
        branch = tree.add(f"[bold yellow]{escape(state)}[/]  [dim]{first}[/]")
        _grow(branch, node, "")
        for change in plan.machine.changes:
            if change.start == state:
                branch.add(f"[yellow]→ {_told(change)}", highlight=True)
    for change in plan.machine.changes:
        if change.start == "*":
            tree.add(f"[yellow]any → {_told(change)}", highlight=True)
    return tree


def _told(change: Change) -> str:
    return f"{escape(change.end)}[/] when {escape(change.when.text)}"


def _grow(tree: Tree, node: Node, label: str) -> None:
    at = f"[cyan]{escape(label)}[/] " if label else ""
    branch = tree.add(f"{at}{escape(node.name or node.kind)}  [dim]{escape(described(node))}[/]")
    for key, child in node.motions.items():
        _grow(branch, child, "" if key == "of" else key)
    for row in node.rows:
        at = row.said.get("value", row.said.get("start", row.said.get("weight", "")))
        _grow(branch, row.motion, plain(at))
